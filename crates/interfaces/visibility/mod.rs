//! Whether a virtual light is visible from a point.

mod atlas;

use crate::virtual_lights;
pub use atlas::AtlasLayout;
use pass::{
    Content, Fact, Format, Interface, Member, Module, OutputContext, OutputDesc, PassTypeError, Value,
};

/// The loop iterations of a lookup.
pub const LOOP_ITERATIONS: Fact<u32> =
    Fact::optional("loop_iterations", "iterations of the loops of a lookup, where they are many");
/// The side of a map of an atlas.
pub const TILE: Fact<u32> = Fact::optional("tile", "side of a map of the atlas [px]");
/// The maps along a row of a layer of an atlas.
pub const COLUMNS: Fact<u32> = Fact::optional("columns", "maps along a row of a layer of the atlas");
/// The rows of maps in a layer of an atlas.
pub const ROWS: Fact<u32> = Fact::optional("rows", "rows of maps in a layer of the atlas");
/// The depth bias of a lookup.
pub const DEPTH_BIAS: Fact<f32> =
    Fact::optional("depth_bias", "bias of a lookup, in widths of a texel at the receiver");
/// The depth bias of a lookup that grows with the slope of the receiver's plane.
pub const SLOPE_BIAS: Fact<f32> = Fact::optional(
    "slope_bias",
    "bias of a lookup, in widths of a texel times the slope of the receiver's plane",
);
/// How blockers are searched for.
pub const SEARCH: Fact<u32> =
    Fact::optional("search", "taps of a lookup that look for blockers, or its searches in basis images");
/// How near to the light blockers are looked for.
pub const NEAREST: Fact<f32> = Fact::optional(
    "nearest",
    "least height of blockers above the light's plane, as a share of the receiver's",
);
/// The orders of basis images.
pub const ORDER: Fact<u32> = Fact::optional("order", "orders of the expansion that basis images have");
/// The levels of basis images.
pub const LEVELS: Fact<u32> = Fact::optional("levels", "levels of basis images above the maps");
/// How the orders of basis images are weighted.
pub const ATTENUATION: Fact<f32> = Fact::optional("attenuation", "how much high orders are attenuated");
/// How basis images are compared.
pub const OFFSET: Fact<f32> =
    Fact::optional("offset", "how much nearer than a receiver it is compared, in depths of 1 / order");
/// The part of the basis images that a map takes.
pub const STRIDE: Fact<u32> = Fact::optional("stride", "words of a map in its buffer of basis images");

/// The option of modules whose lookups can be those of another light's map: shaders/visibility-shared.wgsl declares it.
pub const SHARED: &str = "SHARED";

/// Returns the module in that file for the maps of an input: where lights share the maps, it looks a light up in the map
/// of its owner.
pub fn module_of_maps(cx: &OutputContext<'_>, input: &str, path: &str) -> Module {
    let module = Module::new(path);
    match cx.input(input).and_then(|maps| maps.member("owners")) {
        Some(_) => module.option(SHARED, Value::Bool(true)),
        None => module,
    }
}

/// Hands the maps of an input on as the output `visibility`, to be looked up by the module in that file; `reach` is how many times
/// the bias of the maps its lookups need.
///
/// # Errors
/// Where the input has no atlas of maps.
pub fn with_other_lookups(
    cx: &OutputContext<'_>,
    input: &str,
    path: &str,
    reach: f32,
) -> Result<OutputDesc, PassTypeError> {
    if cx.input(input).is_some_and(|maps| maps.member("atlas").is_none()) {
        let message = "there are no maps to look up: the member `atlas` is missing";
        let error = PassTypeError::input(input, message);
        return Err(error.help("link what makes depth maps, or take this pass out"));
    }
    Ok(OutputDesc::hand_on("visibility", input)
        .module(module_of_maps(cx, input, path))
        .fact(TILE, cx.fact(input, TILE)?)
        .fact(COLUMNS, cx.fact(input, COLUMNS)?)
        .fact(ROWS, cx.fact(input, ROWS)?)
        .fact(DEPTH_BIAS, cx.fact(input, DEPTH_BIAS)? * reach)
        .fact(SLOPE_BIAS, cx.fact(input, SLOPE_BIAS)? * reach))
}

/// The interface `Visibility`.
pub const INTERFACE: Interface = Interface::new(
    "Visibility",
    "Whether a virtual light is seen from a point. Module: defines `fn visibility(index: u32, light: VirtualLight, at: \
     vec3<f32>, normal: vec3<f32>) -> f32`.",
    &[
        Member::optional(
            "atlas",
            Content::Texture(Format::R32Float),
            "array: paraboloid maps of the distance [m], one tile a virtual light, row by row and layer by layer; a \
             large number where nothing is",
        ),
        Member::optional(
            "basis",
            Content::Buffer,
            "u32: images of the atlas in several levels, prefiltered for a series of the depth test",
        ),
        Member::optional("owners", Content::Buffer, "where lights share maps, u32 a light: whose map is its own"),
        Member::optional(
            "sources",
            Content::Struct(virtual_lights::LIGHTS),
            "where lights share maps: the lights of the maps",
        ),
    ],
)
.with_facts(&[
    LOOP_ITERATIONS.decl(),
    TILE.decl(),
    COLUMNS.decl(),
    ROWS.decl(),
    DEPTH_BIAS.decl(),
    SLOPE_BIAS.decl(),
    SEARCH.decl(),
    NEAREST.decl(),
    ORDER.decl(),
    LEVELS.decl(),
    ATTENUATION.decl(),
    OFFSET.decl(),
    STRIDE.decl(),
])
.with_stand_in("shaders/visibility-none.wgsl");
