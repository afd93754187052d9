//! Reads a study from the syntax tree of its file: the grammar, and what can be checked in the file alone.

mod claims;
mod crops;
mod measures;

use super::{At, Budget, Group, Pipelines, Reference, SEED, SIZE, Set, Study, Variant, Vary, size_value};
use crate::record::AxisValue;
use frame_graph::codes::{Code, study as codes};
use frame_graph::reader::{Fields, Form, Node, Number, Reader, parse};
use frame_graph::{Diagnostic, Diagnostics, Source, Span};
use std::collections::BTreeMap;
use std::sync::Arc;

const STUDY: &[&str] = &[
    "about",
    "paper",
    "scenes",
    "pipelines",
    "output",
    "size",
    "first_frame",
    "jump",
    "set",
    "vary",
    "budget",
    "warm_up",
    "seeds",
    "measures",
    "phases",
    "figures",
    "reference",
    "claims",
    "crops",
];
const VARY: &str = "`Grid({ \"name\": [values] })`, `Paired({ \"name\": [values] })`, or a list of them";
const SETS: &str = "values: { \"parameter\": value, \"pass.setting\": value }";
const LARGEST_SIDE: u32 = 16_384;
const FRAMES: u32 = 5;
/// The greatest number of frames of a reference, or of a budget of time, unless the file gives another.
const MOST_FRAMES: u32 = 1 << 20;

pub(super) fn read(source: Arc<Source>) -> Result<Study, Diagnostics> {
    let study = parse(&source, |reader, tree| study(&mut Grammar { reader }, tree, &source))?;
    study.consistent_as_written()?;
    Ok(study)
}

struct Grammar<'a, 'b> {
    reader: &'a mut Reader<'b>,
}

fn study(g: &mut Grammar<'_, '_>, tree: &Node, source: &Arc<Source>) -> Option<Study> {
    let fields = g.reader.fields(tree, "`Study(…)`", &[("Study", STUDY)])?;
    let text = |g: &mut Grammar<'_, '_>, name: &str| {
        fields.get(name).and_then(|node| g.reader.text(node, "text")).unwrap_or_default().to_owned()
    };
    let (about, paper) = (text(g, "about"), text(g, "paper"));
    let scenes = g.reader.need(&fields, "scenes").map(|node| g.names(node, "a scene")).unwrap_or_default();
    let pipelines = g.reader.need(&fields, "pipelines").and_then(|node| g.pipelines(node));
    let output = match fields.get("output") {
        Some(node) => g.text_at(node, "the name of an output")?,
        None => At { value: "indirect".to_owned(), span: g.reader.head_of(tree) },
    };
    let size = fields.get("size").map_or(Some((512, 512)), |node| g.size(node));
    let first_frame = fields.get("first_frame").map_or(Some(0), |node| g.whole(node, 0, 1 << 30));
    let jump = fields
        .get("jump")
        .and_then(|node| g.whole(node, 1, 1 << 30).map(|value| At { value, span: g.reader.span_of(node) }));
    let set = fields.get("set").map(|node| g.set(node)).unwrap_or_default();
    let vary = fields.get("vary").map(|node| g.vary(node)).unwrap_or_default();
    let budget = fields.get("budget").map_or(Some(Budget::Frames(FRAMES)), |node| g.budget(node));
    let warm_up = fields.get("warm_up").map_or(Some(1), |node| g.whole(node, 0, 1 << 20));
    let seeds = fields.get("seeds").map_or(Some(vec![0]), |node| g.seeds(node));
    let measures = g.reader.need(&fields, "measures").map(|node| g.measures(node)).unwrap_or_default();
    let phases = fields.get("phases").map(|node| g.phases(node)).unwrap_or_default();
    let figures = fields.get("figures").map(|node| g.figures(node)).unwrap_or_default();
    let reference = fields.get("reference").map_or(Some(Reference::None), |node| g.reference(node));
    let claims = fields.get("claims").map(|node| g.claims(node)).unwrap_or_default();
    let crops = fields.get("crops").map(|node| g.crops(node)).unwrap_or_default();
    let stem = source.name.rsplit(['/', '\\']).next().unwrap_or_default();
    Some(Study {
        source: Arc::clone(source),
        name: stem.strip_suffix(".ron").unwrap_or(stem).to_owned(),
        about,
        paper,
        scenes,
        pipelines: pipelines?,
        output,
        size: size?,
        first_frame: first_frame?,
        jump,
        set,
        vary,
        budget: budget?,
        warm_up: warm_up?,
        seeds: seeds?,
        measures,
        phases,
        figures,
        reference: reference?,
        claims,
        crops,
    })
}

impl Grammar<'_, '_> {
    fn error(&mut self, code: &'static Code, span: Span, message: impl Into<String>) {
        self.reader.tell(Diagnostic::new(code, message).label(span, ""));
    }

    fn text_at(&mut self, node: &Node, expected: &str) -> Option<At<String>> {
        let value = self.reader.text(node, expected)?.to_owned();
        Some(At { value, span: self.reader.span_of(node) })
    }

    /// Reads several texts; reports an error if there are none.
    fn names(&mut self, node: &Node, what: &str) -> Vec<At<String>> {
        let items = self.items(node, &format!("a list: [{what}, …]"));
        items.iter().filter_map(|item| self.text_at(item, &format!("the name of {what}"))).collect()
    }

    fn items<'n>(&mut self, node: &'n Node, expected: &str) -> &'n [Node] {
        let items = self.reader.list(node, expected);
        if items.is_empty() && matches!(node.form, Form::List(_)) {
            let span = self.reader.span_of(node);
            self.error(&codes::EMPTY, span, format!("there is nothing in it: expected {expected}"));
        }
        items
    }

    /// Reads the entries of a map whose keys are texts, and reports keys that are given twice.
    fn entries<'n>(&mut self, node: &'n Node, expected: &str) -> Vec<(At<String>, &'n Node)> {
        let Form::Map(entries) = &node.form else {
            self.reader.wrong(node, expected);
            return Vec::new();
        };
        let mut found: Vec<(At<String>, &Node)> = Vec::new();
        let mut spans = BTreeMap::new();
        for (key, value) in entries {
            let Some(name) = self.text_at(key, "a name in quotes") else { continue };
            match spans.get(&name.value) {
                Some(first) => {
                    let error = twice(&format!("`{}`", name.value), &name.span, first);
                    self.reader.tell(error);
                }
                None => {
                    spans.insert(name.value.clone(), name.span.clone());
                    found.push((name, value));
                }
            }
        }
        found
    }

    fn whole(&mut self, node: &Node, min: u32, max: u32) -> Option<u32> {
        let Form::Number(Number::Integer(n)) = node.form else {
            self.reader.wrong(node, "a whole number");
            return None;
        };
        match u32::try_from(n) {
            Ok(n) if (min..=max).contains(&n) => Some(n),
            _ => {
                let span = self.reader.span_of(node);
                let code = if n == 0 { &codes::EMPTY } else { &codes::RANGE };
                self.error(code, span, format!("expected a whole number from {min} to {max}, found {n}"));
                None
            }
        }
    }

    fn positive(&mut self, node: &Node) -> Option<f64> {
        let value = match node.form {
            Form::Number(Number::Integer(n)) => n as f64,
            Form::Number(Number::Float(x)) => x,
            _ => {
                self.reader.wrong(node, "a number");
                return None;
            }
        };
        if value > 0.0 && value.is_finite() {
            return Some(value);
        }
        let span = self.reader.span_of(node);
        self.error(&codes::RANGE, span, format!("expected a number above 0, found {value}"));
        None
    }

    fn size(&mut self, node: &Node) -> Option<(u32, u32)> {
        match &node.form {
            Form::Tuple(None, items) if items.len() == 2 => {
                let width = self.whole(&items[0], 1, LARGEST_SIDE);
                Some((width?, self.whole(&items[1], 1, LARGEST_SIDE)?))
            }
            _ => {
                self.reader.wrong(node, "a size in pixels: (width, height)");
                None
            }
        }
    }

    fn value(&mut self, node: &Node) -> Option<At<AxisValue>> {
        let value = match &node.form {
            Form::Bool(b) => AxisValue::Bool(*b),
            Form::Number(Number::Integer(n)) => AxisValue::Number(*n as f64),
            Form::Number(Number::Float(x)) if x.is_finite() => AxisValue::Number(*x),
            Form::Text(text, _) => AxisValue::Text(text.clone()),
            _ => {
                self.reader.wrong(node, "a truth value, a finite number or text");
                return None;
            }
        };
        Some(At { value, span: self.reader.span_of(node) })
    }

    fn set(&mut self, node: &Node) -> Vec<Set> {
        let entries = self.entries(node, SETS);
        entries
            .into_iter()
            .filter_map(|(path, node)| {
                let (node, optional) = optional(node);
                Some(Set { path, value: self.value(node)?, optional })
            })
            .collect()
    }

    fn pipelines(&mut self, node: &Node) -> Option<Pipelines> {
        match &node.form {
            Form::Word(word) if word == "All" => {
                return Some(Pipelines::All { except: Vec::new(), span: self.reader.span_of(node) });
            }
            Form::Struct(..) | Form::Tuple(..) => {
                let fields = self.reader.fields(
                    node,
                    "a list of pipelines, or `All(except: […])`",
                    &[("All", &["except"])],
                )?;
                let except =
                    fields.get("except").map(|node| self.names(node, "a pipeline")).unwrap_or_default();
                return Some(Pipelines::All { except, span: self.reader.head_of(node) });
            }
            _ => {}
        }
        let items =
            self.items(node, "a list of pipelines: [\"name\", Variant(name: \"…\", pipeline: \"…\"), …]");
        Some(Pipelines::These(items.iter().filter_map(|item| self.variant(item)).collect()))
    }

    fn variant(&mut self, node: &Node) -> Option<Variant> {
        if let Form::Text(..) = node.form {
            let pipeline = self.text_at(node, "a pipeline")?;
            let stem = pipeline.value.rsplit('/').next().unwrap_or_default();
            let name = stem.strip_suffix(".ron").unwrap_or(stem).to_owned();
            let name = At { value: name, span: pipeline.span.clone() };
            return Some(Variant { name, pipeline, set: Vec::new() });
        }
        let expected = "the name of a pipeline, or `Variant(name: \"…\", pipeline: \"…\", set: {…})`";
        let fields = self.reader.fields(node, expected, &[("Variant", &["name", "pipeline", "set"])])?;
        let name = self.need_text(&fields, "name");
        let pipeline = self.need_text(&fields, "pipeline");
        let set = fields.get("set").map(|node| self.set(node)).unwrap_or_default();
        Some(Variant { name: name?, pipeline: pipeline?, set })
    }

    fn need_text(&mut self, fields: &Fields<'_>, name: &str) -> Option<At<String>> {
        let node = self.reader.need(fields, name)?;
        self.text_at(node, "text")
    }

    fn vary(&mut self, node: &Node) -> Vec<Group> {
        match &node.form {
            Form::List(items) => items.iter().filter_map(|item| self.group(item)).collect(),
            _ => self.group(node).into_iter().collect(),
        }
    }

    fn group(&mut self, node: &Node) -> Option<Group> {
        let (name, map) = match &node.form {
            Form::Tuple(Some(name), items) if items.len() == 1 => (name, &items[0]),
            _ => {
                self.reader.wrong(node, VARY);
                return None;
            }
        };
        if !["Grid", "Paired"].contains(&name.text.as_str()) {
            self.reader.wrong(node, VARY);
            return None;
        }
        let entries = self.entries(map, "axes: { \"name\": [values] }");
        if entries.is_empty() && map.form == Form::Map(Vec::new()) {
            let span = self.reader.span_of(map);
            self.error(&codes::EMPTY, span, format!("`{}` has no axes", name.text));
        }
        let axes: Vec<Vary> = entries.into_iter().filter_map(|(path, node)| self.axis(path, node)).collect();
        if name.text == "Grid" {
            return Some(Group::Grid(axes));
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
            self.reader.tell(error);
        }
        Some(Group::Paired(axes))
    }

    fn axis(&mut self, path: At<String>, node: &Node) -> Option<Vary> {
        let (node, is_optional) = optional(node);
        let is_size = path.value == SIZE;
        let expected =
            if is_size { "sizes: [(width, height), …]" } else { "a list of values: [value, …]" };
        let mut values: Vec<At<AxisValue>> = Vec::new();
        for item in self.items(node, expected) {
            let value = if is_size {
                self.size(item).map(|size| At { value: size_value(size), span: self.reader.span_of(item) })
            } else {
                self.value(item)
            };
            values.extend(value);
        }
        if path.value == SEED {
            let error = Diagnostic::new(&codes::PATH, "the seed is no axis")
                .label(path.span.clone(), "")
                .note("write `seeds: 5` or `seeds: [1, 2, 3]`");
            self.reader.tell(error);
            return None;
        }
        Some(Vary { path, values, optional: is_optional })
    }

    fn budget(&mut self, node: &Node) -> Option<Budget> {
        let expected = "`Frames(8)`, `Time(ms: 20.0, by: \"lights\")`, `Time(ms: 500.0)` or `Lights(1024)`";
        if let Form::Tuple(Some(name), items) = &node.form
            && let [item] = &items[..]
        {
            match name.text.as_str() {
                "Frames" => return self.whole(item, 1, MOST_FRAMES).map(Budget::Frames),
                "Lights" => {
                    let span = self.reader.span_of(item);
                    let count = At { value: self.whole(item, 1, u32::MAX)?, span: span.clone() };
                    let by = At { value: "lights".to_owned(), span };
                    return Some(Budget::Lights { count, by, frames: FRAMES });
                }
                _ => {}
            }
        }
        let forms: [(&'static str, &'static [&'static str]); 3] = [
            ("Frames", &["count"]),
            ("Time", &["ms", "by", "frames"]),
            ("Lights", &["count", "by", "frames"]),
        ];
        let fields = self.reader.fields(node, expected, &forms)?;
        let frames = |g: &mut Self, default| {
            fields.get("frames").map_or(Some(default), |node| g.whole(node, 1, MOST_FRAMES))
        };
        let by = fields.get("by").map(|node| self.text_at(node, "the name of a parameter"));
        match fields.form() {
            "Time" => {
                let ms = self.reader.need(&fields, "ms").and_then(|node| self.positive(node));
                let by = by.map_or(Some(None), |by| by.map(Some))?;
                let frames = frames(self, if by.is_some() { FRAMES } else { MOST_FRAMES });
                Some(Budget::Time { ms: ms?, by, frames: frames? })
            }
            form => {
                let node = self.reader.need(&fields, "count")?;
                let span = self.reader.span_of(node);
                if form == "Frames" {
                    return self.whole(node, 1, MOST_FRAMES).map(Budget::Frames);
                }
                let count = self.whole(node, 1, u32::MAX).map(|value| At { value, span: span.clone() });
                let by = by.unwrap_or_else(|| Some(At { value: "lights".to_owned(), span }));
                let frames = frames(self, FRAMES);
                Some(Budget::Lights { count: count?, by: by?, frames: frames? })
            }
        }
    }

    /// Reads seeds: `5` stands for 1 to 5. Seed 0 is left out, since it gives the sequences without
    /// randomisation.
    fn seeds(&mut self, node: &Node) -> Option<Vec<u32>> {
        if let Form::List(_) = node.form {
            let items = self.items(node, "seeds: [1, 2, 3]");
            let mut seeds: Vec<u32> = Vec::new();
            for (index, item) in items.iter().enumerate() {
                let Form::Number(Number::Integer(n)) = item.form else {
                    self.reader.wrong(item, "a seed: a whole number");
                    continue;
                };
                let Ok(seed) = u32::try_from(n) else {
                    let span = self.reader.span_of(item);
                    self.error(
                        &codes::RANGE,
                        span,
                        format!("a seed is from 0 to {}, and {n} is not", u32::MAX),
                    );
                    continue;
                };
                match seeds.iter().position(|other| *other == seed) {
                    Some(first) if first < index => {
                        let (again, first) = (self.reader.span_of(item), self.reader.span_of(&items[first]));
                        self.reader.tell(twice(&format!("seed {seed}"), &again, &first));
                    }
                    _ => seeds.push(seed),
                }
            }
            return Some(seeds);
        }
        self.whole(node, 1, 100_000).map(|count| (1..=count).collect())
    }

    fn reference(&mut self, node: &Node) -> Option<Reference> {
        let expected = "`Pipeline(pipeline: \"reference\", set: {…})`, `Picture(\"file.exr\")`, `Pictures({ \"scene\": \"file.exr\" })` or `None`";
        match &node.form {
            Form::Word(word) if word == "None" => return Some(Reference::None),
            Form::Tuple(Some(name), items) if name.text == "Picture" && items.len() == 1 => {
                let file = self.text_at(&items[0], "the name of a picture file")?;
                return Some(Reference::Pictures(vec![(None, file)]));
            }
            Form::Tuple(Some(name), items) if name.text == "Pictures" && items.len() == 1 => {
                let entries = self.entries(&items[0], "pictures: { \"scene\": \"file.exr\" }");
                let files = entries.into_iter().filter_map(|(scene, node)| {
                    Some((Some(scene), self.text_at(node, "the name of a picture file")?))
                });
                return Some(Reference::Pictures(files.collect()));
            }
            _ => {}
        }
        let known = ["pipeline", "set", "follow", "frames"].as_slice();
        let fields = self.reader.fields(node, expected, &[("Pipeline", known)])?;
        let pipeline = self.need_text(&fields, "pipeline");
        let set = fields.get("set").map(|node| self.set(node)).unwrap_or_default();
        let follow = fields.get("follow").map(|node| self.names(node, "an axis")).unwrap_or_default();
        let frames = fields.get("frames").map_or(Some(MOST_FRAMES), |node| self.whole(node, 1, MOST_FRAMES));
        let span = self.reader.head_of(node);
        Some(Reference::Pipeline { pipeline: pipeline?, set, follow, frames: frames?, span })
    }
}

/// Returns the content of `Optional(x)`, and whether the node had that form.
fn optional(node: &Node) -> (&Node, bool) {
    match &node.form {
        Form::Tuple(Some(name), items) if name.text == "Optional" && items.len() == 1 => (&items[0], true),
        _ => (node, false),
    }
}

pub(super) fn twice(what: &str, again: &Span, first: &Span) -> Diagnostic {
    Diagnostic::new(&codes::TWICE, format!("{what} is given twice"))
        .label(again.clone(), "again here")
        .label(first.clone(), "first here")
}
