//! A file that holds what overrides change.

use super::print::{quoted, value};
use super::{Overrides, Resolved, Settable};
use crate::description::{Body, SetValue};
use crate::port::PassTypes;
use data_file::Value;
use rustc_hash::FxHashMap;

/// The longest line of patches; more are written below each other.
const LINE: usize = 110;

/// Returns a pipeline file that extends `base` and sets what the overrides change of it.
///
/// `base` is the name or path of a file, as `extends` takes it, and `resolved` what it resolves to without overrides;
/// an empty `about` leaves that of the base. The file says the last value of each path, in the order of the overrides,
/// by `Set`: like an override, it comes after all that the base says itself. A value that the base has anyway is left
/// out, unless another override may change it too. Read again, the file has the values that the base has with
/// these overrides.
pub fn variant(
    base: &str,
    about: &str,
    resolved: &Resolved,
    kinds: &dyn PassTypes,
    overrides: &Overrides,
) -> String {
    let mut text = format!("Pipeline(\n    extends: {},\n", quoted(base));
    if !about.is_empty() {
        text += &format!("    about: {},\n", quoted(about));
    }
    let changed = changed(resolved, kinds, &overrides.0);
    let sets: Vec<String> =
        changed.iter().map(|(path, given)| format!("Set({}, {})", quoted(path), value(given))).collect();
    let line = format!("    patch: [{}],\n", sets.join(", "));
    if line.chars().count() <= LINE && !sets.is_empty() {
        text += &line;
    } else if !sets.is_empty() {
        text += &format!("    patch: [\n        {},\n    ],\n", sets.join(",\n        "));
    }
    text + ")\n"
}

/// Returns the last override of each path, without those that change nothing.
fn changed<'o>(
    resolved: &Resolved,
    kinds: &dyn PassTypes,
    overrides: &'o [(String, Value)],
) -> Vec<&'o (String, Value)> {
    let last =
        |(i, given): &(usize, &(String, Value))| !overrides[i + 1..].iter().any(|(path, _)| *path == given.0);
    let given: Vec<&(String, Value)> =
        overrides.iter().enumerate().filter(last).map(|(_, given)| given).collect();
    let settable = resolved.settable(kinds);
    let known: FxHashMap<&str, &Settable> = settable.iter().map(|s| (s.path.as_str(), s)).collect();
    let is_same = |(path, given): &(String, Value)| {
        known.get(path.as_str()).is_some_and(|known| {
            let converted = |value: &Value| value.clone().convert(known.setting.ty);
            converted(given).is_some() && converted(given) == converted(&known.value)
        })
    };
    // Other overrides may reach what a path names: a parameter that its value comes from.
    let others: Vec<Reach> = given
        .iter()
        .filter(|given| !is_same(given))
        .map(
            |(path, _)| if known.contains_key(path.as_str()) { resolved.reach(path) } else { Reach::Unknown },
        )
        .collect();
    given.into_iter().filter(|given| !is_same(given) || resolved.is_open(&given.0, &others)).collect()
}

/// How far an override reaches.
#[derive(Clone, Copy, PartialEq)]
enum Reach {
    /// One setting of one pass.
    Setting,
    /// A parameter, and all that is computed from it.
    Parameter,
    /// What it names is not listed.
    Unknown,
}

impl Resolved {
    /// How far an override of one of [`Resolved::settable`] reaches.
    fn reach(&self, path: &str) -> Reach {
        let Some((owner, _)) = path.rsplit_once('.') else { return Reach::Parameter };
        match self.index.get(owner).map(|i| &self.nodes[*i as usize].decl.body) {
            Some(Body::Pass { .. }) => Reach::Setting,
            _ => Reach::Parameter,
        }
    }

    /// Returns whether a value that is the base's may not stay so where nothing sets it, given what else is overridden.
    fn is_open(&self, path: &str, others: &[Reach]) -> bool {
        let Some((owner, setting)) = path.rsplit_once('.') else { return false };
        match self.reach(path) {
            Reach::Unknown | Reach::Parameter => others.iter().any(|other| *other != Reach::Setting),
            Reach::Setting => {
                let set = self.index.get(owner).and_then(|i| {
                    self.nodes[*i as usize].decl.set.iter().find(|set| set.name.value == *setting)
                });
                let computed = set.is_some_and(|set| !matches!(set.value, SetValue::Value(_)));
                others.iter().any(|other| match other {
                    Reach::Setting => false,
                    Reach::Parameter => computed,
                    Reach::Unknown => true,
                })
            }
        }
    }
}
