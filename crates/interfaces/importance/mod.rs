//! Importance of each texel of a reflective shadow map.

use pass::{Content, Fact, Format, Interface, Member, Struct};

/// The number of samples of the view.
pub const VIEW_SAMPLES: Fact<u32> = Fact::optional("view_samples", "number of samples of the view");
/// The least distance between a texel and a sample of the view.
pub const MIN_DISTANCE: Fact<f32> =
    Fact::optional("min_distance", "least distance between a texel and a sample of the view [extents]");
/// The response that is added everywhere.
pub const DEFENSIVE: Fact<f32> =
    Fact::optional("defensive", "response that is added everywhere [1/extents²]");

/// `struct ViewSample` of view-sample.wgsl.
pub const VIEW_SAMPLE: Struct = Struct::new("shaders/view-sample.wgsl", "ViewSample");

/// The interface `Importance`.
pub const INTERFACE: Interface = Interface::new(
    "Importance",
    "How much each texel of a reflective shadow map matters, in any unit: f(v) ≥ 0 of TCAS Eq. 1. Module: defines `fn \
     importance(layer: u32, texel: vec2<u32>) -> f32`, which reads what it is stored as.",
    &[
        Member::optional("map", Content::TextureArray(Format::R32Float), "f(v) of each texel"),
        Member::optional("samples", Content::Array("ViewSample"), "samples of the view (view-sample.wgsl)"),
        Member::optional("position", Content::TextureArray(Format::Rgba32Float), "of the reflective shadow map"),
        Member::optional("normal", Content::TextureArray(Format::Rgba16Float), "of the reflective shadow map"),
        Member::optional("flux", Content::TextureArray(Format::Rgba32Float), "of the reflective shadow map"),
    ],
)
.with_facts(&[VIEW_SAMPLES.decl(), MIN_DISTANCE.decl(), DEFENSIVE.decl()])
.with_stand_in("shaders/importance-stored.wgsl");
