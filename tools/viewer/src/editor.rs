//! The user's editor, in which places of errors are opened.

use crate::terminal;
use std::path::Path;
use std::process::{Command, Stdio};

/// The command that opens a file: words, in which `{file}`, `{line}` and `{column}` are put in.
#[derive(Clone, Debug)]
pub(crate) struct Editor(pub(crate) String);

/// Returns the file, the line and the column of a line of an error's text that shows where it is: `┌─ my.ron:3:5`.
pub(crate) fn place(line: &str) -> Option<(&str, &str, &str)> {
    let (_, place) = line.split_once("┌─ ")?;
    let (rest, column) = place.rsplit_once(':')?;
    let (file, line) = rest.rsplit_once(':')?;
    let is_number = |text: &str| text.parse::<u32>().is_ok();
    (is_number(line) && is_number(column)).then_some((file, line, column))
}

impl Editor {
    /// Returns the words of the command for a place. A name from the root of the tree is that of a file there.
    fn words(&self, root: Option<&Path>, (file, line, column): (&str, &str, &str)) -> Vec<String> {
        let in_root = root.map(|root| root.join(file)).filter(|path| path.is_file());
        let file = in_root.map_or_else(|| file.to_owned(), |path| path.to_string_lossy().into_owned());
        // The file last: its name may hold the others.
        let put =
            |word: &str| word.replace("{line}", line).replace("{column}", column).replace("{file}", &file);
        self.0.split_whitespace().map(put).collect()
    }

    /// Opens a place, and does not wait for the editor to end.
    pub(crate) fn open(&self, root: Option<&Path>, place: (&str, &str, &str)) {
        let words = self.words(root, place);
        let Some((program, arguments)) = words.split_first() else { return };
        let null = Stdio::null;
        match Command::new(program).args(arguments).stdin(null()).stdout(null()).stderr(null()).spawn() {
            // Waiting elsewhere, so that no process is left behind.
            Ok(mut child) => drop(std::thread::spawn(move || child.wait())),
            Err(error) => terminal::complain(format!("the editor `{program}` cannot be started: {error}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_place_in_an_error_becomes_a_command() {
        let place = place("   ┌─ C:/my folder/{line}.ron:12:7").unwrap();
        assert_eq!(place, ("C:/my folder/{line}.ron", "12", "7"));
        let editor = Editor("code -g {file}:{line}:{column}".to_owned());
        assert_eq!(editor.words(None, place), ["code", "-g", "C:/my folder/{line}.ron:12:7"]);
        let root = tempfile::tempdir().unwrap();
        std::fs::write(root.path().join("a.ron"), "").unwrap();
        let in_root = root.path().join("a.ron").to_string_lossy().into_owned();
        assert_eq!(
            Editor("e {file}".to_owned()).words(Some(root.path()), ("a.ron", "1", "1")),
            ["e", &in_root]
        );
        for line in ["error[E003]: no field", "   │ 12 ┌─ x", "   ┌─ a.ron:x:1"] {
            assert_eq!(super::place(line), None, "{line}");
        }
    }
}
