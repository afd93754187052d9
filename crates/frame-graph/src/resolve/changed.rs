//! A flattened pipeline with another pass, or other settings, in one place.

use super::{Node, Resolved};
use crate::description::{At, Body, Link, Off, PassDecl, Set, SetValue};
use data_file::{Name, Place, Value};
use std::sync::Arc;

/// A change of one pass of a flattened pipeline.
#[derive(Clone, Debug, PartialEq)]
pub enum PassChange {
    /// Its settings have these values.
    Set(Vec<(String, Value)>),
    /// A pass of another type, with these settings, takes its place; links to inputs that the new type has too are kept.
    Replace {
        /// The pass type.
        kind: String,
        /// Settings.
        set: Vec<(String, Value)>,
    },
    /// It is left out, and what is linked to this input stands in its place.
    LeaveOut {
        /// The input.
        input: String,
    },
}

impl Resolved {
    /// Returns the pipeline with changes of passes, by their names in the flattened pipeline. What is no pass stays as it is.
    pub fn changed<'c>(&self, changes: impl IntoIterator<Item = (&'c str, &'c PassChange)>) -> Resolved {
        let mut changed = self.clone();
        for (pass, change) in changes {
            let Some(at) = changed.index.get(pass) else { continue };
            let node = &mut changed.nodes[*at as usize];
            if matches!(node.decl.body, Body::Pass { .. }) {
                node.decl = Arc::new(change.of(node));
            }
        }
        changed
    }
}

impl PassChange {
    fn of(&self, node: &Node) -> PassDecl {
        let (place, decl) = (node.place, (*node.decl).clone());
        match self {
            PassChange::Set(values) => {
                let is_given = |set: &Set| values.iter().any(|(name, _)| *name == *set.name.value);
                let kept = decl.set.iter().filter(|set| !is_given(set)).cloned();
                let set = kept.chain(sets(values, place)).collect();
                PassDecl { set, ..decl }
            }
            PassChange::Replace { kind, set } => {
                let kind = At { value: Name::from(kind.as_str()), place };
                let inherited = |link: Link| Link { inherited: true, ..link };
                PassDecl {
                    links: decl.links.into_iter().map(inherited).collect(),
                    link_names: decl.link_names,
                    set: sets(set, place).collect(),
                    when: decl.when,
                    off: decl.off,
                    ..PassDecl::new(Body::Pass { kind, shader: None })
                }
            }
            PassChange::LeaveOut { input } => {
                let off = At { value: Off::Input(Name::from(input.as_str())), place };
                PassDecl { off: Some(off), removed: Some(place), ..decl }
            }
        }
    }
}

fn sets(values: &[(String, Value)], place: Place) -> impl Iterator<Item = Set> {
    values.iter().map(move |(name, value)| Set {
        name: At { value: Name::from(name.as_str()), place },
        value: SetValue::Value(value.clone()),
        place,
        patched: true,
        foreign: false,
        instead_of: None,
    })
}
