//! The codes of errors of WGSL files and of the dialect that they are written in.

data_file::codes! {
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
