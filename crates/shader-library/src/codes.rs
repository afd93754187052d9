//! The codes of this crate's errors, in one place so that none is given twice.

/// A file, or the file of an import, is not there.
pub(crate) const MISSING_FILE: &str = "S001";
/// A `#` line that cannot be read.
pub(crate) const DIRECTIVE: &str = "S002";
/// A condition names an option that no file declares, or compares it with a value of another type.
pub(crate) const CONDITION: &str = "S003";
/// `#if` without `#endif`, or the reverse.
pub(crate) const UNBALANCED: &str = "S004";
/// `#import interface` for which the request names no module.
pub(crate) const INTERFACE: &str = "S005";
/// A block comment without an end.
pub(crate) const COMMENT: &str = "S006";
/// An option declared twice, or given a value it does not take.
pub(crate) const OPTION: &str = "S007";
/// A request gives an option that no file declares.
pub(crate) const UNKNOWN_OPTION: &str = "S008";
/// More variants than can be checked.
pub(crate) const VARIANTS: &str = "S009";
/// WGSL that does not parse, or whose types are wrong.
pub(crate) const WGSL: &str = "S010";
/// WGSL that parses but is not valid.
pub(crate) const INVALID: &str = "S011";
/// naga itself failed.
pub(crate) const COMPILER: &str = "S012";
/// A declaration of a setting that cannot be read.
pub(crate) const SETTING: &str = "S020";
/// An attribute of a function or a global that cannot be read.
pub(crate) const ATTRIBUTE: &str = "S021";
/// A struct that the CPU declares otherwise.
pub(crate) const LAYOUT: &str = "S030";
