// Softens shadow-map lookups by the area of the light and the distance of what blocks it. [Fernando 2005; ACRSM §5.3.3]

#input maps: Visibility with atlas // An atlas of depth maps.
#output visibility: Visibility(
    tile: maps.tile,
    columns: maps.columns,
    rows: maps.rows,
    depth_bias: maps.depth_bias,
    slope_bias: maps.slope_bias,
    search: settings.search,
    taps: settings.taps,
    nearest: settings.nearest,
    iterations: settings.search + settings.taps,
) hands on maps module "lookup.wgsl" // The same atlas, with soft lookups.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.

struct Settings {
    /// Taps that look for blockers. More: small blockers are found, and time grows in proportion. [default: 16, min: 1, max:
    /// 32]
    search: u32,
    /// Taps that are filtered, which make as many shades and one more. More: smoother penumbrae, and time grows in
    /// proportion. ACRSM §5.3.3 has 16. [default: 16, min: 1, max: 32]
    taps: u32,
    /// Least height of a blocker above the light's plane that is looked for, as a share of the receiver's. It bounds the
    /// region of the search and the penumbra, to (1 - n) / n of the light's radius. Smaller: wider penumbrae of
    /// blockers near the light; but more blockers are found that hide nothing, and fewer of the small ones. [default: 0.5,
    /// min: 0.01, max: 1.0]
    nearest: f32,
}
