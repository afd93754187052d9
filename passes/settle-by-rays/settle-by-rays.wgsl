// Settles lookups of shadow maps by rays where the map cannot tell.
//
// Near a light, rays decide all. Elsewhere a map is sure that a receiver is hidden that lies far behind what is in its texel. Of what
// lies little behind it, a ray along that stretch decides. What lies before it, or is it, is lit as far as the map tells: a ray all the way decides where that is not believed.

#input maps: Visibility with atlas // An atlas of depth maps.
#output visibility: Visibility(
    tile: maps.tile,
    columns: maps.columns,
    rows: maps.rows,
    depth_bias: maps.depth_bias,
    slope_bias: maps.slope_bias,
    doubt: settings.doubt,
    near: settings.near,
    iterations: 400,
) hands on maps module "lookup.wgsl" // The same atlas, with lookups that trace rays.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.

struct Settings {
    /// How far behind what a texel stores a receiver must lie to be hidden without a ray, in widths of a texel at the receiver.
    /// More: less that maps hide wrongly, but more rays. [default: 6.0, min: 0.0]
    doubt: f32,
    /// Distance from a light within which a ray decides, whatever the map says, in radii of a disc of the light's area. There a
    /// wrong answer shows as a bright or dark spot, and small things between may be without a point. 0 is no such distance.
    /// More: fewer spots, but more rays. [default: 8.0, min: 0.0]
    near: f32,
}
