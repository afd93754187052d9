//! Importance of each texel of a reflective shadow map.

use pass::{Content, Format, Interface, Member, OutputContext, PassTypeError};

/// The interface `ImportanceMap`.
pub const INTERFACE: Interface = Interface::new(
    "ImportanceMap",
    "How much each texel of a reflective shadow map matters, in any unit.",
    &[Member::required(
        "",
        Content::Texture(Format::R32Float),
        "array: f(v) ≥ 0 of TCAS Eq. 1, as many layers as the map",
    )],
);

/// Returns the size and layers of the importance map that a sampler reads together with its reflective shadow map: the
/// inputs are `importance` and `rsm`.
///
/// # Errors
/// Where the two differ in size or layers.
pub fn shape(cx: &OutputContext<'_>) -> Result<((u32, u32), u32), PassTypeError> {
    let shape = |name: &str| {
        let texture =
            cx.input(name).and_then(|input| input.members.iter().find_map(|(_, desc)| desc.texture()));
        texture
            .map(|t| (t.size, t.layers))
            .ok_or_else(|| PassTypeError::input(name, "expected a texture array"))
    };
    let ((width, height), layers) = shape("importance")?;
    let (rsm, rsm_layers) = shape("rsm")?;
    if (rsm, rsm_layers) != ((width, height), layers) {
        return Err(PassTypeError::input(
            "importance",
            format!(
                "the importance map has {width}×{height} texels in {layers} layers, the reflective shadow map {}×{} in {rsm_layers}",
                rsm.0, rsm.1
            ),
        )
        .help("both must come from the same lights: link the map that the importance was made from"));
    }
    Ok(((width, height), layers))
}
