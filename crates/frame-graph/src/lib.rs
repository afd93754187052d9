//! The frame graph of Lightloom, from the text of a RON file to a plan that an executor can run.
//!
//! ```text
//! RON ─parse─▶ Description ─resolve─▶ Resolved ─link─▶ Graph ─compile─▶ Plan ─frame─▶ the passes to run
//! ```
//!
//! Each arrow is one function. Nothing here knows a GPU, a shader, a scene or any particular pass: what a
//! kind of pass offers comes through the [`Kinds`] trait, and what the scene holds through [`Traits`].

pub mod codes;
pub mod compile;
pub mod description;
pub mod diagnostic;
mod expression;
pub mod frame;
pub mod link;
mod name;
pub mod plan;
pub mod port;
mod reader;
pub mod resolve;
pub mod resource;
pub mod value;

pub use compile::{CompileOptions, compile};
pub use description::{Description, parse};
pub use diagnostic::{Diagnostic, Diagnostics, Label, Source, Span};
pub use frame::{Change, FrameState, ResetCause};
pub use link::{Graph, LinkContext, link};
pub use name::Name;
pub use plan::{Plan, PlanId};
pub use port::{
    Externals, Facts, InputPort, Interface, KindError, Kinds, Member, OutputContext, OutputDesc, OutputPort,
    Ports, Usage, Use,
};
pub use resolve::{Difference, Files, Overrides, Parameter, Resolved, diff, resolve, resolve_description};
pub use resource::{BufferDesc, Clear, Extent, Format, ResourceDesc, TextureDesc};
pub use value::{Misfit, Setting, Settings, Traits, Value, ValueType};
