//! The stable codes of all errors, with what each means.

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
        /// Every code, in order.
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
    NO_FILE = "E010": "A file that `extends`, `Sub` or the command line names is not there.";
    EXTENDS_LOOP = "E011": "A file extends itself, directly or through others.";
    SUB_LOOP = "E012": "A part contains itself, directly or through others.";
    TOO_LARGE = "E013": "Files are nested too deeply, or the flattened pipeline has too many passes.";
    DEFINED_TWICE = "E014": "A variant adds a pass whose name is taken; `Replace` is the patch for that.";
    PATCH_TARGET = "E015": "A patch names a pass that is not there.";
    PATCH_LINK = "E016": "`Insert` names two ports that no link joins.";
    PATH = "E017": "`Set` or `--set` names a parameter or setting that is not there.";
    UNKNOWN_PARAMETER = "E018": "`$name` or a switch names a parameter that is not declared.";
    PARAMETER = "E019": "A parameter's value is of the wrong type, out of range, or not one of its choices.";
    UNKNOWN_KIND = "E020": "There is no kind of pass of that name.";
    SHADER = "E021": "A kind that takes a shader lacks one, or one is given to a kind that takes none.";
    UNKNOWN_SETTING = "E022": "The kind has no setting of that name.";
    SETTING_TYPE = "E023": "A setting's value is of the wrong type.";
    SETTING_RANGE = "E024": "A setting's value is out of range, or not one of its choices.";
    REFUSED = "E025": "The kind refuses this use of it.";
    UNKNOWN_PASS = "E030": "A link names a pass or input that is not there.";
    UNKNOWN_PORT = "E031": "A link names a port or member that the pass does not have.";
    AMBIGUOUS = "E032": "A link names a pass or port that could mean several resources.";
    UNKNOWN_INPUT = "E033": "The pass has no input of that name.";
    UNLINKED = "E034": "An input that the pass needs is not linked.";
    INTERFACE = "E035": "The two ends of a link have different interfaces.";
    CYCLE = "E037": "Passes wait for each other; one link must read the past with `Prev`.";
    PAST = "E038": "The past of a past is read, or two links keep the past of one resource differently.";
    OFF_READ = "E039": "Something reads a pass that is switched off or removed and has no `off:`.";
    EXPRESSION = "E040": "An expression cannot be read.";
    EXPRESSION_NAME = "E041": "An expression names a trait, input or function that is not there.";
    EXPRESSION_TYPE = "E042": "An expression joins values of types that do not go together.";
    OFF = "E043": "What `off:` puts in place of a pass does not fit its outputs.";
    SWITCH_LOOP = "E044": "A switch depends on itself through `connected`.";
    OFF_LOOP = "E045": "Passes that are off stand in place of each other.";
    ARITHMETIC = "E046": "An expression divides by zero, or its value is beyond what a number can hold.";
    REPEAT = "E047": "`repeat` or `carry` of a part does not fit the part, or what no copy makes is read.";
    SIZE_INPUT = "E050": "A size is relative to an input that is not linked or has no texture.";
    SIZE_LOOP = "E051": "A size depends on itself through `Prev`.";
    SIZE_LIMIT = "E052": "A size is zero or larger than any device allows.";
    KIND_DEFECT = "E053": "A kind describes outputs that do not match its own ports: a defect of the kind.";
    UNKNOWN_OUTPUT = "E060": "An output or resource that was asked for is not there.";
    NO_OUTPUTS = "E061": "The pipeline has no outputs, so nothing in it is needed.";
    PART = "E062": "A part, which has `inputs`, was used as a whole pipeline.";
}

/// The table of codes in Markdown, as kept in `ERRORS.md`.
pub fn table() -> String {
    let mut text = String::from(
        "# Errors\n\nEvery error of a description has one of these codes. An example of each, with the whole \
         text as it is shown, is in `tests/broken` and `tests/snapshots`.\n\n| code | meaning |\n|---|---|\n",
    );
    for code in CODES {
        text.push_str(&format!("| {} | {} |\n", code.code, code.meaning));
    }
    text
}
