//! External programs as pipelines: the words of their commands, and what a command gives.

mod process;

use crate::error::Failure;
pub use process::Ended;
pub use process::{kill_running, run as run_program};
use std::path::Path;
use std::time::Duration;

/// A renderer that is another program: `External(…)` in a study.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct External {
    /// The command, as the study writes it.
    pub command: String,
    /// The time after which the program is killed, with its children \[s\].
    pub limit: u32,
}

/// The placeholders of a command, each with what stands in its place.
pub const PLACEHOLDERS: &[(&str, &str)] = &[
    ("scene", "path of the scene at the time of the frame: a .glb file"),
    ("camera", "path of the camera, a .json file"),
    ("out", "path of the EXR file to write"),
    ("width", "width of the picture in pixels"),
    ("height", "height of the picture in pixels"),
    ("output", "the output that the study measures"),
    ("seed", "the seed"),
    ("frame", "number of the frame, or of the first one where the command has `{frames}`"),
    ("frames", "number of frames, for a program that writes a sequence"),
    ("time", "time of the frame in seconds"),
    ("seconds", "the time that a frame may take, in a study with a budget of time"),
];

/// What is wrong with the text of a command.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) enum Misfit {
    /// It has no words.
    Empty,
    /// A quotation mark has no second one.
    OpenQuote,
    /// A brace has no second one.
    OpenBrace,
    /// There is no placeholder of that name.
    Unknown(String),
}

/// What a program has done.
#[derive(Clone, Debug, PartialEq)]
pub struct ExternalRun {
    /// Wall time of the whole program \[ms\].
    pub wall_ms: f64,
    /// The times of frames that the program states \[ms\], in order: each a line `lightloom: ms 12.3`.
    pub stated_ms: Vec<f64>,
    /// The last lines of its output.
    pub log: String,
}

/// The beginning of a line in which a program states the time of a frame.
const STATES: &str = "lightloom: ms ";

impl External {
    /// Returns the placeholders of the command, or what is wrong with its text.
    pub(crate) fn placeholders(&self) -> Result<Vec<String>, Misfit> {
        let mut names = Vec::new();
        for word in words(&self.command)? {
            expand(&word, &mut |name| {
                let is_known = PLACEHOLDERS.iter().any(|(known, _)| *known == name);
                names.push(name.to_owned());
                is_known.then(String::new)
            })?;
        }
        Ok(names)
    }

    /// Returns whether the command has a placeholder.
    pub fn takes(&self, name: &str) -> bool {
        self.placeholders().is_ok_and(|names| names.iter().any(|known| known == name))
    }

    /// Returns the content of each file that the command names, from the folder of the study: of the program itself and of
    /// scripts, as far as they are named by a path.
    pub fn files(&self, folder: &Path) -> Vec<Vec<u8>> {
        let words = words(&self.command).unwrap_or_default();
        words.iter().filter_map(|word| metrics::decode::read_file(&folder.join(word)).ok()).collect()
    }

    /// Runs the command in a folder with the values of its placeholders, and waits for its end.
    ///
    /// # Errors
    /// Fails if the program cannot be started, ends with another exit code than 0 or by a signal, or is not done in time.
    pub fn run(
        &self,
        folder: &Path,
        value: &mut dyn FnMut(&str) -> Option<String>,
    ) -> Result<ExternalRun, Failure> {
        let filled = words(&self.command).and_then(|words| {
            words.iter().map(|word| expand(word, value)).collect::<Result<Vec<String>, Misfit>>()
        });
        // The plan has checked the text.
        let words = filled.map_err(|misfit| Failure::render(format!("{misfit:?} in `{}`", self.command)))?;
        let Ended { status, wall, output } =
            process::run(&words, folder, Duration::from_secs(u64::from(self.limit)))?;
        let lines: Vec<&str> = output.lines().filter(|line| !line.trim().is_empty()).collect();
        let log = lines[lines.len().saturating_sub(12)..].join("\n");
        if !status.success() {
            let last = lines.last().map_or("it printed nothing", |line| line.trim());
            let end = format!("the command ended with {status}: {last}");
            return Err(Failure::render(if lines.len() > 1 { format!("{end}\n{log}") } else { end }));
        }
        let stated = lines.iter().filter_map(|line| line.trim().strip_prefix(STATES)?.trim().parse().ok());
        let stated_ms = stated.filter(|ms: &f64| ms.is_finite() && *ms >= 0.0).collect();
        Ok(ExternalRun { wall_ms: wall.as_secs_f64() * 1e3, stated_ms, log })
    }
}

/// Splits a command into words, as a shell does without its expansions: quotation marks of either sort keep spaces, and a
/// backslash takes the next character as it is, but not between `'…'`.
fn words(command: &str) -> Result<Vec<String>, Misfit> {
    let (mut words, mut word, mut quote) = (Vec::new(), None::<String>, None);
    let mut chars = command.chars();
    while let Some(c) = chars.next() {
        match (c, quote) {
            ('\\', None | Some('"')) => word.get_or_insert_default().extend(chars.next()),
            (c, Some(mark)) if c == mark => quote = None,
            ('\'' | '"', None) => {
                quote = Some(c);
                word.get_or_insert_default();
            }
            (c, None) if c.is_whitespace() => words.extend(word.take()),
            (c, _) => word.get_or_insert_default().push(c),
        }
    }
    words.extend(word);
    match quote {
        Some(_) => Err(Misfit::OpenQuote),
        None if words.is_empty() => Err(Misfit::Empty),
        None => Ok(words),
    }
}

/// Replaces the placeholders of a word by their values. `{{` and `}}` are braces.
fn expand(word: &str, value: &mut dyn FnMut(&str) -> Option<String>) -> Result<String, Misfit> {
    let (mut out, mut rest) = (String::new(), word);
    while let Some(at) = rest.find(['{', '}']) {
        let (before, behind) = rest.split_at(at);
        out += before;
        let (brace, behind) = behind.split_at(1);
        if let Some(behind) = behind.strip_prefix(brace) {
            out += brace;
            rest = behind;
            continue;
        }
        let (name, behind) = behind.split_once('}').filter(|_| brace == "{").ok_or(Misfit::OpenBrace)?;
        out += &value(name).ok_or_else(|| Misfit::Unknown(name.to_owned()))?;
        rest = behind;
    }
    Ok(out + rest)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn external(command: &str, limit: u32) -> External {
        External { command: command.to_owned(), limit }
    }

    #[test]
    fn words_are_those_of_a_shell() {
        let split = |text: &str| words(text).unwrap();
        assert_eq!(split("  a 'b  c' \"d 'e\"f  \\  "), ["a", "b  c", "d 'ef", " "]);
        assert_eq!(split(r#"'' 'a\b' "a\"b" c\'d"#), ["", r"a\b", "a\"b", "c'd"]);
        assert_eq!(words("a 'b"), Err(Misfit::OpenQuote));
        assert_eq!(words(" \n"), Err(Misfit::Empty));
    }

    #[test]
    fn placeholders_are_filled_after_words_are_split() {
        let fill = |word: &str| expand(word, &mut |name| (name == "out").then(|| "a b.exr".to_owned()));
        assert_eq!(fill("--out={out}!").unwrap(), "--out=a b.exr!");
        assert_eq!(fill("{{out}}").unwrap(), "{out}");
        assert_eq!(fill("{uot}"), Err(Misfit::Unknown("uot".to_owned())));
        for open in ["{out", "out}", "{"] {
            assert_eq!(fill(open), Err(Misfit::OpenBrace), "{open}");
        }
        assert!(external("a {out} {frames}", 1).takes("frames"));
        assert!(!external("a {out} {frames", 1).takes("out"));
    }

    #[cfg(unix)]
    #[test]
    fn a_program_is_run_and_its_failures_are_reported() {
        let folder = tempfile::tempdir().unwrap();
        let run =
            |command: &str| external(command, 1).run(folder.path(), &mut |name| Some(name.to_uppercase()));
        let ran =
            run("sh -c 'echo {seed} > said; echo; echo lightloom: ms 2.5; echo lightloom: ms x'").unwrap();
        assert_eq!((&ran.stated_ms[..], &*ran.log), (&[2.5][..], "lightloom: ms 2.5\nlightloom: ms x"));
        assert_eq!(std::fs::read_to_string(folder.path().join("said")).unwrap(), "SEED\n");
        assert_eq!(external("said sh ./said", 1).files(folder.path()), [b"SEED\n", b"SEED\n"]);
        let error = |command: &str| run(command).unwrap_err().to_string();
        assert_eq!(
            error("sh -c 'echo one >&2; echo two; exit 3'"),
            "the command ended with exit status: 3: two\none\ntwo"
        );
        assert_eq!(error("false"), "the command ended with exit status: 1: it printed nothing");
        assert!(error("no-such-program").starts_with("cannot start `no-such-program`: "));
        // Its child would go on for a minute, and write.
        let begun = std::time::Instant::now();
        let hangs = error("sh -c 'sh -c \"sleep 3; echo late > late\" & wait'");
        assert_eq!(hangs, "the process did not end within 1 s");
        assert!(begun.elapsed() < Duration::from_secs(3));
        std::thread::sleep(Duration::from_millis(2500));
        assert!(!folder.path().join("late").exists(), "its child is killed too");
    }
}
