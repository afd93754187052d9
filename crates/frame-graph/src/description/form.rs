//! The parts of a description. The same types hold the flattened one.

use crate::expression::{Expr, ExprError};
use crate::frame::ResetCause;
use crate::port::{OutputOverride, Use};
use crate::resource::{Extent, Format};
pub(crate) use data_file::grammar::Spanned as At;
use data_file::{Diagnostic, Name, Place, Sources, Value, ValueType};
use std::collections::BTreeMap;
use std::fmt;
use std::sync::Arc;

/// One entry of `parameters`. In a variant, what is left out is inherited.
#[derive(Clone, Debug)]
pub(crate) struct ParameterDecl {
    pub(crate) name: At<Name>,
    pub(crate) ty: ValueType,
    pub(crate) default: Option<At<Value>>,
    pub(crate) min: Option<f64>,
    pub(crate) max: Option<f64>,
    pub(crate) one_of: Option<Vec<Value>>,
    pub(crate) unit: Option<String>,
    pub(crate) doc: Option<String>,
    pub(crate) place: Place,
}

/// One entry of `inputs`.
#[derive(Clone, Debug)]
pub(crate) struct InputDecl {
    pub(crate) name: At<Name>,
    pub(crate) interface: At<Name>,
}

/// One entry of `outputs`.
#[derive(Clone, Debug)]
pub(crate) struct OutputDecl {
    pub(crate) name: At<Name>,
    pub(crate) link: Link,
}

/// One entry of `passes`.
#[derive(Clone, Debug)]
pub(crate) struct Entry {
    pub(crate) name: At<Name>,
    pub(crate) decl: Arc<PassDecl>,
}

/// `Pass(…)` or `Sub(…)`.
#[derive(Clone, Debug)]
pub(crate) struct PassDecl {
    pub(crate) body: Body,
    pub(crate) links: Vec<Link>,
    /// The ports of `links`, as a pass type is asked with them.
    pub(crate) link_names: Vec<String>,
    pub(crate) set: Vec<Set>,
    pub(crate) outs: Vec<OutDecl>,
    /// `outs`, as a pass type is asked with them; complete once parameters are put in.
    pub(crate) overrides: Arc<BTreeMap<String, OutputOverride>>,
    pub(crate) when: Option<Formula>,
    pub(crate) off: Option<At<Off>>,
    pub(crate) history: Option<At<Arc<HistoryPolicy>>>,
    /// The link that `Insert` broke, to be joined to the only required input that fits.
    pub(crate) feed: Option<Link>,
    /// Where `Remove` took it out.
    pub(crate) removed: Option<Place>,
}

#[derive(Clone, Debug)]
pub(crate) enum Body {
    Pass {
        kind: At<Name>,
        shader: Option<At<Name>>,
    },
    Sub(Sub),
    /// The border of a sub-graph whose passes have been moved up into the pipeline.
    Group(Group),
    /// What `Remove` leaves where there is no `off:`: readers find nothing.
    Removed,
}

/// The passes of a sub-graph: those of another file, or written out.
#[derive(Clone, Debug)]
pub(crate) enum Sub {
    File(At<String>),
    Inline { inputs: Vec<InputDecl>, passes: Vec<Entry>, outputs: Vec<OutputDecl> },
}

#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) inputs: Vec<InputDecl>,
    pub(crate) outputs: Vec<OutputDecl>,
}

/// One entry of `in`.
#[derive(Clone, Debug)]
pub(crate) struct Link {
    pub(crate) port: At<Name>,
    pub(crate) target: Target,
    /// Place of the target's text.
    pub(crate) place: Place,
    /// Where the target's text ends within its quotes, if it can be pointed into.
    pub(crate) content_end: Option<u32>,
    /// Whether it reads the frame before: `"prev …"`.
    pub(crate) past: bool,
    /// Kept by `Replace` from the pass before: dropped where the new kind has no such input.
    pub(crate) inherited: bool,
}

/// The text of a link: `pass`, `pass.port` or `pass.port.member`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(crate) struct Target {
    pub(crate) pass: Name,
    pub(crate) port: Option<Name>,
    pub(crate) member: Option<Name>,
}

/// `history:` of a pass: what becomes of the history buffers of its outputs.
#[derive(Clone, Debug, PartialEq)]
pub(crate) struct HistoryPolicy {
    pub(crate) reset: Vec<ResetCause>,
    /// After how many frames in which nothing else changes they rest.
    pub(crate) rest: Option<u32>,
    /// Whether they are the same after frames that left them out.
    pub(crate) catches_up: bool,
}

/// One entry of `set`.
#[derive(Clone, Debug)]
pub(crate) struct Set {
    pub(crate) name: At<Name>,
    pub(crate) value: SetValue,
    pub(crate) place: Place,
    /// Whether a patch or an override gave it.
    pub(crate) patched: bool,
    /// Whether a file around the sub-graph gave it: the parameter that it names is of that file.
    pub(crate) foreign: bool,
    /// The parameter that the file gives the setting, where something else was given from outside.
    pub(crate) instead_of: Option<Name>,
}

#[derive(Clone, Debug)]
pub(crate) enum SetValue {
    Value(Value),
    /// `"$name"`, with its value and where that was given, once they are known.
    Parameter(Name, Option<(Value, Place)>),
    /// `"$name * 16"`, with its value once that is known.
    Formula(Box<Formula>, Option<Value>),
}

/// `Out(…)`: what a use says of an output of a pass type that takes its ports from a shader.
#[derive(Clone, Debug)]
pub(crate) struct OutDecl {
    pub(crate) port: At<Name>,
    pub(crate) interface: Option<At<Name>>,
    pub(crate) format: Option<At<Format>>,
    pub(crate) size: Option<At<Size>>,
    pub(crate) count: Option<At<Dim>>,
    pub(crate) facts: Vec<SaidFact>,
}

/// One entry of `facts` in an `Out(…)`.
#[derive(Clone, Debug)]
pub(crate) struct SaidFact {
    pub(crate) name: At<Name>,
    /// `None` where the output is not to have it.
    pub(crate) value: Option<SetValue>,
    pub(crate) place: Place,
}

/// An integer above zero, once parameters are put in.
#[derive(Clone, Debug)]
pub(crate) enum Dim {
    Number(u32),
    Formula(Box<Formula>),
}

/// An [`Extent`] before parameters are put in.
#[derive(Clone, Debug)]
pub(crate) enum Size {
    Frame(Dim, Dim),
    Like(Name, Dim, Dim),
    Fixed(Dim, Dim),
}

/// An expression, and where it is written.
#[derive(Clone, Debug)]
pub(crate) struct Formula {
    pub(crate) expr: Expr,
    pub(crate) text: TextPlace,
}

/// The place of a text, and where it starts within its quotes if it can be pointed into.
#[derive(Clone, Copy, Debug)]
pub(crate) struct TextPlace {
    pub(crate) place: Place,
    pub(crate) content: Option<u32>,
}

/// What stands in place of the outputs of a pass or sub-graph that is off.
#[derive(Clone, Debug)]
pub(crate) enum Off {
    /// What is linked to an input of its own.
    Input(Name),
    /// What another link brings.
    Link(Link),
}

/// One entry of `patch`.
#[derive(Clone, Debug)]
pub(crate) enum Patch {
    Replace { name: At<Name>, decl: Arc<PassDecl> },
    Insert { name: At<Name>, decl: Arc<PassDecl>, from: At<Target>, to: At<Target> },
    Set { path: At<Name>, value: SetValue, place: Place },
    Remove { name: At<Name> },
}

impl Target {
    /// Reads the text of a link; `None` where it has too many parts or a part is no name.
    pub(crate) fn parse(text: &str) -> Option<Target> {
        let mut parts = text.split('.');
        let pass = parts.next()?;
        let mut part = || parts.next().map(|p| is_name(p).then(|| Name::from(p)));
        let (port, member) = (part(), part());
        let whole = parts.next().is_none();
        // A part that is there must be a name.
        let port = port.map_or(Some(None), |p| p.map(Some))?;
        let member = member.map_or(Some(None), |p| p.map(Some))?;
        (whole && pass.split('/').all(is_name)).then(|| Target { pass: Name::from(pass), port, member })
    }
}

impl fmt::Display for Target {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.pass)?;
        for part in [&self.port, &self.member].into_iter().flatten() {
            write!(f, ".{part}")?;
        }
        Ok(())
    }
}

/// Returns whether it can name a pass, a port, a parameter or a setting.
pub(crate) fn is_name(text: &str) -> bool {
    !text.is_empty() && text.chars().all(|c| c.is_alphanumeric() || c == '_' || c == '-')
}

impl Link {
    pub(crate) fn new(port: At<Name>, target: At<Target>, content_end: Option<u32>) -> Link {
        Link { port, target: target.value, place: target.place, content_end, past: false, inherited: false }
    }

    /// Place of the port's name, and of the member's, within the link's text, where it has one.
    pub(crate) fn port_place(&self) -> Place {
        let (Some(port), Some(end)) = (&self.target.port, self.content_end) else { return self.place };
        let member = self.target.member.as_ref().map_or(0, |m| m.len() + 1);
        Place { file: self.place.file, start: end - (port.len() + member) as u32, end }
    }
}

impl SetValue {
    /// Returns the value; parameters must have been put in.
    pub(crate) fn get(&self) -> Option<&Value> {
        match self {
            SetValue::Value(value) | SetValue::Parameter(_, Some((value, _))) => Some(value),
            SetValue::Formula(_, value) => value.as_ref(),
            SetValue::Parameter(_, None) => None,
        }
    }

    /// How the value came to be, where it does not stand there itself.
    pub(crate) fn explained(&self) -> Option<String> {
        match self {
            SetValue::Value(_) => None,
            SetValue::Parameter(name, _) => Some(format!("the value of `{name}`")),
            SetValue::Formula(formula, _) => Some(format!("the value of {}", formula.expr.explained(&()))),
        }
    }

    /// Returns the parameters that went into it, and where their values were given.
    pub(crate) fn origins(&self) -> Vec<(Name, Value, Place)> {
        let mut origins = Vec::new();
        match self {
            SetValue::Value(_) | SetValue::Parameter(_, None) => {}
            SetValue::Parameter(name, Some((value, place))) => {
                origins.push((name.clone(), value.clone(), *place));
            }
            SetValue::Formula(formula, _) => formula.expr.origins(&mut origins),
        }
        origins
    }
}

impl TextPlace {
    /// Returns the place of bytes `start..end` of the text; the whole where it holds escapes.
    pub(crate) fn within(&self, start: u32, end: u32) -> Place {
        match self.content {
            Some(content) => Place { file: self.place.file, start: content + start, end: content + end },
            None => self.place,
        }
    }
}

impl Formula {
    /// What is wrong with a part of it.
    pub(crate) fn error(&self, error: ExprError, sources: &Sources) -> Diagnostic {
        let place = self.text.within(error.start, error.end);
        let notes = error.notes;
        Diagnostic { notes, ..Diagnostic::new(error.code, error.message).label(sources.span(place), "") }
    }
}

impl PassDecl {
    /// Returns a pass or a sub-graph that has nothing else.
    pub(crate) fn new(body: Body) -> PassDecl {
        PassDecl {
            body,
            links: Vec::new(),
            link_names: Vec::new(),
            set: Vec::new(),
            outs: Vec::new(),
            overrides: Arc::default(),
            when: None,
            off: None,
            history: None,
            feed: None,
            removed: None,
        }
    }

    pub(crate) fn push_link(&mut self, link: Link) {
        self.link_names.push(link.port.value.to_string());
        self.links.push(link);
    }

    /// How its pass type is asked about it, with these inputs; `None` for what is no pass.
    pub(crate) fn use_of<'u>(&'u self, inputs: &'u [String]) -> Option<Use<'u>> {
        let Body::Pass { kind, shader } = &self.body else { return None };
        let shader = shader.as_ref().map(|shader| shader.value.as_str());
        Some(Use { kind: &kind.value, shader, inputs, outputs: &self.overrides })
    }

    pub(crate) fn link(&self, port: &str) -> Option<&Link> {
        self.links.iter().find(|link| link.port.value == port)
    }
}

impl Size {
    /// Calls `f` with every number of it.
    pub(crate) fn dims(&mut self, f: &mut impl FnMut(&mut Dim)) {
        let (Size::Frame(a, b) | Size::Like(_, a, b) | Size::Fixed(a, b)) = self;
        f(a);
        f(b);
    }

    /// Returns the extent; `None` where parameters are not put in.
    pub(crate) fn extent(&self) -> Option<Extent> {
        Some(match self {
            Size::Frame(num, den) => Extent::Frame { num: num.number()?, den: den.number()? },
            Size::Like(input, num, den) => {
                Extent::Like { input: input.to_string(), num: num.number()?, den: den.number()? }
            }
            Size::Fixed(w, h) => Extent::Fixed(w.number()?, h.number()?),
        })
    }
}

impl Dim {
    /// Returns the number; `None` where parameters are not put in.
    pub(crate) fn number(&self) -> Option<u32> {
        if let Dim::Number(n) = self { Some(*n) } else { None }
    }
}
