//! The sorts of RON files.

/// The sort of a file, and of what a name on the command line means.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sort {
    /// A pipeline.
    Pipeline,
    /// A study.
    Study,
    /// A scene.
    Scene,
}

impl Sort {
    /// A name that means several of them means the first.
    pub const ALL: [Sort; 3] = [Sort::Pipeline, Sort::Study, Sort::Scene];

    /// Returns its name.
    pub fn name(self) -> &'static str {
        match self {
            Sort::Pipeline => "pipeline",
            Sort::Study => "study",
            Sort::Scene => "scene",
        }
    }

    /// Returns what a `.ron` file describes, by its first word.
    pub fn of_text(text: &str) -> Option<Sort> {
        let mut lines = text.lines().map(str::trim);
        let code =
            lines.find(|line| !(line.is_empty() || line.starts_with("//") || line.starts_with("#!")))?;
        let word = code.split(|c: char| !c.is_alphanumeric()).next()?.to_lowercase();
        Sort::ALL.into_iter().find(|sort| sort.name() == word)
    }
}
