//! What parts of a study's file say of each other.

use super::read::twice;
use super::{At, Group, Pipelines, Reference, SEED, Study, Vary};
use crate::codes;
use crate::measure::Measure;
use frame_graph::{Diagnostic, Diagnostics, Span};

impl Study {
    /// Tells all that contradicts itself or is given twice, and measures that lack what they need.
    pub(crate) fn consistent(&self) -> Result<(), Diagnostics> {
        let errors = errors(self);
        if errors.is_empty() { Ok(()) } else { Err(Diagnostics::sorted(errors)) }
    }
}

fn errors(study: &Study) -> Vec<Diagnostic> {
    let mut errors = Vec::new();
    once(&mut errors, "the scene", study.scenes.iter().map(|at| (at.value.as_str(), &at.span)));
    if let Pipelines::These(variants) = &study.pipelines {
        let names = variants.iter().map(|variant| (variant.name.value.as_str(), &variant.name.span));
        once(&mut errors, "a pipeline named", names);
    }
    let axes = || study.vary.iter().flat_map(Group::axes);
    once(&mut errors, "the axis", axes().map(|axis| (axis.path.value.as_str(), &axis.path.span)));
    for axis in axes().filter(|axis| study.is_grid(axis)) {
        let values: Vec<String> = axis.values.iter().map(|value| value.value.to_string()).collect();
        once(
            &mut errors,
            "the value",
            values.iter().map(String::as_str).zip(axis.values.iter().map(|v| &v.span)),
        );
    }
    for axis in axes() {
        let path = &axis.path.value;
        if let Some(set) = study.set.iter().find(|set| set.path.value == *path) {
            errors.push(twice(&format!("`{path}` is varied, and it"), &axis.path.span, &set.path.span));
        }
    }
    if let Some(by) = study.budget.by() {
        let varied = axes().map(|axis| (&axis.path, "is varied"));
        let given = varied.chain(study.set.iter().map(|set| (&set.path, "has a value")));
        for (path, what) in given.filter(|(path, _)| path.value == by.value) {
            let message = format!("`{}` {what}, and the budget sets it as well", by.value);
            errors.push(
                Diagnostic::new(&codes::BUDGET, message)
                    .label(path.span.clone(), "here")
                    .label(by.span.clone(), "the budget"),
            );
        }
    }
    if let Reference::Pipeline { follow, .. } = &study.reference {
        for name in follow {
            let known: Vec<&str> = axes().map(|axis| axis.path.value.as_str()).chain([SEED]).collect();
            if !known.contains(&name.value.as_str()) {
                let error = Diagnostic::new(
                    &codes::REFERENCE,
                    format!("the reference cannot follow `{}`: it is no axis", name.value),
                )
                .label(name.span.clone(), "")
                .suggest("axes", &name.value, known);
                errors.push(error);
            }
        }
    }
    for at in &study.measures {
        needs(study, at, &mut errors);
    }
    errors
}

/// Whether a measure has what it needs.
fn needs(study: &Study, at: &At<Measure>, errors: &mut Vec<Diagnostic>) {
    let (measure, needs) = (at.value, at.value.needs());
    let mut lacks = |what: String, note: &str| {
        let error = Diagnostic::new(&codes::NEEDS, format!("`{}` needs {what}", measure.key()))
            .label(at.span.clone(), "")
            .note(note);
        errors.push(error);
    };
    if needs.reference && matches!(study.reference, Reference::None) {
        lacks("a reference".to_owned(), "add `reference: Pipeline(pipeline: \"reference\")`");
    }
    if needs.every_frame && matches!(study.reference, Reference::Pictures(_)) {
        lacks("a reference of every frame".to_owned(), "a picture is of one; take `Pipeline(…)`");
    }
    if study.budget.frames() < needs.frames {
        lacks(format!("at least {} frames", needs.frames), "give them with `budget: Frames(…)`");
    }
    if needs.seeds && study.seeds.len() < 2 {
        lacks("at least 2 seeds".to_owned(), "add `seeds: 5`");
    }
    if needs.jump && study.jump.is_none() {
        lacks("`jump`".to_owned(), "add `jump: N`, the number of the first frame under the new light");
    }
}

fn once<'a>(errors: &mut Vec<Diagnostic>, what: &str, names: impl Iterator<Item = (&'a str, &'a Span)>) {
    let mut seen: Vec<(&str, &Span)> = Vec::new();
    for (name, span) in names {
        match seen.iter().find(|(other, _)| *other == name) {
            Some((_, first)) => errors.push(twice(&format!("{what} `{name}`"), span, first)),
            None => seen.push((name, span)),
        }
    }
}

impl Study {
    /// Whether the values of an axis are combined with all others, so that each may be given once only.
    fn is_grid(&self, axis: &Vary) -> bool {
        self.vary.iter().any(|group| {
            matches!(group, Group::Grid(axes) if axes.iter().any(|other| other.path.span == axis.path.span))
        })
    }
}
