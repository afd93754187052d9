//! The interfaces against what is said of them.

use pass::Format;
use pass::interfaces::{FORMATS, INTERFACES, format_of};

#[test]
fn formats_are_those_that_the_documentation_names() {
    let mut textures = 0;
    for interface in INTERFACES {
        for member in interface.members {
            let first = member.doc.split([':', ' ']).next().unwrap_or_default();
            let format = Format::from_name(first);
            assert_eq!(format_of(interface.name, member.name), format, "{}.{}", interface.name, member.name);
            textures += usize::from(format.is_some());
        }
    }
    assert_eq!(FORMATS.len(), textures, "the table has entries of no member");
    assert_eq!(format_of("GBuffer", "nothing"), None);
}
