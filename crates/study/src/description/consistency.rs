//! Checks that the parts of a study's file agree with each other.

use super::read::twice;
use super::{
    At, Claim, Group, Phase, Pipelines, Reference, Relation, SEED, Study, StudyFigure, TRIANGLES, Vary,
    place_of,
};
use crate::codes;
use crate::growth::FEWEST_VALUES;
use crate::measure::Measure;
use crate::record::AxisValue;
use frame_graph::{Diagnostic, Diagnostics, Span};

impl Study {
    /// Reports contradictions, entries that are given twice, and measures that lack what they need.
    pub(crate) fn consistent(&self) -> Result<(), Diagnostics> {
        result(errors(self))
    }

    /// Checks the same for a file as it is written, and also the scenes and values of axes that claims name.
    /// (A run may be asked for other or fewer values; such a claim is then not measured.)
    pub(crate) fn consistent_as_written(&self) -> Result<(), Diagnostics> {
        let mut errors = errors(self);
        for claim in &self.claims {
            for (axis, value) in claim.pins() {
                errors.extend(self.unknown_value(axis, value));
            }
            let scenes: Vec<&str> = self.scenes.iter().map(|at| at.value.as_str()).collect();
            for scene in claim.scenes.iter().filter(|at| !scenes.contains(&at.value.as_str())) {
                let message = format!("`{}` is no scene of this study", scene.value);
                errors.push(scene.unknown(&codes::CLAIM, message, "scenes", scenes.iter().copied()));
            }
            if let Relation::Growth { over, .. } = &claim.relation {
                errors.extend(self.unfit_axis(claim, over));
            }
        }
        result(errors)
    }

    /// Returns what is wrong with a value of an axis in a claim.
    fn unknown_value(&self, name: &At<String>, value: &At<AxisValue>) -> Option<Diagnostic> {
        let axes: Vec<&Vary> = self.vary.iter().flat_map(Group::axes).collect();
        let Some(axis) = axes.iter().find(|axis| axis.path.value == name.value) else {
            let names = axes.iter().map(|axis| axis.path.value.as_str());
            let message = format!("a claim is made at `{}`, which is no axis", name.value);
            return Some(name.unknown(&codes::CLAIM, message, "axes", names));
        };
        if axis.values.iter().any(|at| at.value == value.value) {
            return None;
        }
        let values: Vec<String> = axis.values.iter().map(|at| at.value.to_string()).collect();
        let message = format!("the axis `{}` never is {}", name.value, value.value);
        Some(value.error(&codes::CLAIM, message).note(format!("it is {}", values.join(", "))))
    }
}

impl Study {
    /// Returns what is wrong with the axis over which a claim says that a measure grows.
    fn unfit_axis(&self, claim: &Claim, over: &At<String>) -> Option<Diagnostic> {
        let name = &over.value;
        let error = |message: String| over.error(&codes::CLAIM, message);
        if let Some((pinned, _)) = claim.pins().find(|(axis, _)| axis.value == *name) {
            let message = format!("an exponent over `{name}` needs all its values");
            return Some(error(message).label(pinned.span.clone(), "leaves one of them"));
        }
        let few = |count: usize, what: &str| {
            let message = format!("an exponent is of {FEWEST_VALUES} {what} at least, and these are {count}");
            (count < FEWEST_VALUES).then(|| error(message))
        };
        if name == TRIANGLES {
            return few(
                if claim.scenes.is_empty() { self.scenes.len() } else { claim.scenes.len() },
                "scenes",
            );
        }
        let axes: Vec<&Vary> = self.vary.iter().flat_map(Group::axes).collect();
        let Some(axis) = axes.iter().find(|axis| axis.path.value == *name) else {
            let names = axes.iter().map(|axis| axis.path.value.as_str()).chain([TRIANGLES]);
            let message = format!("a measure cannot grow over `{name}`, which is no axis");
            return Some(over.unknown(&codes::CLAIM, message, "axes", names));
        };
        let mut places = Vec::new();
        for at in &axis.values {
            match place_of(&at.value).filter(|place| *place > 0.0) {
                Some(place) => places.push(place),
                None => {
                    let message =
                        format!("an exponent is over numbers above 0, and `{name}` is {}", at.value);
                    return Some(error(message).label(at.span.clone(), "here"));
                }
            }
        }
        places.sort_by(f64::total_cmp);
        places.dedup();
        few(places.len(), &format!("values of `{name}`"))
    }
}

impl Claim {
    /// Returns every value of an axis in the claim, with the axis.
    fn pins(&self) -> impl Iterator<Item = &(At<String>, At<AxisValue>)> {
        self.at.iter().chain(self.relation.picks().into_iter().flat_map(|pick| &pick.at))
    }
}

fn result(errors: Vec<Diagnostic>) -> Result<(), Diagnostics> {
    if errors.is_empty() { Ok(()) } else { Err(Diagnostics::sorted(errors)) }
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
                let message = format!("the reference cannot follow `{}`: it is no axis", name.value);
                errors.push(name.unknown(&codes::REFERENCE, message, "axes", known));
            }
        }
    }
    for at in &study.measures {
        needs(study, at, &mut errors);
    }
    for phase in &study.phases {
        once(&mut errors, "the pass", phase.passes.iter().map(|at| (at.value.as_str(), &at.span)));
    }
    for claim in &study.claims {
        measured(study, claim, &mut errors);
    }
    errors
}

/// Checks that the study takes the measure of a claim, and that no axis is given two values.
fn measured(study: &Study, claim: &Claim, errors: &mut Vec<Diagnostic>) {
    let figures = study.figures.iter().map(StudyFigure::key);
    let mut others: Vec<String> = study.phases.iter().map(Phase::key).chain(figures).collect();
    // Shares are of the time of a frame.
    if study.measures.iter().any(|at| at.value == Measure::GpuMs) {
        others.extend(study.phases.iter().map(Phase::share_key));
    }
    let taken = study.measures.iter().map(|at| at.value.key()).chain(others.iter().map(String::as_str));
    let taken: Vec<&str> = taken.collect();
    let name = &claim.measure;
    if !taken.contains(&name.value.as_str()) {
        let message = format!("the claim needs the measure `{}`, which is not measured", name.value);
        errors.push(name.unknown(&codes::CLAIM, message, "measures of this study", taken));
    }
    once(errors, "the scene", claim.scenes.iter().map(|at| (at.value.as_str(), &at.span)));
    for pick in claim.relation.picks() {
        let axes = claim.at.iter().chain(&pick.at).map(|(axis, _)| (axis.value.as_str(), &axis.span));
        once(errors, "the axis", axes);
    }
}

/// Checks that a measure has what it needs.
fn needs(study: &Study, at: &At<Measure>, errors: &mut Vec<Diagnostic>) {
    let (measure, needs) = (at.value, at.value.needs());
    let mut lacks = |what: String, note: &str| {
        let message = format!("`{}` needs {what}", measure.key());
        errors.push(at.error(&codes::NEEDS, message).note(note));
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
    /// Returns whether the values of an axis are combined with all others, so that each may be given only
    /// once.
    fn is_grid(&self, axis: &Vary) -> bool {
        self.vary.iter().any(|group| {
            matches!(group, Group::Grid(axes) if axes.iter().any(|other| other.path.span == axis.path.span))
        })
    }
}
