//! What is printed on a terminal.

use data_file::visible;

#[test]
fn control_characters_are_written_out() {
    assert_eq!(visible("plain, ü, →\tand\ttabs\nlines\r\n"), "plain, ü, →\tand\ttabs\nlines\n");
    assert_eq!(visible("\u{1b}[31m\u{7}\r\u{9b}\u{202e}"), "\\u001b[31m\\u0007\\u000d\\u009b\\u202e");
}
