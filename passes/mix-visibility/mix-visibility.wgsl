// Looks a few virtual lights up in maps of another kind than those of the rest: exact ones, where only a few can have them.

#input maps: Visibility with atlas // Maps of all lights.
#input exact: Visibility with atlas // Maps of a few of them.
#input places: Owners // For each light, its place among those of `exact`; none where it has no map there.
#output visibility: Visibility(
    tile: maps.tile,
    columns: maps.columns,
    rows: maps.rows,
    depth_bias: maps.depth_bias,
    slope_bias: maps.slope_bias,
    exact_tile: exact.tile,
    exact_columns: exact.columns,
    exact_rows: exact.rows,
    exact_depth_bias: exact.depth_bias,
    exact_slope_bias: exact.slope_bias,
) hands on maps module "lookup.wgsl" // Both.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.
