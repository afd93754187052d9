// The weight of a light by the importance of what its chain met. [TCAS Eq. 3]

#import "algorithms/scaled.wgsl"

/// The greatest w / f: with 24-bit numbers, no chain accepts a step that lowers f by a larger factor.
const GREATEST_RATIO: f32 = 16777216.0;

/// w / f of Eq. 3, where w = whole / parts: neither need be in the range of f32 in the other's unit.
fn ratio(whole: Scaled, parts: f32, importance: f32) -> f32 {
    let f = Scaled(importance, 0);
    let unit = max(magnitude(whole), magnitude(f));
    let w = in_units(whole, unit) / parts;
    // A chain that met no importance gives no light, rather than 0 / 0.
    if importance == 0.0 || w == 0.0 {
        return 0.0;
    }
    // DEVIATION(greatest-ratio): with the weights `none`, a chain that met only 1e-30 in a map of 1e30 would give a
    // light 1e60 times too bright.
    let least = in_units(f, unit);
    if w >= least * GREATEST_RATIO {
        return GREATEST_RATIO;
    }
    return w / least;
}
