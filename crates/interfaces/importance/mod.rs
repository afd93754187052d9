//! Importance of each texel of a reflective shadow map.

use pass::{Content, Fact, Format, Interface, Member, OutputContext, PassTypeError, ResourceDesc, Struct};

/// The side of a block of texels to which the view responds alike.
pub const STRIDE: Fact<u32> = Fact::optional("stride", "side of a block with one response [texels]");
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
        Member::optional("map", Content::Texture(Format::R32Float), "array: f(v) of each texel"),
        Member::optional(
            "response",
            Content::Texture(Format::Rgba32Float),
            "array: response of the view to a texel of each block [1/extents²]",
        ),
        Member::optional("samples", Content::Struct(VIEW_SAMPLE), "samples of the view"),
        Member::optional("position", Content::Texture(Format::Rgba32Float), "of the reflective shadow map"),
        Member::optional("normal", Content::Texture(Format::Rgba16Float), "of the reflective shadow map"),
        Member::optional("flux", Content::Texture(Format::Rgba32Float), "of the reflective shadow map"),
    ],
)
.with_facts(&[STRIDE.decl(), VIEW_SAMPLES.decl(), MIN_DISTANCE.decl(), DEFENSIVE.decl()])
.with_stand_in("shaders/importance-stored.wgsl");

/// Returns the size and layers of the reflective shadow map that a sampler reads together with its importance: the inputs
/// are `importance` and `rsm`.
///
/// # Errors
/// Where the two differ in size or layers.
pub fn shape(cx: &OutputContext<'_>) -> Result<((u32, u32), u32), PassTypeError> {
    let shape = |input: &str, member: &str| {
        let texture = cx.input(input)?.member(member).and_then(ResourceDesc::texture)?;
        Some((texture.size, texture.layers))
    };
    let rsm = shape("rsm", "flux").ok_or_else(|| PassTypeError::input("rsm", "expected a member `flux`"))?;
    let importance = shape("importance", "map").or_else(|| shape("importance", "flux"));
    let importance = importance
        .ok_or_else(|| PassTypeError::input("importance", "expected a member `map` or a member `flux`"))?;
    if rsm != importance {
        let (((width, height), layers), ((rsm_width, rsm_height), rsm_layers)) = (importance, rsm);
        return Err(PassTypeError::input(
            "importance",
            format!(
                "the importance map has {width}×{height} texels in {layers} layers, the reflective shadow map \
                 {rsm_width}×{rsm_height} in {rsm_layers}"
            ),
        )
        .help("both must come from the same lights: link the map that the importance was made from"));
    }
    Ok(rsm)
}
