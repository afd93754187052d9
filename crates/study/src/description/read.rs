//! Reads a study, and checks what needs no pipeline and no scene.

mod claims;
mod file;

use super::{
    At, Budget, Group, Phase, Pipelines, Reference, SEED, SIZE, Set, Study, StudyFigure, Variant, Vary,
    size_value,
};
use crate::codes;
use crate::external::External;
use crate::measure::Measure;
use crate::record::AxisValue;
use data_file::grammar::{Entries, Expected, Number, Reader, Spanned, read, read_broken};
use data_file::{Diagnostic, Diagnostics, Place, Source, Span};
use file::{
    All, BudgetFile, Crop, FigureFile, Given, GroupFile, LightsFile, NamedLights, NamedVariant, Names,
    PipelinesFile, ReferenceFile, SeedsFile, Sets, StudyFile, Text, ValueFile, VariantFile, VaryFile, Whole,
};
use std::sync::Arc;

const VALUE: &str = "a truth value, a finite number or text";
const PIXELS: &str = "a size in pixels: (width, height)";
const LARGEST_SIDE: u32 = 16_384;
const FRAMES: u32 = 5;
/// The greatest number of frames of a reference, or of a budget of time, unless the file gives another.
const MOST_FRAMES: u32 = 1 << 20;
/// The time that an external program has, unless the file gives another, and the longest \[s\].
const LIMIT: u32 = 600;
const MOST_LIMIT: u32 = 7 * 24 * 3600;

pub(super) fn parse(source: Arc<Source>) -> Result<Study, Diagnostics> {
    let study = read(&source, 0, |reader, file| Checks { reader }.study(file))?;
    study.consistent_as_written()?;
    Ok(study)
}

/// Returns what can be read of a study in which something is wrong.
pub(super) fn parse_broken(source: &Arc<Source>) -> Option<Study> {
    read_broken(source, |reader, file| Checks { reader }.study(file))
}

/// Returns which fields and forms may stand at a byte of a study file.
pub(super) fn expected(text: &str, at: usize) -> Expected {
    data_file::grammar::expected::<StudyFile>(text, at)
}

/// The checks of the values of a file.
struct Checks<'a, 'b> {
    reader: &'a mut Reader<'b>,
}

impl Checks<'_, '_> {
    fn study(mut self, Spanned { value: file, place }: Spanned<StudyFile>) -> Study {
        let source = Arc::clone(self.reader.source);
        let stem = source.name.rsplit(['/', '\\']).next().unwrap_or_default();
        Study {
            name: stem.strip_suffix(".ron").unwrap_or(stem).to_owned(),
            title: file.title.unwrap_or_default(),
            about: file.about.unwrap_or_default(),
            paper: file.paper.unwrap_or_default(),
            scenes: self.names(file.scenes, "a scene"),
            output: match file.output {
                Some(output) => self.at(output),
                None => At { value: "indirect".to_owned(), span: self.span(place) },
            },
            pipelines: self.pipelines(file.pipelines),
            size: file.size.map_or((512, 512), |size| self.size(size.0)),
            first_frame: file.first_frame.map_or(0, |number| self.whole(number, 0, 1 << 30)),
            jump: file.jump.map(|number| self.whole_at(number, 1, 1 << 30)),
            set: self.set(file.set),
            vary: match file.vary {
                None => Vec::new(),
                Some(VaryFile::List(groups)) => groups.into_iter().map(|group| self.group(group)).collect(),
                Some(VaryFile::Other(group)) => vec![self.group(group)],
            },
            budget: file.budget.map_or(Budget::Frames(FRAMES), |budget| self.budget(budget)),
            warm_up: file.warm_up.map_or(1, |number| self.whole(number, 0, 1 << 20)),
            seeds: file.seeds.map_or(vec![0], |seeds| self.seeds(seeds)),
            measures: self.measures(file.measures),
            phases: file.phases.map(|phases| self.phases(phases)).unwrap_or_default(),
            figures: file.figures.map(|figures| self.figures(figures)).unwrap_or_default(),
            reference: file.reference.map_or(Reference::None, |reference| self.reference(reference)),
            claims: file.claims.map(|claims| self.claims(claims)).unwrap_or_default(),
            crops: file.crops.map(|crops| self.crops(&crops)).unwrap_or_default(),
            source,
        }
    }

    fn span(&self, place: Place) -> Span {
        self.reader.span(self.reader.head(place))
    }

    fn at<T>(&self, value: Spanned<T>) -> At<T> {
        At { span: self.reader.span(value.place), value: value.value }
    }

    /// Returns several texts; reports an error if there are none.
    fn names(&mut self, names: Names, what: &str) -> Vec<At<String>> {
        self.filled(&names, &format!("a list: [{what}, …]"));
        names.value.into_iter().map(|name| self.at(name)).collect()
    }

    fn filled<T>(&mut self, list: &Spanned<Vec<T>>, expected: &str) {
        if list.is_empty() {
            let message = format!("there is nothing in it: expected {expected}");
            self.reader.error(&codes::EMPTY, list.place, message);
        }
    }

    fn whole(&mut self, number: Whole, min: u32, max: u32) -> u32 {
        match u32::try_from(number.value) {
            Ok(n) if (min..=max).contains(&n) => n,
            _ => {
                let code = if number.value == 0 { &codes::EMPTY } else { &codes::RANGE };
                let message = format!("expected a whole number from {min} to {max}, found {}", *number);
                self.reader.error(code, number.place, message);
                min
            }
        }
    }

    fn whole_at(&mut self, number: Whole, min: u32, max: u32) -> At<u32> {
        At { value: self.whole(number, min, max), span: self.reader.span(number.place) }
    }

    fn positive(&mut self, number: Spanned<Number>) -> f64 {
        let value = number.as_f64();
        if !(value > 0.0 && value.is_finite()) {
            let message = format!("expected a number above 0, found {value}");
            self.reader.error(&codes::RANGE, number.place, message);
        }
        value
    }

    fn size(&mut self, [width, height]: [Whole; 2]) -> (u32, u32) {
        (self.whole(width, 1, LARGEST_SIDE), self.whole(height, 1, LARGEST_SIDE))
    }

    fn value(&mut self, value: Spanned<ValueFile>, is_size: bool) -> At<AxisValue> {
        let span = self.reader.span(value.place);
        let found = match value.value {
            ValueFile::Bool(b) if !is_size => AxisValue::Bool(b),
            ValueFile::Number(number) if !is_size && number.is_finite() => AxisValue::Number(number),
            ValueFile::Text(text) if !is_size => AxisValue::Text(text),
            ValueFile::Tuple(sides) if is_size && sides.len() == 2 => {
                size_value(self.size([sides[0], sides[1]]))
            }
            _ => {
                self.reader.wrong(value.place, if is_size { PIXELS } else { VALUE });
                AxisValue::Bool(false)
            }
        };
        At { value: found, span }
    }

    fn set(&mut self, sets: Sets) -> Vec<Set> {
        let set = |(path, value): (Text, Given<_>)| {
            let (value, optional) = value.value();
            Set { path: self.at(path), value: self.value(value, false), optional }
        };
        sets.into_iter().map(set).collect()
    }

    fn pipelines(&mut self, file: Spanned<PipelinesFile>) -> Pipelines {
        let place = file.place;
        match file.value {
            PipelinesFile::Other(All { except }) => {
                let except = except.map(|names| self.names(names, "a pipeline")).unwrap_or_default();
                Pipelines::All { except, span: self.span(place) }
            }
            PipelinesFile::List(variants) => {
                let variants = Spanned { value: variants, place };
                let expected = "a list of pipelines: [\"name\", Variant(name: \"…\", pipeline: \"…\"), …]";
                self.filled(&variants, expected);
                Pipelines::These(variants.value.into_iter().map(|file| self.variant(file)).collect())
            }
        }
    }

    fn variant(&mut self, file: VariantFile) -> Variant {
        match file {
            VariantFile::Text(pipeline) => {
                let stem = pipeline.rsplit('/').next().unwrap_or_default();
                let name = pipeline.with(stem.strip_suffix(".ron").unwrap_or(stem).to_owned());
                Variant { name: self.at(name), pipeline: self.at(pipeline), set: Vec::new(), external: None }
            }
            VariantFile::Other(NamedVariant::Variant { name, pipeline, set }) => Variant {
                name: self.at(name),
                pipeline: self.at(pipeline),
                set: self.set(set),
                external: None,
            },
            VariantFile::Other(NamedVariant::External { name, command, limit }) => {
                let limit = limit.map_or(LIMIT, |limit| self.whole(limit, 1, MOST_LIMIT));
                let external = Some(External { command: command.value.clone(), limit });
                Variant { name: self.at(name), pipeline: self.at(command), set: Vec::new(), external }
            }
        }
    }

    fn group(&mut self, file: GroupFile) -> Group {
        let (name, axes) = match file {
            GroupFile::Grid(axes) => ("Grid", axes),
            GroupFile::Paired(axes) => ("Paired", axes),
        };
        if axes.0.is_empty() {
            self.reader.error(&codes::EMPTY, axes.place, format!("`{name}` has no axes"));
        }
        let axes: Vec<Vary> = axes.value.into_iter().map(|(path, values)| self.axis(path, values)).collect();
        if name == "Grid" {
            return Group::Grid(axes);
        }
        if let Some((first, other)) = axes.first().and_then(|first| {
            Some((first, axes.iter().find(|axis| axis.values.len() != first.values.len())?))
        }) {
            let values = |axis: &Vary| match axis.values.len() {
                1 => "1 value".to_owned(),
                n => format!("{n} values"),
            };
            let error =
                Diagnostic::new(&codes::PAIRED, "axes that are paired need the same number of values")
                    .label(other.path.span.clone(), values(other))
                    .label(first.path.span.clone(), values(first));
            self.reader.report(error);
        }
        Group::Paired(axes)
    }

    fn axis(&mut self, path: Text, values: Given<Spanned<Vec<Spanned<ValueFile>>>>) -> Vary {
        let (values, optional) = values.value();
        let is_size = path.value == SIZE;
        self.filled(
            &values,
            if is_size { "sizes: [(width, height), …]" } else { "a list of values: [value, …]" },
        );
        if path.value == SEED {
            let error = Diagnostic::new(&codes::PATH, "the seed is no axis")
                .label(self.reader.span(path.place), "")
                .note("write `seeds: 5` or `seeds: [1, 2, 3]`");
            self.reader.report(error);
        }
        let values = values.value.into_iter().map(|value| self.value(value, is_size)).collect();
        Vary { path: self.at(path), values, optional }
    }

    fn budget(&mut self, file: BudgetFile) -> Budget {
        let (count, by, frames) = match file {
            BudgetFile::Frames(frames) => return Budget::Frames(self.whole(frames, 1, MOST_FRAMES)),
            BudgetFile::Time { ms, by, frames } => {
                let default = if by.is_some() { FRAMES } else { MOST_FRAMES };
                return Budget::Time {
                    ms: self.positive(ms),
                    by: by.map(|by| self.at(by)),
                    frames: frames.map_or(default, |frames| self.whole(frames, 1, MOST_FRAMES)),
                };
            }
            BudgetFile::Lights(LightsFile::Form(NamedLights { count, by, frames })) => (count, by, frames),
            BudgetFile::Lights(LightsFile::Other(count)) => (count, None, None),
        };
        Budget::Lights {
            count: self.whole_at(count, 1, u32::MAX),
            by: self.at(by.unwrap_or_else(|| count.with("lights".to_owned()))),
            frames: frames.map_or(FRAMES, |frames| self.whole(frames, 1, MOST_FRAMES)),
        }
    }

    /// Returns the seeds: `5` stands for 1 to 5. Seed 0 is left out, since it gives the sequences without
    /// randomisation.
    fn seeds(&mut self, file: SeedsFile) -> Vec<u32> {
        let list = match file {
            SeedsFile::Other(count) => return (1..=self.whole(count, 1, 100_000)).collect(),
            SeedsFile::List(list) => list,
        };
        self.filled(&list, "seeds: [1, 2, 3]");
        let mut seeds: Vec<(u32, Place)> = Vec::new();
        for number in list.value {
            let Ok(seed) = u32::try_from(number.value) else {
                let message = format!("a seed is from 0 to {}, and {} is not", u32::MAX, *number);
                self.reader.error(&codes::RANGE, number.place, message);
                continue;
            };
            match seeds.iter().find(|(other, _)| *other == seed) {
                Some((_, first)) => self.twice(&format!("seed {seed}"), number.place, *first),
                None => seeds.push((seed, number.place)),
            }
        }
        seeds.into_iter().map(|(seed, _)| seed).collect()
    }

    fn twice(&mut self, what: &str, again: Place, first: Place) {
        let error = twice(what, &self.reader.span(again), &self.reader.span(first));
        self.reader.report(error);
    }

    fn measures(&mut self, names: Names) -> Vec<At<Measure>> {
        self.filled(&names, "a list: [a measure, …]");
        let mut found: Vec<Spanned<Measure>> = Vec::new();
        for name in names.value {
            let Some(measure) = Measure::find(&name) else {
                let error = Diagnostic::new(&codes::MEASURE, format!("there is no measure `{}`", *name))
                    .label(self.reader.span(name.place), "")
                    .suggest("measures", &name, Measure::all().map(Measure::key))
                    .note("`lightloom measures` says what each of them is");
                self.reader.report(error);
                continue;
            };
            match found.iter().find(|at| at.value == measure) {
                Some(first) => self.twice(&format!("`{}`", *name), name.place, first.place),
                None => found.push(name.with(measure)),
            }
        }
        found.into_iter().map(|measure| self.at(measure)).collect()
    }

    /// Reports a map without entries, and entries without names.
    fn named<T>(&mut self, entries: &Spanned<Entries<T>>, what: &str) {
        if entries.0.is_empty() {
            self.reader.error(&codes::EMPTY, entries.place, format!("there is no {what} in it"));
        }
        for (name, _) in entries.0.iter().filter(|(name, _)| name.trim().is_empty()) {
            self.reader.error(&codes::EMPTY, name.place, format!("a {what} needs a name"));
        }
    }

    fn phases(&mut self, phases: Spanned<Entries<Names>>) -> Vec<Phase> {
        self.named(&phases, "phase");
        let phase =
            |(name, passes)| Phase { name: self.at(name), passes: self.names(passes, "a pass or sub-graph") };
        phases.value.into_iter().map(phase).collect()
    }

    fn figures(&mut self, figures: Spanned<Entries<FigureFile>>) -> Vec<StudyFigure> {
        self.named(&figures, "figure");
        let figure = |(name, FigureFile(of))| StudyFigure { name: self.at(name), of: self.at(of) };
        figures.value.into_iter().map(figure).collect()
    }

    fn reference(&mut self, file: Spanned<ReferenceFile>) -> Reference {
        let span = self.span(file.place);
        match file.value {
            ReferenceFile::Picture(file) => Reference::Pictures(vec![(None, self.at(file))]),
            ReferenceFile::Pictures(files) => {
                let files = files.into_iter();
                Reference::Pictures(
                    files.map(|(scene, file)| (Some(self.at(scene)), self.at(file))).collect(),
                )
            }
            ReferenceFile::Pipeline { pipeline, set, follow, frames } => Reference::Pipeline {
                pipeline: self.at(pipeline),
                set: self.set(set),
                follow: follow.map(|names| self.names(names, "an axis")).unwrap_or_default(),
                frames: frames.map_or(MOST_FRAMES, |frames| self.whole(frames, 1, MOST_FRAMES)),
                span,
            },
        }
    }

    /// Returns the crops; those that do not lie in the picture are reported.
    fn crops(&mut self, crops: &Spanned<Vec<Spanned<Crop>>>) -> Vec<[f64; 4]> {
        self.filled(crops, "a list: [(left, top, width, height), …]");
        let crop = |crop: &Spanned<Crop>| {
            let numbers @ [left, top, width, height] = crop.0.map(Number::as_f64);
            // What was rounded may reach a little over the edge.
            let lies_in =
                |start: f64, length: f64| start >= 0.0 && length > 0.0 && start + length <= 1.0 + 1e-6;
            if !(lies_in(left, width) && lies_in(top, height)) {
                let message = "a crop lies in the picture, whose sides are 1, and has a width and a height";
                self.reader.error(&codes::RANGE, crop.place, message);
            }
            numbers
        };
        crops.iter().map(crop).collect()
    }
}

pub(super) fn twice(what: &str, again: &Span, first: &Span) -> Diagnostic {
    Diagnostic::new(&codes::TWICE, format!("{what} is given twice"))
        .label(again.clone(), "again here")
        .label(first.clone(), "first here")
}
