//! What values can be given to from outside, and what parameters inherit from settings.

use super::{Parameter, Resolved};
use crate::codes;
use crate::description::{Set, SetValue};
use crate::port::PassTypes;
use data_file::{Diagnostic, Name, Setting, Span, Value};
use rustc_hash::FxHashMap;

/// Something that a value can be given to from outside.
#[derive(Clone, Debug, PartialEq)]
pub struct Settable {
    /// The path, as [`Overrides`](super::Overrides) take it.
    pub path: String,
    /// What it may be.
    pub setting: Setting,
    /// What it is.
    pub value: Value,
}

/// The settings that each parameter is handed to as it is, by the sub-graph that declares it and its name; of the
/// pipeline itself, the sub-graph has no name.
type Heirs = FxHashMap<(Name, Name), Vec<Setting>>;

impl Resolved {
    /// Returns all that a value can be given to from outside: parameters, `sub-graph.parameter`, `pass.setting`.
    ///
    /// A parameter that is the whole value of a setting, also of one within sub-graphs, inherits what it does not say
    /// itself: default, choices, unit and documentation of the first such setting. Its range ends where that of any
    /// of them does. Passes whose pass types cannot say their settings are left out: linking reports why.
    pub fn settable(&self, kinds: &dyn PassTypes) -> Vec<Settable> {
        let (mut passes, mut heirs) = (Vec::new(), Heirs::default());
        self.settings(kinds, &mut heirs, &mut |node, setting, given| {
            passes.push(Settable {
                path: format!("{}.{}", self.nodes[node].name, setting.name),
                setting: setting.clone(),
                value: given.unwrap_or(&setting.default).clone(),
            });
        });
        let parts = self.parts(&mut heirs);
        let own = self.parameters.iter().map(|parameter| inherit(&heirs, &Name::default(), parameter, ""));
        let mut found: Vec<Settable> = own.chain(parts).collect();
        found.append(&mut passes);
        found
    }

    /// Returns where the value of one of [`Resolved::settable`] was given; `None` where it is the default of the pass type.
    pub fn given_at(&self, path: &str) -> Option<Span> {
        let (owner, name) = path.rsplit_once('.').unwrap_or(("", path));
        let of = |parameters: &[Parameter]| {
            parameters.iter().rev().find(|p| p.setting.name == name && p.value.is_some()).map(|p| p.place)
        };
        let part = || self.part_parameters.iter().find(|(part, _)| part == owner);
        let place = match self.index.get(owner).map(|i| &self.nodes[*i as usize].decl) {
            _ if owner.is_empty() => of(&self.parameters),
            Some(decl) if !decl.set.is_empty() && part().is_none() => {
                decl.set.iter().find(|set| set.name.value == name).map(|set| set.place)
            }
            _ => part().and_then(|(_, parameters)| of(parameters)),
        };
        place.map(|place| self.sources.span(place))
    }

    /// Calls `f` with every setting of every pass, and its value where one is known; notes which parameters are
    /// handed to them.
    fn settings(
        &self,
        kinds: &dyn PassTypes,
        heirs: &mut Heirs,
        f: &mut dyn FnMut(usize, &Setting, Option<&Value>),
    ) {
        for (i, node) in self.nodes.iter().enumerate() {
            let Some(use_) = node.decl.use_of(&node.decl.link_names) else { continue };
            let settings = kinds.settings(use_);
            for setting in settings.iter().flat_map(|settings| settings.iter()) {
                let given = node.decl.set.iter().find(|set| set.name.value == *setting.name);
                if let Some(parameter) = given.and_then(Set::parameter) {
                    let key = (self.scope(i), parameter.clone());
                    heirs.entry(key).or_default().push(setting.clone());
                }
                f(i, setting, given.and_then(|set| set.value.get()));
            }
        }
    }

    /// Returns the parameters of all sub-graphs; notes which of the parameters around them are handed to them.
    fn parts(&self, heirs: &mut Heirs) -> Vec<Settable> {
        let mut found = Vec::new();
        // What is within a sub-graph comes before the sub-graph.
        for (part, parameters) in &self.part_parameters {
            let around = self.around(part);
            for parameter in parameters {
                let settable = inherit(heirs, part, parameter, &format!("{part}."));
                if let Some(outer) = &parameter.outer {
                    let key = (around.clone(), outer.clone());
                    heirs.entry(key).or_default().push(settable.setting.clone());
                }
                found.push(settable);
            }
        }
        found
    }

    /// Reports which parameters have no default and can inherit none.
    pub(crate) fn check_defaults(&self, kinds: &dyn PassTypes) -> Vec<Diagnostic> {
        let parts = self.part_parameters.iter().map(|(part, parameters)| (part.clone(), parameters));
        let all = parts.chain([(Name::default(), &self.parameters)]);
        let open: Vec<(Name, &Parameter)> = all
            .flat_map(|(part, parameters)| parameters.iter().map(move |p| (part.clone(), p)))
            .filter(|(_, parameter)| parameter.value.is_none())
            .collect();
        if open.is_empty() {
            return Vec::new();
        }
        let mut heirs = Heirs::default();
        self.settings(kinds, &mut heirs, &mut |_, _, _| {});
        self.parts(&mut heirs);
        let mut errors = Vec::new();
        for (part, parameter) in open {
            let name = &parameter.setting.name;
            let heirs = heirs.get(&(part, Name::from(name.as_str()))).map_or(&[][..], Vec::as_slice);
            let (code, message) = match heirs {
                [] => {
                    let message = format!(
                        "the parameter `{name}` needs a `default`: it is the whole value of no setting"
                    );
                    (&codes::MISSING_FIELD, message)
                }
                [first, ..] if first.default.clone().convert(parameter.setting.ty).is_none() => {
                    let (is, default) = (parameter.setting.ty.with_article(), &first.default);
                    let message =
                        format!("`{name}` is {is}, and {default}, the default of `{}`, is not", first.name);
                    (&codes::PARAMETER, message)
                }
                [first, others @ ..] => {
                    let Some(other) = others.iter().find(|other| other.default != first.default) else {
                        continue;
                    };
                    let message = format!(
                        "the parameter `{name}` needs a `default`: it is the value of `{}`, which is {} where \
                         nothing is given, and of `{}`, which is {}",
                        first.name, first.default, other.name, other.default
                    );
                    (&codes::MISSING_FIELD, message)
                }
            };
            errors.push(Diagnostic::new(code, message).label(self.sources.span(parameter.place), ""));
        }
        errors
    }

    /// Returns the parameter of the pipeline itself that a value within a sub-graph comes from, where all of it is
    /// handed on.
    pub(super) fn root(&self, node: usize, name: &Name) -> Option<Name> {
        let (mut scope, mut name) = (self.scope(node), name.clone());
        while !scope.is_empty() {
            let (_, parameters) = self.part_parameters.iter().find(|(part, _)| *part == scope)?;
            let parameter = parameters.iter().find(|p| p.setting.name == *name)?;
            name = parameter.outer.clone()?;
            scope = self.around(&scope);
        }
        Some(name)
    }

    /// Returns the sub-graph around a sub-graph.
    fn around(&self, part: &Name) -> Name {
        self.index.get(part).map_or_else(Name::default, |node| self.scope(*node as usize))
    }

    /// Returns the sub-graph whose parameters the values of a node may name.
    fn scope(&self, node: usize) -> Name {
        let mut at = self.nodes[node].parent;
        while let Some(part) = at.map(|at| &self.nodes[at as usize]) {
            if self.part_parameters.iter().any(|(name, _)| *name == part.name) {
                return part.name.clone();
            }
            at = part.parent;
        }
        Name::default()
    }
}

impl Set {
    /// Returns the parameter that the file gives the setting as it is.
    fn parameter(&self) -> Option<&Name> {
        match &self.value {
            SetValue::Parameter(name, _) if !self.foreign => Some(name),
            _ => self.instead_of.as_ref(),
        }
    }
}

/// Returns a parameter with what it inherits.
fn inherit(heirs: &Heirs, part: &Name, parameter: &Parameter, prefix: &str) -> Settable {
    let mut setting = parameter.setting.clone();
    let key = (part.clone(), Name::from(setting.name.as_str()));
    for heir in heirs.get(&key).into_iter().flatten() {
        let tighter = |own: Option<f64>, other: Option<f64>, pick: fn(f64, f64) -> f64| match (own, other) {
            (Some(own), Some(other)) => Some(pick(own, other)),
            (own, other) => own.or(other),
        };
        setting.min = tighter(setting.min, heir.min, f64::max);
        setting.max = tighter(setting.max, heir.max, f64::min);
        if setting.one_of.is_empty() {
            setting.one_of.clone_from(&heir.one_of);
        }
        if setting.unit.is_empty() {
            setting.unit.clone_from(&heir.unit);
        }
        if setting.doc.is_empty() {
            setting.doc.clone_from(&heir.doc);
        }
    }
    if parameter.value.is_none()
        && let Some(default) = heirs.get(&key).and_then(|heirs| heirs[0].default.clone().convert(setting.ty))
    {
        setting.default = default;
    }
    let value = parameter.value.clone().unwrap_or_else(|| setting.default.clone());
    Settable { path: format!("{prefix}{}", setting.name), setting, value }
}
