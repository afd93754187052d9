//! Puts the values of parameters, and the prefix of its sub-graph, into the declaration of a pass.

use super::Parameter;
use super::flatten::{Resolver, Scope};
use crate::codes;
use crate::description::{At, Body, Dim, Formula, Off, PassDecl, SetValue, Target, out_overrides};
use crate::expression::ExprKind;
use data_file::{Diagnostic, Name, Place, Value};
use std::sync::Arc;

impl Resolver<'_> {
    /// Puts the scope's parameters and the prefix of its sub-graph into a pass. A pass with neither is shared.
    pub(super) fn localise(&mut self, mut decl: Arc<PassDecl>, prefix: &str, scope: &Scope) -> Arc<PassDecl> {
        let in_set = decl.set.iter().any(|set| set.value.get().is_none());
        let in_outs = decl.outs.iter().any(|o| o.size.is_some() || o.count.is_some() || !o.facts.is_empty());
        if in_set || in_outs || decl.when.is_some() || !prefix.is_empty() {
            let decl = Arc::make_mut(&mut decl);
            for set in &mut decl.set {
                self.put(&mut set.value, set.place, scope);
            }
            if let Some(when) = &mut decl.when {
                self.fill(when, scope);
            }
            if in_outs {
                for out in &mut decl.outs {
                    if let Some(size) = &mut out.size {
                        size.value.dims(&mut |dim| self.dim(dim, scope));
                    }
                    if let Some(count) = &mut out.count {
                        self.dim(&mut count.value, scope);
                    }
                    for fact in &mut out.facts {
                        if let Some(value) = &mut fact.value {
                            self.put_known(value, fact.place, scope);
                        }
                    }
                }
                decl.overrides = out_overrides(&decl.outs);
            }
            if !prefix.is_empty() {
                for link in decl.links.iter_mut().chain(&mut decl.feed) {
                    link.target = prefixed(&link.target, prefix);
                }
                if let Some(At { value: Off::Link(link), .. }) = &mut decl.off {
                    link.target = prefixed(&link.target, prefix);
                }
                if let Body::Group(group) = &mut decl.body {
                    for output in &mut group.outputs {
                        output.link.target = prefixed(&output.link.target, prefix);
                    }
                }
            }
        }
        decl
    }

    pub(super) fn put(&mut self, value: &mut SetValue, place: Place, scope: &Scope) {
        match value {
            SetValue::Parameter(name, known @ None) => {
                *known = self.lookup(name, place, scope).and_then(|p| Some((p.value.clone()?, p.place)));
            }
            SetValue::Formula(formula, known @ None) => *known = self.evaluate(formula, scope),
            SetValue::Value(_) | SetValue::Parameter(..) | SetValue::Formula(..) => {}
        }
    }

    /// Puts a parameter into a value that must be known before any setting is.
    fn put_known(&mut self, value: &mut SetValue, place: Place, scope: &Scope) {
        self.put(value, place, scope);
        if let SetValue::Parameter(name, None) = value
            && let Some(parameter) = scope.iter().find(|p| p.setting.name == **name)
        {
            self.no_default(parameter, place);
        }
    }

    /// Puts parameters into an expression; `false` where one is not there, which is reported.
    fn fill(&mut self, formula: &mut Formula, scope: &Scope) -> bool {
        let text = formula.text;
        let mut whole = true;
        formula.expr.parameters(&mut |(start, end), name, value| {
            if value.is_none() {
                let place = text.within(start, end);
                let found = self.lookup(name, place, scope);
                *value = found.and_then(|p| Some((p.value.clone()?, p.place)));
                if let (Some(parameter), None) = (found, &value) {
                    self.no_default(parameter, place);
                }
                whole &= value.is_some();
            }
        });
        whole
    }

    /// Reports that a parameter has no value where one must be known.
    pub(super) fn no_default(&mut self, parameter: &Parameter, place: Place) {
        let name = &parameter.setting.name;
        let error =
            Diagnostic::new(&codes::MISSING_FIELD, format!("the parameter `{name}` needs a `default`"))
                .label(self.sources.span(place), "its value must be known here")
                .label(self.sources.span(parameter.place), "declared without one")
                .note("without a `default` it takes that of the setting whose whole value it is");
        self.errors.push(error);
    }

    /// Returns the value of an expression; `None`, after reporting an error, where it has none.
    fn evaluate(&mut self, formula: &mut Formula, scope: &Scope) -> Option<Value> {
        if !self.fill(formula, scope) {
            return None;
        }
        formula.expr.value().map_err(|error| self.report(formula, formula.error(error, &self.sources))).ok()
    }

    /// Reports an error of an expression, with the places at which its parameters got their values.
    fn report(&mut self, formula: &Formula, mut error: Diagnostic) {
        let mut origins = Vec::new();
        formula.expr.origins(&mut origins);
        for (_, _, place) in origins {
            error = error.label(self.sources.span(place), "given here");
        }
        self.errors.push(error);
    }

    /// Works out a side or a count.
    fn dim(&mut self, dim: &mut Dim, scope: &Scope) {
        let Dim::Formula(formula) = dim else { return };
        let Some(value) = self.evaluate(formula, scope) else { return };
        match value.as_u32().filter(|n| *n > 0) {
            Some(n) => *dim = Dim::Number(n),
            None => {
                let what = match &formula.expr.kind {
                    ExprKind::Parameter(name, _) => format!("`{name}`"),
                    _ => formula.expr.explained(&()),
                };
                let place = formula.text.within(formula.expr.start, formula.expr.end);
                let message = format!("{what} is {value}: a size needs a whole number above zero");
                let error =
                    Diagnostic::new(&codes::PARAMETER, message).label(self.sources.span(place), "used here");
                self.report(formula, error);
            }
        }
    }

    fn lookup<'s>(&mut self, name: &str, place: Place, scope: &'s Scope) -> Option<&'s Parameter> {
        let found = scope.iter().find(|p| p.setting.name == name);
        if let Some(found) = found {
            self.used.insert(found.declared);
        } else {
            let known = || scope.iter().map(|p| p.setting.name.as_str());
            let mut error =
                Diagnostic::new(&codes::UNKNOWN_PARAMETER, format!("there is no parameter `{name}`"))
                    .label(self.sources.span(place), "")
                    .suggest("parameters", name, known());
            if name.split_once('-').is_some_and(|(first, _)| known().any(|known| known == first)) {
                error = error.note("names may hold `-`: a minus has blanks around it");
            }
            self.errors.push(error);
        }
        found
    }
}

/// Returns a link as seen from outside the sub-graph named `prefix`.
pub(super) fn prefixed(target: &Target, prefix: &str) -> Target {
    Target { pass: Name::from(format!("{prefix}/{}", target.pass)), ..target.clone() }
}
