//! The surfaces that the lights see.

use pass::{Content, Format, Interface, Member};

/// The interface `ReflectiveShadowMap`.
pub const INTERFACE: Interface = Interface::new(
    "ReflectiveShadowMap",
    "What the lights see: one layer per spot or directional light, six per point light.",
    &[
        Member::required(
            "position",
            Content::TextureArray(Format::Rgba32Float),
            "world position [m], and distance along the layer's axis [m]; 0 where empty",
        ),
        Member::required(
            "normal",
            Content::TextureArray(Format::Rgba16Float),
            "interpolated normal in world space, unit, on the side of the light; in alpha the normal that a normal map bends, as octahedron.wgsl encodes it in a half float, and 0 without",
        ),
        Member::required(
            "flux",
            Content::TextureArray(Format::Rgba32Float),
            "flux reflected by the texel's part of the surface [W]; in alpha the area of that part [m²]",
        ),
        Member::optional(
            "albedo",
            Content::TextureArray(Format::Rgba16Float),
            "diffuse reflectance; in alpha, the flux that is reflected under a normal map, over that without",
        ),
        Member::optional(
            "specular",
            Content::TextureArray(Format::Rgba16Float),
            "specular reflectance at normal incidence, and in alpha roughness; where a surface is glossy",
        ),
    ],
);
