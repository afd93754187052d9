//! The surfaces that the camera sees.

use pass::{Content, Format, Interface, Member};

/// The interface `GBuffer`.
pub const INTERFACE: Interface = Interface::new(
    "GBuffer",
    "What the camera sees, one texel per pixel.",
    &[
        Member::required(
            "depth",
            Content::Texture(Format::R32Float),
            "distance along the viewing axis [m]; 0 where nothing is seen",
        ),
        Member::required(
            "normal",
            Content::Texture(Format::Rgba16Float),
            "shading normal in world space, unit, on the side of the camera",
        ),
        Member::required(
            "albedo",
            Content::Texture(Format::Rgba16Float),
            "diffuse reflectance; 0 where the shading normal turns away from the camera",
        ),
        Member::optional(
            "geometric",
            Content::Texture(Format::Rg16Float),
            "interpolated normal, which normal maps do not bend, as octahedron.wgsl encodes it; where a scene has them",
        ),
        Member::optional(
            "specular",
            Content::Texture(Format::Rgba16Float),
            "reflectance at normal incidence, and roughness",
        ),
        Member::optional(
            "emission",
            Content::Texture(Format::Rgba32Float),
            "emitted radiance [W/(m² sr)]; that of the environment where nothing is seen",
        ),
        Member::optional(
            "motion",
            Content::Texture(Format::Rg32Float),
            "where it was in the frame before, minus where it is [px]",
        ),
    ],
);
