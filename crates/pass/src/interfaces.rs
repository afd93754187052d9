//! The interfaces of Lightloom: where algorithms are swapped. Every producer of one works with every consumer.
//!
//! Scene units are metres; colours are linear Rec. 709; all radiometric quantities are per RGB channel.

use frame_graph::{Extent, Format, Interface, Member, OutputContext, PassTypeError, ResourceDesc};

const fn required(name: &'static str, doc: &'static str) -> Member {
    Member { name, optional: false, doc }
}

const fn optional(name: &'static str, doc: &'static str) -> Member {
    Member { name, optional: true, doc }
}

/// All of them.
pub static INTERFACES: &[Interface] = &[
    Interface {
        name: "GBuffer",
        doc: "What the camera sees, one texel a pixel.",
        members: &[
            required("depth", "r32float: distance along the viewing axis [m]; 0 where nothing is seen"),
            required("normal", "rgba16float: shading normal in world space, unit, on the side of the camera"),
            required("albedo", "rgba16float: diffuse reflectance"),
            optional("specular", "rgba16float: reflectance at normal incidence, and roughness"),
            optional("emission", "rgba32float: emitted radiance [W/(m² sr)]"),
            optional("motion", "rg32float: where it was in the frame before, minus where it is [px]"),
        ],
    },
    Interface {
        name: "ReflectiveShadowMap",
        doc: "What the lights see: a layer a spot or directional light, six a point light. Facts: `size`, `layers`.",
        members: &[
            required(
                "position",
                "rgba32float array: world position [m], and distance along the layer's axis [m]; 0 where empty",
            ),
            required(
                "normal",
                "rgba16float array: shading normal in world space, unit, on the side of the light",
            ),
            required("flux", "rgba32float array: flux reflected by the texel's part of the surface [W]"),
        ],
    },
    Interface {
        name: "ImportanceMap",
        doc: "How much each texel of a reflective shadow map matters, in any unit. Facts: `size`, `layers`.",
        members: &[required("", "r32float array: f(v) ≥ 0 of TCAS Eq. 1, as many layers as the map")],
    },
    Interface {
        name: "VirtualLights",
        doc: "Lights that stand for reflected light. Facts: `count`, the most there can be.",
        members: &[required("", "buffer: struct VirtualLights of shaders/virtual-lights.wgsl")],
    },
    Interface {
        name: "Points",
        doc: "Samples of the scene's surfaces, of which each map takes an even part. Module: answers `fn surface_sample(wanted: SamplesWanted, index: u32) -> SurfaceSample` and `fn samples_asked() -> u32` (shaders/surface-sample.wgsl). Facts: `count`, the most different ones there are; `block`, a power of two: how many maps take turns.",
        members: &[required("", "buffer: what the module reads")],
    },
    Interface {
        name: "DepthAtlas",
        doc: "Hemispherical depth maps as splatted, one a virtual light. Facts: `tile` [px], `count`, `depth_bias`: bias of a lookup, in widths of a texel along the receiver's plane.",
        members: &[required(
            "",
            "buffer: [count × tile × tile] u32, map after map: the bits of the distance [m]; those of +∞ where nothing fell",
        )],
    },
    Interface {
        name: "Visibility",
        doc: "Whether a virtual light is seen from a point. Module: answers `fn visibility(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32`. Facts: `loop_iterations` of a lookup, where they are many; for an atlas `tile` [px], `columns` and `rows` of a layer, `depth_bias` (in widths of a texel along the receiver's plane).",
        members: &[optional(
            "atlas",
            "r32float: paraboloid maps of the distance [m], one tile a virtual light, row by row and layer by layer; a large number where nothing is",
        )],
    },
    Interface {
        name: "Irradiance",
        doc: "Indirect irradiance at the pixels of a G-buffer.",
        members: &[required(
            "",
            "rgba32float: [W/m²]; in alpha the luminance of what clamping removed [W/m²]",
        )],
    },
    Interface {
        name: "Counters",
        doc: "How much a pass was requested to produce, and how much it produced within its bounds.",
        members: &[required("", "buffer: struct Counters of shaders/counters.wgsl")],
    },
    Interface {
        name: "PathSamples",
        doc: "Sums of a progressive picture: what the next frame goes on from.",
        members: &[
            required("image", "rgba32float: all light [W/(m² sr)]; in alpha its squared luminance"),
            required(
                "direct",
                "rgba32float: light reflected once [W/(m² sr)]; in alpha the samples that saw something",
            ),
            required("indirect", "rgba32float: light reflected more than once [W/(m² sr)]"),
            required(
                "irradiance",
                "rgba32float: indirect irradiance [W/m²]; in alpha the luminance of what clamping removed",
            ),
            required("progress", "buffer: struct Progress of shaders/progress.wgsl"),
        ],
    },
    Interface {
        name: "Radiance",
        doc: "Radiance towards the camera.",
        members: &[required("", "rgba32float: [W/(m² sr)]; alpha 1 where something is seen")],
    },
    Interface {
        name: "Display",
        doc: "A picture for a screen.",
        members: &[required("", "rgba8unorm: tone-mapped and encoded as sRGB")],
    },
];

/// The formats in which the passes of the tree write the textures of interfaces: interface, member, format.
///
/// A pass in WGSL alone that names no format for a target gets the one given here. Consumers read any format of
/// the same sort, so this binds nobody.
pub static FORMATS: &[(&str, &str, Format)] = &[
    ("GBuffer", "depth", Format::R32Float),
    ("GBuffer", "normal", Format::Rgba16Float),
    ("GBuffer", "albedo", Format::Rgba16Float),
    ("GBuffer", "specular", Format::Rgba16Float),
    ("GBuffer", "emission", Format::Rgba32Float),
    ("GBuffer", "motion", Format::Rg32Float),
    ("ReflectiveShadowMap", "position", Format::Rgba32Float),
    ("ReflectiveShadowMap", "normal", Format::Rgba16Float),
    ("ReflectiveShadowMap", "flux", Format::Rgba32Float),
    ("ImportanceMap", "", Format::R32Float),
    ("Visibility", "atlas", Format::R32Float),
    ("Irradiance", "", Format::Rgba32Float),
    ("PathSamples", "image", Format::Rgba32Float),
    ("PathSamples", "direct", Format::Rgba32Float),
    ("PathSamples", "indirect", Format::Rgba32Float),
    ("PathSamples", "irradiance", Format::Rgba32Float),
    ("Radiance", "", Format::Rgba32Float),
    ("Display", "", Format::Rgba8Unorm),
];

/// Returns the format of a member by [`FORMATS`]; `None` where the member is a buffer or there is none of that name.
pub fn format_of(interface: &str, member: &str) -> Option<Format> {
    let of = |entry: &&(&str, &str, Format)| entry.0 == interface && entry.1 == member;
    FORMATS.iter().find(of).map(|(_, _, format)| *format)
}

/// Returns the size and layers of the importance map that a sampler reads beside the reflective shadow map it was made
/// from: its inputs are `importance` and `rsm`.
///
/// # Errors
/// Where the two have not the same texels.
pub fn importance_shape(cx: &OutputContext<'_>) -> Result<((u32, u32), u32), PassTypeError> {
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

/// Returns the buffer of so many virtual lights: struct VirtualLights of shaders/virtual-lights.wgsl.
pub fn virtual_lights(count: u32) -> ResourceDesc<Extent> {
    const HEADER_BYTES: u64 = 16;
    const LIGHT_BYTES: u64 = 48;
    ResourceDesc::buffer(HEADER_BYTES + LIGHT_BYTES * u64::from(count))
}
