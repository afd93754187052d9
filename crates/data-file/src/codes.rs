//! The stable codes of errors of the text of any file.
//!
//! Each crate that reports errors has a module like this one, made by the macro [`codes`](crate::codes!). The letter says
//! whose error it is: `E` of texts and pipelines, `C` of scenes, `S` of shaders, `L` of linking shaders to a pipeline, `T`
//! of studies; `W` is a warning or a note. `ERRORS.md` lists all codes, and a test checks that none means two things.

/// One kind of error.
#[derive(Debug, PartialEq, Eq)]
pub struct Code {
    /// `E012`.
    pub code: &'static str,
    /// What it means and what to do.
    pub meaning: &'static str,
}

/// Declares codes, each as `NAME = "E001": "Its meaning.";`, and `CODES`, the list of them.
#[macro_export]
macro_rules! codes {
    ($($name:ident = $code:literal: $meaning:literal;)*) => {
        $(
            #[doc = $meaning]
            pub static $name: $crate::Code = $crate::Code { code: $code, meaning: $meaning };
        )*
        /// Every code of this module, in order.
        pub static CODES: &[&$crate::Code] = &[$(&$name),*];
    };
}

crate::codes! {
    SYNTAX = "E001": "The text is not RON.";
    NESTING = "E002": "Values or expressions are nested too deeply.";
    UNKNOWN_FIELD = "E003": "A form has no field of that name.";
    MISSING_FIELD = "E004": "A form lacks a field that it needs.";
    WRONG_TYPE = "E005": "A value is of another type than the field takes.";
    DUPLICATE = "E006": "A name or field is given twice.";
    BAD_NAME = "E007": "A name holds a character that names may not have, or a link has too many parts.";
    UNKNOWN_FORM = "E008": "A form of that name is not known here.";
    SHADOWED = "W002": "A name means a file beside the one that names it, and one of the same name in a root.";
}
