// Fills the holes of splatted depth maps through an image pyramid. [ISM §3.2]
//
// pull.wgsl makes the levels of the pyramid from the finest on, push.wgsl corrects them from the coarsest on, and fill.wgsl
// corrects the maps themselves by level 1.
//
// visibility.atlas: r32float, the distance [m]; NOTHING where a hole remains.

#input depth: DepthAtlas // The maps, with holes.
#output visibility: Visibility(
    size: (atlas_width, atlas_height),
    layers: atlas_layers,
    tile: depth.tile,
    columns: atlas_columns,
    rows: atlas_rows,
    depth_bias: depth.depth_bias,
    slope_bias: depth.slope_bias,
) module "visibility-atlas.wgsl" // The maps, filled.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.

struct Settings {
    /// Levels of the pyramid above the maps; 0 leaves holes as they are. More: larger holes close, but small openings close as
    /// well. [default: 2, min: 0, max: 4]
    levels: u32,
}
