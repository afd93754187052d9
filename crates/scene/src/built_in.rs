//! Scenes made by code: deterministic, no file needed.

mod architecture;
mod atrium;
mod builder;
mod cloth;
mod cornell;
mod nave;
mod simple;

use crate::model::Model;

/// A maker of geometry.
type Make = fn() -> Model;

/// Every built-in geometry, by name.
const BUILT_IN: [(&str, Make); 9] = [
    ("cornell-box", cornell::cornell_box),
    ("cornell-box-lamp", cornell::cornell_box_lamp),
    ("atrium", atrium::atrium),
    ("nave", nave::nave),
    ("cloth", cloth::cloth),
    ("plane", simple::plane),
    ("cube", simple::cube),
    ("sphere", simple::sphere),
    ("empty", simple::empty),
];

/// Returns the names that `BuiltIn(…)` in a scene file knows.
pub fn names() -> Vec<&'static str> {
    BUILT_IN.iter().map(|(name, _)| *name).collect()
}

pub(crate) fn make(name: &str) -> Option<Model> {
    BUILT_IN.iter().find(|(known, _)| *known == name).map(|(_, make)| make())
}
