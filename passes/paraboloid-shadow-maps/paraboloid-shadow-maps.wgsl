// Renders every triangle into one paraboloid depth map per virtual light: the exact baseline. [ISM §5]
//
// render.wgsl draws the scene into the maps of a layer. Where maps are kept, list-moved.wgsl lists those whose lights moved,
// and clear.wgsl clears them first.
//
// visibility.atlas: r32float, the distance [m] along the ray through the centre of each texel; NOTHING where nothing is.
//
// Distances are those of the centres of texels, so a plane needs no depth bias; there is one for surfaces that bend within a
// texel, and for shading normals, which are not those of the triangles.

#input lights: VirtualLights // The lights: one map each, over the hemisphere around its normal.
#input past: Visibility optional // The maps of the frame before, which are kept where a light stays: `prev` of the output
    // `visibility`, reset by `Scene`, `Reload`, `Setting` and `Moved`.
#input rendered: Stands optional // `prev` of the output `stands`, reset by the same; needed with `past`.
#output visibility: Visibility(
    tile: settings.map,
    columns: atlas_columns,
    rows: atlas_rows,
    depth_bias: 0.2 * settings.depth_bias,
    slope_bias: 0.0,
) module "visibility-atlas.wgsl" // The maps.
#output stands: Stands(count: lights.count) cleared // Where the lights stand whose maps these are; zero where maps are not
    // kept.

struct Settings {
    /// Side of a map (ISM compares with 256). Larger: sharper shadows, but more time. [default: 64, min: 1, max: 8192, unit:
    /// "px"]
    map: u32,
    /// Factor on the bias of the depth test that these maps need. Surfaces shadow themselves less and light leaks more with
    /// it. [default: 1.0, min: 0.0]
    depth_bias: f32,
}
