//! Tests of the whole program, which are in the folder `tests` of the tree: a package holds no files from outside its own.

include!("../../../tests/main.rs");
