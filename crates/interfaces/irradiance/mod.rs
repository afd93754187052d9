//! Indirect irradiance at the pixels of a G-buffer, and what filters of it have in common.

use pass::{
    Content, Extent, Fact, Format, Interface, Member, OutputContext, OutputDesc, PassTypeError, Ports,
    ResourceDesc, SceneBindings,
};

/// The sub-images along a row, of an irradiance that is interleaved.
pub const INTERLEAVE_X: Fact<u32> =
    Fact::optional("interleave_x", "sub-images along a row; 1 where it is left out");
/// The sub-images along a column, of an irradiance that is interleaved.
pub const INTERLEAVE_Y: Fact<u32> =
    Fact::optional("interleave_y", "sub-images along a column; 1 where it is left out");
/// The bound of the geometry terms that were summed, where nothing else bounds them.
pub const CLAMP: Fact<f32> = Fact::optional(
    "clamp",
    "distance below which the geometry terms of lights grow no more, as a fraction of the scene's extent; where nothing \
     else bounds them",
);

/// The interface `Irradiance`.
pub const INTERFACE: Interface = Interface::new(
    "Irradiance",
    "Indirect irradiance at the pixels of a G-buffer.",
    &[Member::required(
        "",
        Content::Texture(Format::Rgba32Float),
        "[W/m²]; in alpha the luminance of what clamping removed [W/m²]",
    )],
)
.with_facts(&[INTERLEAVE_X.decl(), INTERLEAVE_Y.decl(), CLAMP.decl()]);

/// Returns the ports of a filter: it averages `irradiance` over pixels that see the same surface in `view`.
pub fn filter_ports() -> Ports {
    Ports {
        inputs: vec![
            pass::input("view", "GBuffer", "Determines which pixels see the same surface."),
            pass::input("irradiance", "Irradiance", "The irradiance to average; of the size of `view`."),
        ],
        outputs: vec![pass::output("filtered", "Irradiance", "The averages.")],
        scene_bindings: SceneBindings::CAMERA,
    }
}

/// Describes a picture of a filter, as large as its input `view`.
pub fn filter_picture() -> ResourceDesc<Extent> {
    ResourceDesc::texture_2d(Format::Rgba32Float, Extent::like("view"))
}

/// Describes the output of a filter.
///
/// # Errors
/// Where the irradiance and the view differ in size.
pub fn filter_output(cx: &OutputContext<'_>) -> Result<OutputDesc, PassTypeError> {
    let sizes = ["view", "irradiance"].map(|port| cx.input(port).and_then(|input| input.size()));
    if let [Some(view), Some(irradiance)] = sizes
        && view != irradiance
    {
        return Err(PassTypeError::input(
            "irradiance",
            format!("irradiance is {}×{}, but the view is {}×{}", irradiance.0, irradiance.1, view.0, view.1),
        ));
    }
    Ok(OutputDesc::one("filtered", filter_picture()))
}
