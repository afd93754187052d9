//! The frame graph of Lightloom, from the text of a RON file to a plan that an executor can run.
//!
//! ```text
//! RON ─parse─▶ Description ─resolve─▶ Resolved ─link─▶ Graph ─compile─▶ Plan ─frame─▶ the passes to run
//! ```
//!
//! Each arrow is one function. Nothing here depends on a GPU, a shader, a scene or any particular pass: the
//! trait [`PassTypes`] describes what the pass types offer, and [`Traits`] describe what the scene holds.
//!
//! # The files
//!
//! A pipeline is a RON file. Names consist of letters, digits, `-` and `_`; names of passes may have several
//! components, joined by `/`. In the grammar, `…?` is optional, and `…*` is any number of entries.
//!
//! ```text
//! Pipeline(
//!     about: "text"?,  paper: "ISM §3"?,
//!     extends: "base.ron"?,                            // this file is a variant of another one
//!     parameters: { "name": PARAMETER * }?,
//!     inputs: { "name": "Interface" * }?,              // this file is a sub-graph
//!     passes: { "name": PASS or SUB * },
//!     outputs: { "name": "pass.port" * },
//!     patch: [ PATCH * ]?,                             // only with `extends`
//! )
//! ```
//!
//! Paths of files are relative to the pipelines' folder.
//!
//! | form | meaning |
//! |---|---|
//! | PARAMETER | `U32(default: 64, min: 1, max: 512, one_of: [32, 64], unit: "px", doc: "…")`, or `F32`, `Bool`, `Text`. All fields are optional (see **Parameters**). A variant gives only the fields that differ |
//! | PASS | `Pass(kind: "…", shader: "x.wgsl"?, in: { "port": LINK * }?, set: { "setting": VALUE * }?, out: { "port": OUT * }?, history: HISTORY?, when: "EXPRESSION"?, off: OFF?)`; `kind` is the pass type |
//! | SUB | `Sub(file: "parts/x.ron", in: …?, set: { "parameter": VALUE * }?, when: …?, off: …?)`: a sub-graph, that is, the passes of another file, which are named `sub-graph/pass`; or, written out, `Sub(inputs: …?, in: …?, passes: …, outputs: …?, when: …?, off: …?)` |
//! | LINK | `"pass"`, `"pass.port"`, `"pass.port.member"`, `"in.input"` within a sub-graph, each of which may have `prev ` before it: `"prev pass.port"` |
//! | VALUE | `true`, a number, text, `(x, y, z)`, or an expression: text that contains `$`, such as `"$parameter"` or `"$lights * 16"`. In plain text each `$` is written `$$`; text that begins with `$$` is never an expression |
//! | OUT | `Out(interface: "…"?, format: "rgba16float"?, size: SIZE?, count: 64?, facts: { "name": VALUE }?)`, `None` as a value for no such fact; for pass types that take their ports from a shader |
//! | SIZE | `"frame"`, `"frame / 4"`, `"like(input) * 3 / 2"` or `(width, height)`. Any number may be an expression (`"frame / $tile"`, `"like(input) * ($n + 1)"`, `("$map * 2", 64)`), as may `count` |
//! | HISTORY | `(reset: [Resize, Cut, Scene, Reload, Setting, Moved, MovedUpstream]?, rest: 64?, catches_up: true?)`, or `reset: All` for all of them |
//! | OFF | `Input("port")`, or a link such as `"pass.port"` or `"in.input"`: what replaces the outputs when the switch is off |
//! | PATCH | `Replace("pass", PASS)`, `Insert(name: "x", pass: PASS, between: ("a.port", "b.port"))`, `Set("path", VALUE)`, `Remove("pass")` |
//!
//! **Links.** The name of a pass alone means its only output of the interface that the input takes, or
//! otherwise its only output. After the dot comes the name of a port, or of a member if only one port has a
//! member of that name: `"view.depth"`. An input of the interface `Texture` or `Buffer` takes any single
//! texture or buffer.
//!
//! **History buffers.** `"prev pass.port"` reads what the port held in the frame before: its history buffer. It may
//! name any pass, including a later one or the pass itself. The content is zero as long as there is no frame before.
//! `history:` of the pass that makes the port says what becomes of it. `reset` lists the events that discard the
//! history (if it is left out, the first four). `Reload` is a change of a setting, a shader or a link of the pass, or of
//! a pass that feeds it; `Moved` is any change of the camera, the lights or the scene that the pass itself reads, and
//! `MovedUpstream` one that a pass reads from which its outputs follow.
//! A loop is new in every frame, so its passes run in every frame. With `rest: n` they stop after n frames
//! in which nothing changed but the history buffer itself: the last of these frames stands until something
//! changes. Where several history buffers have a `rest`, the longest counts for all. `catches_up: true` says that the
//! content is the same after frames that left the pass out, as that of maps that are kept while their lights stay: frames
//! that only lead to a picture (the output `progress`) do not need it.
//!
//! **Patches.** They are applied in order, after the entries of the file itself.
//!
//! * `Replace` keeps those links of the old pass whose ports the new pass type has, and its `history`, `when` and `off`,
//!   unless they are given again.
//! * `Insert` puts a pass or a sub-graph into a link. The link goes to the only required input of the pass
//!   that takes it, or to the only input of the sub-graph that `in:` leaves unlinked. `"out.NAME"` means an
//!   output of the pipeline.
//! * `Remove` replaces a pass by its `off:`. Without `off:`, what reads a pass that was inserted reads again what
//!   is fed to it, and optional inputs that read another are left unlinked. What `Set` gave to a pass before it
//!   was replaced or removed is gone with it.
//! * `Set` takes a path: `parameter`, `pass.setting`, `sub-graph.parameter`, `sub-graph/pass.setting`.
//!   Command-line overrides ([`Overrides`]) take the same paths and are applied last.
//!
//! Inside a sub-graph, patches can only set values. To change the passes of a sub-graph, write a file that
//! extends the file of the sub-graph, and put it in its place by `Replace`.
//!
//! **Parameters.** A parameter that is the whole value of a setting (`set: { "count": "$lights" }`), even
//! through sub-graphs, inherits all fields that it leaves out: `"lights": U32()` has the default, range,
//! choices, unit and documentation of the setting. Its range is never wider than that of any such setting,
//! even if it gives its own. A parameter needs a `default` if its value must be known before pass types are
//! asked (in expressions, sizes and switches), and if its settings have different defaults.
//!
//! **Expressions.** Values, sizes and switches use the same small language: parameters (`$lights` or
//! `lights`), booleans, numbers and `'text'`, with `+`, `-`, `*`, `/`, `%`, `min(a, b)`, `max(a, b)`, `!`,
//! `&&`, `||`, `==`, `!=`, `<`, `<=`, `>`, `>=` and parentheses. Integers stay integers: `/` between two
//! integers rounds towards zero; if either side is a real number, so is the result. Division by zero is an
//! error, as is a result that no value can hold or that the setting does not take. Since names may contain
//! `-`, a minus needs spaces around it. The factor and the divisor of a size are a number, a parameter,
//! `min`, `max` or an expression in parentheses; a divided size is rounded up.
//!
//! **Switches.** `when:` is an expression that may also use traits of the scene (`scene.glossy`). Its types are checked, and so is everything else in a pass that is off. Whatever reads
//! a pass that is off gets what `off:` gives; without `off:`, optional inputs are left unlinked, and for
//! other inputs it is an error. A link in `off:` replaces every output of its interface. It may name any pass
//! or sub-graph, even one that is off itself: then the `off:` of that one applies. Passes that are off must
//! not replace each other in a cycle. The pass that `off:` names is needed only if the switch is off.
//!
//! **One file.** [`Resolved::to_ron`] writes a pipeline as one file without `extends` and `patch`. Its sub-graphs are
//! written out: `Sub(inputs: …, in: …, passes: …, outputs: …, when: …, off: …)`, whose values may name the parameters of
//! the file. Any other file may say so too.
//!
//! # Errors
//!
//! All errors of a file are reported at once, each with a code (see [`codes`]), its place, both ends of a
//! link, and the nearest name. A broken file, whatever its text, gives errors and never a panic.

pub mod codes;
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

pub use compile::{CompileOptions, compile};
pub use data_file::Name;
pub use data_file::{Diagnostic, Diagnostics, Label, Severity, Source, Span, nearest, nearest_of_few};
pub use data_file::{LightSource, Misfit, Setting, Settings, Traits, Value, ValueType};
pub use description::{Description, parse};
pub use expression::{Formula, FormulaError, NameError};
pub use frame::{Change, FrameState, ResetCause};
pub use interface::{Content, Fact, FactDecl, FactValue, Figure, Interface, Member, Struct};
pub use link::{Graph, LinkContext, link, name_in_united, original_name, unite};
pub use plan::{Plan, PlanId};
pub use port::{
    Facts, HandedOn, InputPort, Limit, Module, OutputContext, OutputDesc, OutputPort, PassTypeError,
    PassTypes, Ports, SceneBindings, Usage, Use,
};
pub use resolve::{
    Difference, Files, Overrides, PassChange, Resolved, Settable, diff, resolve, resolve_description,
    template, variant,
};
pub use resource::{BufferDesc, Clear, Extent, Format, ResourceDesc, TextureDesc, human_bytes};
pub use succession::Succession;
