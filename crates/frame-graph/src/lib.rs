//! The frame graph of Lightloom, from the text of a RON file to a plan that an executor can run.
//!
//! ```text
//! RON ─parse─▶ Description ─resolve─▶ Resolved ─link─▶ Graph ─compile─▶ Plan ─frame─▶ the passes to run
//! ```
//!
//! Each arrow is one function. Nothing here knows a GPU, a shader, a scene or any particular pass: what a
//! pass type offers comes through the [`PassTypes`] trait, and what the scene holds through [`Traits`].
//!
//! # The files
//!
//! A pipeline is a RON file. All names are made of letters, digits, `-` and `_`; names of passes may have
//! several parts, joined by `/`. `…?` is optional, `…*` any number of entries.
//!
//! ```text
//! Pipeline(
//!     about: "text"?,  paper: "ISM §3"?,
//!     extends: "base.ron"?,                            // this file is a variant of that one
//!     parameters: { "name": PARAMETER * }?,
//!     inputs: { "name": "Interface" or Optional("Interface") * }?,   // this file is a sub-graph
//!     passes: { "name": PASS or SUB * },
//!     outputs: { "name": "pass.port" * },
//!     patch: [ PATCH * ]?,                             // only with `extends`
//! )
//! ```
//!
//! Paths of files are relative to the pipelines' folder.
//!
//! | form | is |
//! |---|---|
//! | PARAMETER | `U32(default: 64, min: 1, max: 512, one_of: [32, 64], unit: "px", doc: "…")`, or `I32`, `F32`, `Bool`, `Text`; all fields may be left out: see below. A variant gives only what differs |
//! | PASS | `Pass(kind: "…", shader: "x.wgsl"?, in: { "port": LINK * }?, set: { "setting": VALUE * }?, out: { "port": OUT * }?, when: "EXPRESSION"?, off: OFF?)` |
//! | SUB | `Sub(file: "parts/x.ron", in: …?, set: { "parameter": VALUE * }?, repeat: COUNT?, carry: { "input": "output" * }?, index: "parameter"?, when: …?, off: …?)`: the passes of another file, named `sub-graph/pass` |
//! | COUNT | an integer or an expression that gives one: how many copies of the sub-graph there are, one after the other |
//! | LINK | `"pass"`, `"pass.port"`, `"pass.port.member"`, `"in.input"` within a sub-graph, or `Prev(port: "…", init: Zero?, reset: [Resize, Cut, Scene, Reload, Moved]?)` |
//! | VALUE | `true`, a number, text, `(x, y, z)`, or an expression: text in which a `$` stands, such as `"$parameter"` or `"$lights * 16"`. In plain text each `$` is written `$$`; text that begins with `$$` is never an expression |
//! | OUT | `Out(interface: "…"?, format: "rgba16float"?, size: SIZE?, count: 64?)`, for pass types that take their ports from a shader |
//! | SIZE | `"frame"`, `"frame / 4"`, `"like(input) * 3 / 2"` or `(width, height)`; any number may be an expression (`"frame / $tile"`, `"like(input) * ($n + 1)"`, `("$map * 2", 64)`), as may `count` |
//! | OFF | `Black`, `Color(r, g, b, a)`, `Input("port")`, or a link such as `"pass.port"` or `"in.input"`: what stands in place of the outputs when the switch is off |
//! | PATCH | `Replace("pass", PASS)`, `Insert(name: "x", pass: PASS, between: ("a.port", "b.port"))`, `Set("path", VALUE)`, `Remove("pass")` |
//!
//! **Links.** The name of a pass alone means its only output of the interface that the input takes, else its only
//! output. After the dot stands a port, or a member of the only port that has one of that name: `"view.depth"`. An
//! input of the interface `Texture` or `Buffer` takes any single resource of that sort. `Prev` reads what the port held
//! in the frame before, and may name any pass, also a later one or its own; `init` is what it holds where there is no
//! past, and `reset` names the events that end it (the first four, where it is left out). `Reload` is a change of a
//! setting, a shader or a link of the pass that writes the past, or of what feeds it; `Moved` is any change of what
//! that pass reads of camera, lights and scene.
//!
//! **Repeated sub-graphs.** With `repeat: "$n"` a sub-graph stands in the pipeline as copies whose passes are named
//! `sub-graph/0/pass`, `sub-graph/1/pass`, and so on. The first copy takes what `in:` says; each further one takes, for
//! an input that `carry` names, the output of the copy before it, and for all others what `in:` says. The outputs of
//! the sub-graph are those of the last copy, and so is the past that `Prev` reads of them. Repeated 0 times, the
//! sub-graph hands through what comes in for an output that is carried; to read another one is an error. `when:` and
//! `off:` are of the whole. Values given to `sub-graph.parameter` and `sub-graph/pass.setting` reach all copies, those
//! given to `sub-graph/2.parameter` and `sub-graph/2/pass.setting` one of them, in the order in which they are given.
//! Errors are reported once for all copies.
//!
//! **Patches.** They are applied in order, after the entries of the file itself. `Replace` keeps the links of the
//! old pass whose ports the new kind has, its `when` and its `off`, unless they are given again. `Insert` puts a pass
//! or a sub-graph into a link; the link goes to its only required input that takes it, of a sub-graph to the only one that
//! `in:` leaves unlinked; `"out.NAME"` stands for an output of the
//! pipeline. `Remove` puts what `off:` says in place of a pass; without it, optional inputs that read it are left
//! unlinked. `Set` takes a path: `parameter`, `pass.setting`, `sub-graph.parameter`, `sub-graph/pass.setting`. Values
//! given from outside ([`Overrides`]) have the same paths and come last. Of what is inside a sub-graph, patches set
//! values and no more: to change its passes, a file extends that of the sub-graph, and `Replace` puts it in its place;
//! `repeat` and `carry` are given again then.
//!
//! **Parameters.** A parameter that is the whole value of a setting (`set: { "count": "$lights" }`), also through
//! sub-graphs, inherits what it does not say: `"lights": U32()` is the number that the setting is, with its default,
//! range, choices, unit and documentation. Its range ends where that of any such setting does, whatever it says itself.
//! A parameter needs a `default` where its value must be known before passes are asked (in expressions, sizes and
//! switches, and for `repeat`), and where its settings have several defaults.
//!
//! **Expressions.** Values, sizes and switches are written in one small language: parameters (`$lights` or `lights`),
//! truth values, numbers and `'text'`, with `+`, `-`, `*`, `/`, `%`, `min(a, b)`, `max(a, b)`, `!`, `&&`, `||`, `==`,
//! `!=`, `<`, `<=`, `>`, `>=` and parentheses. Integers stay integers: `/` between two of them rounds towards zero,
//! and a real number on either side makes the result real. To divide by zero is an error, as is a result that no
//! value can hold or that the setting does not take. Names may hold `-`, so a minus has blanks around it. The factor
//! and the divisor of a size are a number, a parameter, `min`, `max` or stand in parentheses; what a size is divided
//! by rounds its sides up.
//!
//! **Switches.** `when:` is an expression that may also ask about traits of the scene (`scene.glossy`) and
//! `connected(input)`. Its types are checked, and so is all else in a pass that is off. What reads a pass that
//! is off finds what `off:` says; without it, optional inputs are left unlinked and others are an error.
//! A link stands in place of every output of its interface. It may name any pass or sub-graph, also one that is off
//! itself: then what that one's `off:` says is taken. Passes that are off may not stand in place of each other
//! in a ring. The pass that `off:` names is needed only where the switch is off.
//!
//! **The flattened file.** [`Resolved::to_ron`] writes files without `extends`, `patch` and `Sub`. In them alone
//! stand `Group(inputs: …, in: …, outputs: …, when: …, off: …)` for the border of a sub-graph, whose inputs are
//! `"sub-graph/in.input"`; `Removed` in place of a pass; `keep: { … }` in a pass for links that are dropped where the
//! pass type has no such input; and `feed: "…"` for the link that an inserted pass takes.
//!
//! # Errors
//!
//! All errors of a file are reported at once, each with a code (see [`codes`]), the place, both ends of a link, and the
//! nearest name. Files that are broken, whatever their text, give errors and never a panic.

pub mod compile;
pub mod description;
mod expression;
pub mod frame;
pub mod interface;
pub mod link;
pub mod plan;
pub mod port;
pub mod resolve;
pub mod resource;
pub mod succession;
pub mod xml;

pub use data_file::{codes, diagnostic, reader, value};

pub use compile::{CompileOptions, compile};
pub use data_file::Name;
pub use description::{Description, parse};
pub use diagnostic::{Diagnostic, Diagnostics, Label, Source, Span, nearest};
pub use frame::{Change, FrameState, ResetCause};
pub use interface::{Content, Fact, FactDecl, FactValue, Interface, Member, Struct};
pub use link::{Graph, LinkContext, link};
pub use plan::{Plan, PlanId};
pub use port::{
    Facts, HandedOn, InputPort, Module, OutputContext, OutputDesc, OutputPort, PassTypeError, PassTypes,
    Ports, SceneBindings, Usage, Use,
};
pub use resolve::{Difference, Files, Overrides, Resolved, Settable, diff, resolve, resolve_description};
pub use resource::{BufferDesc, Clear, Extent, Format, ResourceDesc, TextureDesc, human_bytes};
pub use succession::Succession;
pub use value::{Misfit, Setting, Settings, Traits, Value, ValueType};
