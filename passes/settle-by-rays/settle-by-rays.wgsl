// Settles lookups of shadow maps by rays where the map cannot tell.
//
// A map is sure that a receiver is hidden that lies far behind what is in its texel and those beside it, and that one is lit whose own
// surface is in its texel, with nothing nearer beside it. Of what lies little behind its texel, a ray along that stretch decides; of
// all else, a ray all the way.

#input maps: Visibility with atlas // An atlas of depth maps.
#output visibility: Visibility(
    tile: maps.tile,
    columns: maps.columns,
    rows: maps.rows,
    depth_bias: maps.depth_bias,
    slope_bias: maps.slope_bias,
    doubt: settings.doubt,
    iterations: 400,
) hands on maps module "lookup.wgsl" // The same atlas, with lookups that trace rays.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.

struct Settings {
    /// How far behind what a texel stores a receiver must lie to be hidden without a ray all along, in widths of a texel at the
    /// receiver. More: less that maps hide wrongly, but longer rays. [default: 6.0, min: 0.0]
    doubt: f32,
}
