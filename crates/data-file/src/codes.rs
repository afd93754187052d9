//! The stable codes of all errors, with what each means.
//!
//! The letter says whose error it is: `E` of the text of any file and of pipelines, which are in this module; `C` of
//! [`scene`]s, `S` of [`shader`]s, `L` of [`link`]ing shaders to a pipeline, `T` of [`study`] files; `W` is what
//! is no error: a [`warning`] or a note. No code means two
//! things; [`table`] documents all of them.

/// One kind of error.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// `E012`.
    pub code: &'static str,
    /// What it means and what to do.
    pub meaning: &'static str,
}

macro_rules! codes {
    ($($name:ident = $code:literal: $meaning:literal;)*) => {
        $(#[doc = $meaning] pub static $name: Code = Code { code: $code, meaning: $meaning };)*
        /// Every code of this module, in order.
        pub static CODES: &[&Code] = &[$(&$name),*];
    };
}

codes! {
    SYNTAX = "E001": "The text is not RON.";
    NESTING = "E002": "Values or expressions are nested too deeply.";
    UNKNOWN_FIELD = "E003": "A form has no field of that name.";
    MISSING_FIELD = "E004": "A form lacks a field that it needs.";
    WRONG_TYPE = "E005": "A value is of another type than the field takes.";
    DUPLICATE = "E006": "A name or field is given twice.";
    BAD_NAME = "E007": "A name holds a character that names may not have, or a link has too many parts.";
    UNKNOWN_FORM = "E008": "A form of that name is not known here.";
    NO_FILE = "E010": "A file that `extends`, `Sub` or the command line names does not exist, or is outside of the folders whose files may be named.";
    EXTENDS_LOOP = "E011": "A file extends itself, directly or through others.";
    SUB_LOOP = "E012": "A sub-graph contains itself, directly or through others.";
    TOO_LARGE = "E013": "Files are nested too deeply, or the flattened pipeline has too many passes.";
    DEFINED_TWICE = "E014": "A variant adds a pass whose name is taken; `Replace` is the patch for that.";
    PATCH_TARGET = "E015": "A patch names a pass that is not there.";
    PATCH_LINK = "E016": "`Insert` names two ports that no link joins.";
    PATH = "E017": "`Set` or `--set` names a parameter or setting that is not there.";
    UNKNOWN_PARAMETER = "E018": "`$name` or a switch names a parameter that is not declared.";
    PARAMETER = "E019": "A parameter's value is of the wrong type, out of range, or not one of its choices.";
    UNKNOWN_KIND = "E020": "There is no pass type of that name.";
    SHADER = "E021": "A pass type that takes a shader lacks one, or names one that is not there, or one is given to a pass type that takes none.";
    UNKNOWN_SETTING = "E022": "The pass type has no setting of that name.";
    SETTING_TYPE = "E023": "A setting's value is of the wrong type.";
    SETTING_RANGE = "E024": "A setting's value is out of range, or not one of its choices.";
    REFUSED = "E025": "The pass type refuses this use of it.";
    UNKNOWN_PASS = "E030": "A link names a pass or input that is not there.";
    UNKNOWN_PORT = "E031": "A link names a port or member that the pass does not have.";
    AMBIGUOUS = "E032": "A link names a pass or port that could mean several resources.";
    UNKNOWN_INPUT = "E033": "The pass has no input of that name.";
    UNLINKED = "E034": "An input that the pass needs is not linked.";
    INTERFACE = "E035": "The two ends of a link have different interfaces.";
    CYCLE = "E037": "Passes depend on each other in a loop; one link must read a history buffer with `prev`.";
    PAST = "E038": "A `prev` link reads a history buffer of a history buffer, or a pass hands on what such a link reads.";
    OFF_READ = "E039": "Something reads a pass that is switched off or removed and has no `off:`.";
    EXPRESSION = "E040": "An expression cannot be read.";
    EXPRESSION_NAME = "E041": "An expression names a trait or function that is not there.";
    EXPRESSION_TYPE = "E042": "An expression joins values of types that do not go together.";
    OFF = "E043": "What `off:` names as replacement of a pass does not fit the outputs of that pass.";
    OFF_LOOP = "E045": "Passes that are off replace each other in a loop.";
    ARITHMETIC = "E046": "An expression divides by zero, or its value is beyond what a number can hold.";
    SIZE_INPUT = "E050": "A size is relative to an input that is not linked or has no texture.";
    SIZE_LOOP = "E051": "A size depends on itself through `prev`.";
    SIZE_LIMIT = "E052": "A size is zero or larger than any device allows.";
    KIND_DEFECT = "E053": "A pass type describes outputs that do not match its own ports: a bug in the pass type.";
    UNKNOWN_OUTPUT = "E060": "An output or resource that was requested is not there.";
    NO_OUTPUTS = "E061": "The pipeline has no outputs, so nothing in it is needed.";
    SUB_AS_PIPELINE = "E062": "A sub-graph, which has `inputs`, was used as a whole pipeline.";
}

/// Errors of scene files, beside those of their text.
pub mod scene {
    use super::Code;

    codes! {
        RANGE = "C001": "A number of a scene is not finite, or out of its range.";
        NAME = "C002": "A scene names a built-in geometry, a file, a light or an object that is not there.";
        CONFLICT = "C003": "Values of a scene do not go together: an inner cone wider than the outer one, a camera that looks at its own position, keys whose times do not rise.";
    }
}

/// Errors of WGSL files and of the dialect that they are written in.
pub mod shader {
    use super::Code;

    codes! {
        MISSING_FILE = "S001": "A shader file, or the file of an import, is not there.";
        DIRECTIVE = "S002": "A `#` line cannot be read.";
        CONDITION = "S003": "A condition names an option that no file declares, or compares it with a value of another type.";
        UNBALANCED = "S004": "There is an `#if` without `#endif`, or the reverse.";
        INTERFACE = "S005": "No module is given for an `#import interface`.";
        COMMENT = "S006": "A block comment has no end.";
        OPTION = "S007": "An option is declared twice, or given a value that it does not take.";
        UNKNOWN_OPTION = "S008": "An option is given that no file declares.";
        VARIANTS = "S009": "A shader has more variants than can be checked.";
        WGSL = "S010": "The WGSL does not parse, or its types are wrong.";
        INVALID = "S011": "The WGSL parses, but is not valid.";
        COMPILER = "S012": "naga itself failed: a bug in naga.";
        EXTENT = "S013": "A shader is too long, or has too much in each other, for the compiler.";
        SETTING = "S020": "The declaration of a setting cannot be read.";
        ATTRIBUTE = "S021": "An attribute of a function or a global cannot be read.";
        LAYOUT = "S030": "Rust declares a struct differently from the shader.";
        NO_DECLARATION = "S031": "A struct or constant that Rust takes from a shader is not declared there.";
    }
}

/// Errors of linking the shaders of a pass to the resources of a pipeline.
pub mod link {
    use super::Code;

    codes! {
        REFUSED = "L001": "A pass cannot record its steps as it is used.";
        ENTRY = "L002": "A shader has no entry point of that name and stage.";
        UNDECLARED = "L003": "A shader reads scene bindings that its pass does not declare.";
        MISMATCH = "L004": "A shader declares a global otherwise than the resource is: its type, access or format.";
        SETTINGS = "L005": "The global `settings` is no uniform of a struct.";
        VALUE = "L006": "Nothing gives a member of `settings` a value, or one that it can hold.";
        UNKNOWN = "L007": "A shader names a resource that is no port, scratch or external of its pass.";
        INDIRECT = "L008": "A dispatch or draw cannot take its size from the buffer that it names.";
    }
}

/// Errors of studies, beside those of their text.
pub mod study {
    use super::Code;

    codes! {
        SCENE = "T001": "A scene is not there, or cannot be loaded.";
        PIPELINE = "T002": "A pipeline is not there, or is broken.";
        PATH = "T003": "An axis or a value names a parameter or setting that a pipeline does not have.";
        VALUE = "T004": "A value is of the wrong type, out of range, or not one of the choices.";
        EMPTY = "T005": "There is nothing to run: no scenes, no pipelines, an axis without values, no frames, no seeds.";
        TWICE = "T006": "A scene, a variant's name, an axis, a value, a seed, a measure or a pass is given twice.";
        PAIRED = "T007": "Axes that are paired have different numbers of values.";
        MEASURE = "T008": "There is no measure of that name.";
        NEEDS = "T009": "A measure lacks what it needs: a reference, several frames, several seeds, a jump.";
        OUTPUT = "T010": "A pipeline has no output of that name.";
        BUDGET = "T011": "A budget cannot be met: what it sets is varied as well, or is no whole number.";
        RANGE = "T012": "A number is out of range.";
        REFERENCE = "T013": "What a reference names is not there.";
        PHASE = "T014": "A phase names a pass that no pipeline of the study has.";
        CLAIM = "T015": "A claim names what is not measured, run or varied, or says nothing that could fail.";
        FIGURE = "T016": "There is no such figure among those of the passes of the study.";
    }
}

/// Warnings and notes: what is no error, and perhaps not meant.
pub mod warning {
    use super::Code;

    codes! {
        REMOVED = "W001": "A patch removed a pass without `off:`: links and outputs of the pipeline are lost with it.";
        SHADOWED = "W002": "A name means a file beside the one that names it, and one of the same name in a root.";
    }
}

/// Codes that belong together: a heading, what to know of them, and the codes.
type Section = (&'static str, &'static str, &'static [&'static Code]);

const SECTIONS: &[Section] = &[
    (
        "Text of any file, and pipelines",
        "Examples are in `crates/frame-graph/tests/broken`; the whole text of each, as it is shown, is in \
         `crates/frame-graph/tests/snapshots`.",
        CODES,
    ),
    (
        "Scenes",
        "Examples are in `crates/scene/tests/broken` and `crates/scene/tests/snapshots`.",
        scene::CODES,
    ),
    ("Shaders", "Examples are in `crates/shader-library/tests`.", shader::CODES),
    ("Linking shaders to a pipeline", "Examples are in `tests/linking.rs`.", link::CODES),
    (
        "Studies",
        "Examples are in `crates/study/tests/broken` and `crates/study/tests/snapshots`.",
        study::CODES,
    ),
    (
        "Warnings and notes",
        "With these, everything runs. `lightloom check` prints all of them; `render`, `graph` and `study` print warnings, \
         and W002, on standard error.",
        warning::CODES,
    ),
];

/// Returns every code there is.
pub fn all() -> impl Iterator<Item = &'static Code> {
    SECTIONS.iter().flat_map(|(_, _, codes)| codes.iter().copied())
}

/// Returns the table of all codes in Markdown, as kept in `ERRORS.md`.
pub fn table() -> String {
    let mut text = String::from("# Errors\n\nEvery error in a file has one of these codes.\n");
    for (title, about, codes) in SECTIONS {
        text.push_str(&format!("\n## {title}\n\n{about}\n\n| code | meaning |\n|---|---|\n"));
        for code in *codes {
            text.push_str(&format!("| {} | {} |\n", code.code, code.meaning));
        }
    }
    text
}
