//! From what a file says to a description: the checks of its names, links, values and expressions.

use super::Description;
use super::form::{
    At, Body, Dim, Entry, Formula, HistoryPolicy, InputDecl, Link, Off, OutDecl, OutputDecl, ParameterDecl,
    PassDecl, Patch, SaidFact, Set, SetValue, Size, Sub, Target, TextPlace, is_name,
};
use super::grammar::{
    AllCauses, Between, COUNT, Count, DimFile, FormatName, HistoryFile, InterfaceName, LinkText, Links,
    OffFile, OffInput, OutFile, ParameterFile, PassFile, Passes, PatchFile, PipelineFile, PipelinePath,
    ResetFile, SIDE, SIZE, Side, SizeFile, Switch, Text, VALUE, ValueFile, Values,
};
use crate::codes;
use crate::expression::{self, Expr, ExprError, ExprKind, parse_scale};
use crate::frame::ResetCause;
use crate::port::OutputOverride;
use crate::resource::Format;
use data_file::grammar::{Entries, Number, Reader, Spanned, read, read_broken};
use data_file::{Diagnostics, Name, Place, Source, Value, ValueType};
use std::collections::BTreeMap;
use std::sync::Arc;

/// How a link that reads the frame before begins.
const PREV: &str = "prev ";

/// Reads a file whose places carry the index `file`.
pub(crate) fn parse_file(source: Arc<Source>, file: u32) -> Result<Description, Diagnostics> {
    read(&source, file, |reader, file| Checks { reader }.pipeline(file))
}

/// Reads what can be read of a file.
pub(super) fn parse_broken(source: &Arc<Source>) -> Option<Description> {
    read_broken(source, |reader, file| Checks { reader }.pipeline(file))
}

/// The checks of the values of a file. What is wrong is reported, and a stand-in takes its place until the file is
/// refused.
struct Checks<'a, 'b> {
    reader: &'a mut Reader<'b>,
}

impl Checks<'_, '_> {
    fn pipeline(mut self, Spanned { value: file, place }: Spanned<PipelineFile>) -> Description {
        if let (None, Some(patch)) = (&file.extends, &file.patch) {
            let error = self.reader.at(
                &codes::MISSING_FIELD,
                self.reader.head(patch.place),
                "`patch` needs a file to patch",
            );
            self.reader.report(error.note("add `extends: \"…\"`, or write the passes out"));
        }
        if file.extends.is_none() && file.passes.is_none() {
            self.missing("Pipeline", "passes", place);
        }
        let parameters = file.parameters.into_iter();
        Description {
            source: Arc::clone(self.reader.source),
            about: file.about,
            paper: file.paper,
            extends: file.extends,
            parameters: parameters.map(|(name, parameter)| self.parameter(name, parameter)).collect(),
            inputs: self.inputs(file.inputs),
            passes: self.passes(file.passes.unwrap_or_default()),
            outputs: self.outputs(file.outputs),
            patch: file
                .patch
                .map_or(Vec::new(), |patch| patch.value.into_iter().map(|patch| self.patch(patch)).collect()),
        }
    }

    fn missing(&mut self, form: &str, field: &str, place: Place) {
        let message = format!("`{form}` needs a field `{field}`");
        self.reader.error(&codes::MISSING_FIELD, self.reader.head(place), message);
    }

    /// Checks a name.
    fn name(&mut self, text: Text, what: &str) -> At<Name> {
        if !is_name(&text) {
            self.bad_name(&text, what);
        }
        text.with(Name::from(text.as_str()))
    }

    /// Checks the name of a pass, which may have several parts joined by `/`.
    fn pass_name(&mut self, text: Text) -> At<Name> {
        if !text.split('/').all(is_name) {
            self.bad_name(&text, "a pass");
        } else if matches!(text.rsplit('/').next(), Some("in" | "out")) {
            let message = format!("`{}` is kept for the inputs and outputs of a file", *text);
            self.reader.error(&codes::BAD_NAME, text.place, message);
        }
        text.with(Name::from(text.as_str()))
    }

    fn bad_name(&mut self, text: &Text, what: &str) {
        let message = format!("{:?} cannot be the name of {what}", text.value);
        let error = self.reader.at(&codes::BAD_NAME, text.place, message);
        self.reader.report(error.note("names are made of letters, digits, `-` and `_`"));
    }

    fn parameter(
        &mut self,
        name: Text,
        Spanned { value: file, place }: Spanned<ParameterFile>,
    ) -> ParameterDecl {
        let name = self.name(name, "a parameter");
        let (ty, fields) = match file {
            ParameterFile::U32(fields) => (ValueType::U32, fields),
            ParameterFile::F32(fields) => (ValueType::F32, fields),
            ParameterFile::Bool(fields) => (ValueType::Bool, fields),
            ParameterFile::Text(fields) => (ValueType::Text, fields),
        };
        let mut value = |value: Spanned<ValueFile>| {
            let place = value.place;
            let SetValue::Value(value) = self.value(value) else {
                self.reader.wrong(place, &format!("a value of type {ty}"));
                return At { value: Value::Bool(false), place };
            };
            let converted = value.clone().convert(ty).unwrap_or_else(|| {
                let message = format!("`{}` is {}, and {value} is not", *name, ty.with_article());
                self.reader.error(&codes::PARAMETER, place, message);
                value
            });
            At { value: converted, place }
        };
        let default = fields.default.map(&mut value);
        let one_of = fields.one_of.map(|values| values.into_iter().map(|item| value(item).value).collect());
        let mut bound = |number: Spanned<Number>| {
            if !number.as_f64().is_finite() {
                self.reader.wrong(number.place, "a finite number");
            }
            number.as_f64()
        };
        let (min, max) = (fields.min.map(&mut bound), fields.max.map(&mut bound));
        let place = self.reader.head(place);
        ParameterDecl { name, ty, default, min, max, one_of, unit: fields.unit, doc: fields.doc, place }
    }

    fn inputs(&mut self, inputs: Entries<InterfaceName>) -> Vec<InputDecl> {
        let input = |(name, InterfaceName(interface)): (Text, _)| InputDecl {
            name: self.name(name, "an input"),
            interface: named(interface),
        };
        inputs.into_iter().map(input).collect()
    }

    fn outputs(&mut self, outputs: Links) -> Vec<OutputDecl> {
        let output = |(name, LinkText(text)): (Text, _)| {
            let name = self.name(name, "an output");
            let target = self.target(&text, &text);
            OutputDecl { link: Link::new(name.clone(), target, self.content_end(&text)), name }
        };
        outputs.into_iter().map(output).collect()
    }

    fn passes(&mut self, passes: Passes) -> Vec<Entry> {
        let pass = |(name, pass)| Entry { name: self.pass_name(name), decl: self.pass(pass) };
        passes.into_iter().map(pass).collect()
    }

    fn pass(&mut self, Spanned { value: file, place }: Spanned<PassFile>) -> Arc<PassDecl> {
        Arc::new(match file {
            PassFile::Pass { kind, shader, r#in, set, out, history, when, off } => {
                let body = Body::Pass { kind: named(kind.0), shader: shader.map(|shader| named(shader.0)) };
                let outs: Vec<OutDecl> =
                    out.into_iter().map(|(port, out)| self.output_override(port, out)).collect();
                let history = history.map(|history| self.history(history));
                let overrides = out_overrides(&outs);
                PassDecl { outs, overrides, history, ..self.linked(body, r#in, set, when, off) }
            }
            PassFile::Sub { file: None, inputs, r#in, set, passes: Some(passes), outputs, when, off } => {
                let sub = Sub::Inline {
                    inputs: self.inputs(inputs.map(|inputs| inputs.value).unwrap_or_default()),
                    passes: self.passes(passes.value),
                    outputs: self.outputs(outputs.map(|outputs| outputs.value).unwrap_or_default()),
                };
                self.linked(Body::Sub(sub), r#in, set, when, off)
            }
            PassFile::Sub { file, inputs, r#in, set, passes, outputs, when, off } => {
                let of_file = [
                    ("inputs", inputs.map(|inputs| inputs.place)),
                    ("passes", passes.map(|passes| passes.place)),
                    ("outputs", outputs.map(|outputs| outputs.place)),
                ];
                let file = match file {
                    Some(PipelinePath(file)) => {
                        for (name, place) in of_file {
                            let Some(place) = place else { continue };
                            let message = format!("`{name}` is that of the file that `file` names");
                            self.reader.error(&codes::UNKNOWN_FIELD, self.reader.head(place), message);
                        }
                        file
                    }
                    None => {
                        self.missing("Sub", "file", place);
                        Spanned { value: String::new(), place }
                    }
                };
                self.linked(Body::Sub(Sub::File(file)), r#in, set, when, off)
            }
        })
    }

    /// Returns a pass or a sub-graph with what both may have.
    fn linked(
        &mut self,
        body: Body,
        links: Links,
        values: Values,
        when: Option<Switch>,
        off: Option<Spanned<OffFile>>,
    ) -> PassDecl {
        let links: Vec<Link> = links.into_iter().map(|(port, text)| self.link(port, text)).collect();
        let set = |(name, value): (Text, Spanned<ValueFile>)| Set {
            name: self.name(name, "a setting"),
            place: value.place,
            value: self.value(value),
            patched: false,
            foreign: false,
            instead_of: None,
        };
        PassDecl {
            link_names: links.iter().map(|link| link.port.value.to_string()).collect(),
            links,
            set: values.into_iter().map(set).collect(),
            when: when.map(|Switch(text)| self.expression(&text, expression::parse(&text))),
            off: off.map(|off| self.off(off)),
            ..PassDecl::new(body)
        }
    }

    fn link(&mut self, port: Text, LinkText(text): LinkText) -> Link {
        let port = self.name(port, "an input");
        let past = text.strip_prefix(PREV);
        let target = self.target(&text, past.unwrap_or(&text));
        Link { past: past.is_some(), ..Link::new(port, target, self.content_end(&text)) }
    }

    /// Returns the place where the text of a link ends, if it can be pointed into.
    fn content_end(&self, text: &Text) -> Option<u32> {
        Some(self.reader.content(text)? + text.len() as u32)
    }

    /// Returns the target that a text, or the end of it, names.
    fn target(&mut self, text: &Text, named: &str) -> At<Target> {
        let target = Target::parse(named).unwrap_or_else(|| {
            let message = format!("{named:?} cannot be read as a link");
            let error = self.reader.at(&codes::BAD_NAME, text.place, message);
            self.reader.report(error.note("a link is \"pass\", \"pass.port\" or \"pass.port.member\""));
            Target { pass: Name::default(), port: None, member: None }
        });
        text.with(target)
    }

    fn history(&mut self, Spanned { value: file, place }: Spanned<HistoryFile>) -> At<Arc<HistoryPolicy>> {
        let reset = match file.reset {
            None => ResetCause::DEFAULT.to_vec(),
            Some(ResetFile::Word(AllCauses::All)) => ResetCause::NAMED.to_vec(),
            Some(ResetFile::List(mut causes)) => {
                causes.sort_unstable();
                causes.dedup();
                causes
            }
        };
        let rest = file.rest.map(|frames| {
            positive(*frames).unwrap_or_else(|| {
                self.reader.wrong(frames.place, "a number of frames, at least 1");
                1
            })
        });
        let catches_up = file.catches_up.unwrap_or(false);
        At { value: Arc::new(HistoryPolicy { reset, rest, catches_up }), place }
    }

    fn off(&mut self, Spanned { value: file, place }: Spanned<OffFile>) -> At<Off> {
        match file {
            OffFile::Form(OffInput::Input(port)) => {
                let port = self.name(port, "an input");
                At { value: Off::Input(port.value), place: port.place }
            }
            OffFile::Text(text) => {
                let target = self.target(&text, &text);
                let port = At { value: Name::default(), place: text.place };
                let link = Link::new(port, target, self.content_end(&text));
                At { value: Off::Link(link), place: self.reader.head(place) }
            }
        }
    }

    fn output_override(&mut self, port: Text, file: OutFile) -> OutDecl {
        let format = file.format.and_then(|FormatName(name)| {
            let format = Format::from_name(&name);
            if format.is_none() {
                let message = format!("there is no format {:?}", name.value);
                let error = self.reader.at(&codes::WRONG_TYPE, name.place, message);
                self.reader.report(error.suggest("formats", &name, Format::ALL.iter().map(|f| f.name())));
            }
            Some(At { value: format?, place: name.place })
        });
        let fact = |(name, fact): (Text, Spanned<Option<ValueFile>>)| {
            let place = fact.place;
            let value = fact.value.map(|value| self.value(Spanned { value, place }));
            SaidFact { name: self.name(name, "a fact"), value, place }
        };
        OutDecl {
            facts: file.facts.into_iter().map(fact).collect(),
            port: self.name(port, "an output"),
            interface: file.interface.map(|InterfaceName(name)| named(name)),
            format,
            size: file.size.map(|size| self.size(size)),
            count: file.count.map(|Spanned { value: Count(count), place }| At {
                value: self.dim(Spanned { value: count, place }, COUNT),
                place,
            }),
        }
    }

    fn patch(&mut self, file: PatchFile) -> Patch {
        match file {
            PatchFile::Replace(name, pass) => {
                Patch::Replace { name: self.pass_name(name), decl: self.pass(pass) }
            }
            PatchFile::Insert { name, pass, between: Between([from, to]) } => Patch::Insert {
                name: self.pass_name(name),
                decl: self.pass(pass),
                from: self.target(&from, &from),
                to: self.target(&to, &to),
            },
            PatchFile::Set(path, value) => {
                Patch::Set { path: named(path), place: value.place, value: self.value(value) }
            }
            PatchFile::Remove(name) => Patch::Remove { name: self.pass_name(name) },
        }
    }

    /// Returns an expression that was read from a text; reports the error that it gave.
    fn expression(&mut self, text: &Text, parsed: Result<Expr, ExprError>) -> Formula {
        let text = TextPlace { place: text.place, content: self.reader.content(text) };
        let expr = parsed.unwrap_or_else(|error| {
            let place = text.within(error.start, error.end);
            let mut diagnostic = self.reader.at(error.code, place, error.message);
            diagnostic.notes = error.notes;
            self.reader.report(diagnostic);
            Expr { start: 0, end: 0, kind: ExprKind::Value(Value::U32(1)) }
        });
        Formula { expr, text }
    }

    /// Returns an expression that may ask about parameters alone.
    fn formula(&mut self, text: &Text, parsed: Result<Expr, ExprError>) -> Box<Formula> {
        let parsed = parsed.and_then(|expr| match expr.question() {
            None => Ok(expr),
            Some(question) => Err(ExprError {
                code: &codes::EXPRESSION_NAME,
                start: question.start,
                end: question.end,
                message: "only `when:` can ask about the scene and about inputs".into(),
                notes: vec!["a value is computed from numbers and parameters".into()],
            }),
        });
        Box::new(self.expression(text, parsed))
    }

    /// Returns a value of a setting, or an expression that gives one.
    fn value(&mut self, Spanned { value: file, place }: Spanned<ValueFile>) -> SetValue {
        SetValue::Value(match file {
            ValueFile::Bool(b) => Value::Bool(b),
            ValueFile::Number(Number::Integer(n)) => match (u32::try_from(n), i32::try_from(n)) {
                (Ok(n), _) => Value::U32(n),
                (_, Ok(n)) => Value::I32(n),
                _ => Value::F32(n as f32),
            },
            ValueFile::Number(Number::Float(x)) => {
                if !(x as f32).is_finite() {
                    self.reader.wrong(place, "a finite number");
                }
                Value::F32(x as f32)
            }
            ValueFile::Text(text) => return self.text_value(Spanned { value: text, place }),
            ValueFile::Tuple(items) | ValueFile::List(items) => {
                let numbers: Vec<f32> = items.iter().map(|number| number.as_f64() as f32).collect();
                if !(2..=4).contains(&numbers.len()) || !numbers.iter().all(|x| x.is_finite()) {
                    self.reader.wrong(place, VALUE);
                }
                Value::Vector(numbers)
            }
        })
    }

    fn text_value(&mut self, text: Text) -> SetValue {
        if let Some(text) = plain(&text) {
            return SetValue::Value(Value::Text(text));
        }
        if let Some(name) = text.strip_prefix('$').filter(|name| is_name(name)) {
            return SetValue::Parameter(Name::from(name), None);
        }
        let parsed = expression::parse(&text).map_err(|mut error| {
            error
                .notes
                .push("text with a `$` in it is an expression: in plain text, it is written `$$`".into());
            error
        });
        SetValue::Formula(self.formula(&text, parsed), None)
    }

    fn dim(&mut self, Spanned { value: file, place }: Spanned<DimFile>, expected: &str) -> Dim {
        let number = match file {
            DimFile::Text(value) if value.contains('$') => {
                let text = Spanned { value, place };
                return Dim::Formula(self.formula(&text, expression::parse(&text)));
            }
            DimFile::Number(number) => positive(number),
            DimFile::Text(_) => None,
        };
        Dim::Number(number.unwrap_or_else(|| {
            self.reader.wrong(place, expected);
            1
        }))
    }

    fn size(&mut self, Spanned { value: file, place }: Spanned<SizeFile>) -> At<Size> {
        let text = match file {
            SizeFile::Text(value) => Spanned { value, place },
            SizeFile::Tuple(sides) => {
                let [width, height] = sides.map(|Spanned { value: Side(side), place }| {
                    self.dim(Spanned { value: side, place }, SIDE)
                });
                return At { value: Size::Fixed(width, height), place };
            }
        };
        let Some((input, rest)) = base(&text) else {
            self.reader.wrong(place, SIZE);
            return At { value: Size::Frame(Dim::Number(1), Dim::Number(1)), place };
        };
        let (factor, divisor) = match parse_scale(&text, rest) {
            Ok((factor, divisor)) => (factor.map(Ok), divisor.map(Ok)),
            Err(error) => (Some(Err(error)), None),
        };
        let mut dim = |part: Option<Result<Expr, ExprError>>| match part {
            None => Dim::Number(1),
            Some(Ok(Expr { kind: ExprKind::Value(Value::U32(n @ 1..)), .. })) => Dim::Number(n),
            Some(parsed) => Dim::Formula(self.formula(&text, parsed)),
        };
        let (num, den) = (dim(factor), dim(divisor));
        let value = match input {
            None => Size::Frame(num, den),
            Some(input) => Size::Like(input, num, den),
        };
        At { value, place }
    }
}

/// Returns a text as a name that linking will look up.
fn named(text: Text) -> At<Name> {
    text.with(Name::from(text.as_str()))
}

/// Returns the text that is meant where it is no expression: `$$` stands for `$`. Text that begins with `$$` is never
/// one.
fn plain(text: &str) -> Option<String> {
    if !text.contains('$') {
        return Some(text.to_owned());
    }
    let literal = text.starts_with("$$") || !text.replace("$$", "").contains('$');
    literal.then(|| text.replace("$$", "$"))
}

/// Returns the input of `like(input)`, or none for `frame`, at the beginning of a size, and where what follows begins.
fn base(text: &str) -> Option<(Option<Name>, usize)> {
    let start = text.trim_start();
    let at = |rest: &str| text.len() - rest.len();
    let Some(rest) = start.strip_prefix("like") else {
        return Some((None, at(start.strip_prefix("frame")?)));
    };
    let (input, rest) = rest.trim_start().strip_prefix('(')?.split_once(')')?;
    let input = input.trim().trim_matches(['\'', '"']);
    is_name(input).then(|| (Some(Name::from(input)), at(rest)))
}

/// Returns a number that is whole and above 0.
fn positive(number: Number) -> Option<u32> {
    let Number::Integer(n) = number else { return None };
    u32::try_from(n).ok().filter(|n| *n > 0)
}

/// Returns `out:` as a pass type is asked with it; sizes, counts and facts whose parameters are not put in are left out.
pub(crate) fn out_overrides(outs: &[OutDecl]) -> Arc<BTreeMap<String, OutputOverride>> {
    let fact = |said: &SaidFact| {
        let value = match &said.value {
            Some(value) => Some(value.get()?.clone()),
            None => None,
        };
        Some((said.name.value.to_string(), value))
    };
    let entry = |out: &OutDecl| OutputOverride {
        interface: out.interface.as_ref().map(|at| at.value.to_string()),
        format: out.format.map(|at| at.value),
        size: out.size.as_ref().and_then(|at| at.value.extent()),
        count: out.count.as_ref().and_then(|at| at.value.number()),
        facts: out.facts.iter().filter_map(fact).collect(),
    };
    Arc::new(outs.iter().map(|out| (out.port.value.to_string(), entry(out))).collect())
}
