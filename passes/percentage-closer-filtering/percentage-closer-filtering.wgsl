// Filters shadow-map lookups after the depth test. [Reeves, Salesin & Cook 1987]
//
// The farthest texel is farther from the receiver than with one tap, in proportion to the width of the window: so are the
// depth biases.

#input maps: Visibility with atlas // An atlas of depth maps.
#output visibility: Visibility(
    tile: maps.tile,
    columns: maps.columns,
    rows: maps.rows,
    depth_bias: maps.depth_bias * ((settings.taps + 1) / 2.0),
    slope_bias: maps.slope_bias * ((settings.taps + 1) / 2.0),
    taps: settings.taps,
    iterations: (settings.taps + 1) * (settings.taps + 1),
) hands on maps module "lookup.wgsl" // The same atlas, with filtered lookups.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.

struct Settings {
    /// Bilinear taps along each side of the window, one texel apart; 1 is bilinear filtering of four texels. More: softer
    /// edges of shadows; but contact shadows fade, since the depth bias grows with the window, and time grows with the square.
    /// [default: 1, min: 1, max: 16]
    taps: u32,
}
