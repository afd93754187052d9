//! The values of the names in formulas: settings, constants, facts and sizes of ports, traits of the scene.

use super::instead;
use super::outputs::ITERATIONS;
use crate::record::supersampling;
use crate::{Facts, OutputContext, PassTypeError, PortDesc, RecordContext, Settings, Traits, Value};
use frame_graph::{Formula, NameError, TextureDesc};
use std::cell::RefCell;

/// The name of a port, its facts, and its first texture.
type Port<'a> = (&'a str, &'a Facts, Option<&'a TextureDesc<(u32, u32)>>);

/// The values that the names of a formula stand for.
pub(super) struct Scope<'a> {
    settings: &'a Settings,
    frame: Option<(u32, u32)>,
    traits: Option<&'a Traits>,
    /// Connected ports.
    ports: Vec<Port<'a>>,
    /// The `const`s of the shader, and what Rust computes.
    constants: Vec<(&'a str, &'a Value)>,
    /// The names of all ports, connected or not.
    declared: Vec<&'a str>,
}

/// An error in a formula.
pub(super) struct Wrong {
    pub(super) message: String,
    pub(super) notes: Vec<String>,
    /// The port, and the fact that what is linked to it lacks.
    pub(super) absent: Option<(String, String)>,
}

impl Wrong {
    fn new(message: String, notes: Vec<String>) -> Wrong {
        Wrong { message, notes, absent: None }
    }

    /// Returns the error: at the input that lacks a fact, or else with the place of the formula.
    pub(super) fn at(self, place: &str) -> PassTypeError {
        if let Some((port, fact)) = &self.absent {
            return PassTypeError::no_fact(port, fact);
        }
        let error = PassTypeError::new(format!("{place}{}", self.message));
        if self.notes.is_empty() { error } else { error.help(self.notes.join("; ")) }
    }
}

impl<'a> Scope<'a> {
    /// A scope of settings alone, for a check before anything else is known.
    pub(super) fn of_settings(settings: &'a Settings) -> Scope<'a> {
        let (ports, constants, declared) = Default::default();
        Scope { settings, frame: None, traits: None, ports, constants, declared }
    }

    /// The scope of the outputs of a pass.
    pub(super) fn of_outputs(cx: &OutputContext<'a>) -> Scope<'a> {
        let texture = |input: &'a frame_graph::port::InputDesc| {
            input.members.iter().find_map(|(_, desc)| desc.texture())
        };
        let ports = cx.inputs.iter().map(|input| (&*input.name, &*input.facts, texture(input))).collect();
        Scope { frame: Some(cx.frame), traits: Some(cx.traits), ports, ..Scope::of_settings(cx.settings) }
    }

    /// The scope of the steps of a pass.
    pub(super) fn of_steps(cx: &RecordContext<'a>) -> Scope<'a> {
        let texture = |port: &'a PortDesc| port.members.iter().find_map(|(_, desc)| desc.texture());
        let ports = cx.inputs.iter().chain(cx.outputs);
        let ports = ports.map(|port| (&*port.name, &*port.facts, texture(port))).collect();
        Scope { frame: Some(cx.frame), traits: Some(cx.traits), ports, ..Scope::of_settings(cx.settings) }
    }

    /// The same with constants and the names of all ports.
    pub(super) fn with(
        mut self,
        constants: impl IntoIterator<Item = (&'a str, &'a Value)>,
        declared: impl IntoIterator<Item = &'a str>,
    ) -> Scope<'a> {
        self.constants = constants.into_iter().collect();
        self.declared = declared.into_iter().collect();
        self
    }

    /// The same with another constant.
    pub(super) fn and(mut self, name: &'a str, value: &'a Value) -> Scope<'a> {
        self.constants.push((name, value));
        self
    }

    /// Returns the value of a formula.
    pub(super) fn value(&self, text: &str) -> Result<Value, Wrong> {
        let absent = RefCell::new(None);
        let wrong = |error: frame_graph::FormulaError| Wrong {
            absent: absent.take(),
            ..Wrong::new(error.message, error.notes)
        };
        let formula = Formula::parse(text).map_err(wrong)?;
        formula.value(&mut |name| self.lookup(name, &absent)).map_err(wrong)
    }

    /// Returns the value of a formula that is a whole number.
    pub(super) fn whole(&self, text: &str) -> Result<u32, Wrong> {
        match self.value(text)? {
            Value::U32(number) => Ok(number),
            other => {
                let message =
                    format!("expected a whole number, or an expression that is one; `{text}` is {other}");
                Err(Wrong::new(message, Vec::new()))
            }
        }
    }

    /// Returns whether all settings that a formula names are there: ports are not known yet.
    pub(super) fn check(&self, text: &str) -> Result<(), Wrong> {
        let formula = Formula::parse(text).map_err(|error| Wrong::new(error.message, error.notes))?;
        let mut wrong = None;
        let _ = formula.value(&mut |name| {
            let found = self.lookup(name, &RefCell::default());
            if !name.contains('.') || name.starts_with("settings.") {
                wrong = wrong.take().or(found.clone().err());
            }
            found
        });
        match wrong {
            Some((message, notes)) => Err(Wrong::new(message, notes)),
            None if text.contains('.') || text.contains(|c: char| c.is_uppercase()) => Ok(()),
            None => self.whole(text).map(|_| ()),
        }
    }

    fn lookup(&self, name: &str, absent: &RefCell<Option<(String, String)>>) -> Result<Value, NameError> {
        let among = |message: String, near: &str, names: Vec<&str>| {
            let note = instead(near, "there are", names);
            (message, vec![note])
        };
        let setting = |name: &str| self.settings.0.get(name).cloned();
        let settings = || self.settings.0.keys().map(String::as_str);
        let Some((owner, member)) = name.split_once('.') else {
            let constant =
                || self.constants.iter().find(|(known, _)| *known == name).map(|(_, value)| (*value).clone());
            return setting(name).or_else(constant).ok_or_else(|| {
                let names = settings().chain(self.constants.iter().map(|(name, _)| *name)).collect();
                among(format!("there is no setting `{name}`"), name, names)
            });
        };
        match (owner, member) {
            ("settings", _) => setting(member).ok_or_else(|| {
                among(format!("there is no setting `{member}`"), member, settings().collect())
            }),
            ("frame", "width" | "height") if self.frame.is_some() => {
                let (width, height) = self.frame.unwrap_or_default();
                Ok(Value::U32(if member == "width" { width } else { height }))
            }
            ("scene", _) => {
                let traits = self.traits.map(|traits| &traits.values);
                traits.and_then(|traits| traits.get(member)).cloned().ok_or_else(|| {
                    let names = traits.into_iter().flat_map(|all| all.keys().map(String::as_str)).collect();
                    among(format!("scenes have no trait `{member}`"), member, names)
                })
            }
            (port, ITERATIONS) if self.declared.contains(&port) => {
                let linked = self.ports.iter().find(|(known, ..)| *known == port);
                let said = linked.and_then(|(_, facts, _)| facts.module()?.facts.get(ITERATIONS));
                Ok(said.cloned().unwrap_or(Value::U32(0)))
            }
            (port, _) => {
                let Some((_, facts, texture)) = self.ports.iter().find(|(known, ..)| *known == port) else {
                    if self.declared.contains(&port) {
                        absent.replace(Some((port.to_owned(), member.to_owned())));
                    }
                    return Err(among(format!("there is no input `{port}`"), port, self.declared.clone()));
                };
                let size = texture.and_then(|texture| match member {
                    "width" => Some(texture.size.0),
                    "height" => Some(texture.size.1),
                    "layers" => Some(texture.layers),
                    "supersampling" => self.frame.map(|frame| supersampling(texture, frame)),
                    _ => None,
                });
                size.map(Value::U32).or_else(|| facts.get(member).cloned()).ok_or_else(|| {
                    absent.replace(Some((port.to_owned(), member.to_owned())));
                    let sizes = texture.iter().flat_map(|_| ["width", "height", "layers", "supersampling"]);
                    let names = facts.iter().map(|(name, _)| name).chain(sizes).collect();
                    among(format!("`{port}` has neither a fact nor a size `{member}`"), member, names)
                })
            }
        }
    }
}
