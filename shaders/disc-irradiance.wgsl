// Irradiance from a Lambertian disc in closed form.
//
// The vector irradiance of a disc has a component along the disc's axis and one across it, and both are known (Howell's
// catalogue): its product with a receiver's normal is exact where the receiver has the whole disc well before it. Near the horizon, a
// sphere that gives the same takes the disc's place, since the part of a sphere above a plane is known (Snyder 1996): it is off
// by 1.4 % of the whole on average, and by 9 % at most. A receiver that does not have the disc's middle before it gets nothing, since
// visibility is that of the middle; and so that no edge shows there, what a horizon cuts fades with the middle's height above it.

#import "color.wgsl"

/// Vector irradiance at a receiver, divided by the disc's flux [1/m²]; it points at the disc. `offset` [m] leads from the middle of
/// the disc to the receiver, which is in front of it; `axis` is the disc's unit normal; `radius2` [m²] is not 0.
fn disc_vector(offset: vec3<f32>, axis: vec3<f32>, radius2: f32) -> vec3<f32> {
    // In units in which the squares of distance and radius sum to 1, no fourth power leaves the range of f32.
    let unit2 = dot(offset, offset) + radius2;
    let to_receiver = offset * inverseSqrt(unit2);
    let height = dot(axis, to_receiver);
    let beyond = 1.0 - 2.0 * radius2 / unit2;
    let root = max(sqrt(beyond * beyond + 4.0 * (radius2 / unit2) * height * height), 1e-12);
    // Of two forms of the same, one cancels on either side of the disc's radius.
    var along = height * height / (root + beyond);
    if beyond < 0.0 {
        along = (root - beyond) * unit2 / (4.0 * radius2);
    }
    let across = height / (root + 1.0);
    return (axis * along + (to_receiver - height * axis) * across) * (-2.0 / (PI * root * unit2));
}

/// Irradiance of a sphere of radiosity 1 on a plane that cuts it: `sine2` is the squared sine of half the angle under which the
/// sphere is seen, `cosine` that of the angle between its direction and the plane's normal. [Snyder 1996]
fn cut_sphere(sine2: f32, cosine: f32) -> f32 {
    let sine = sqrt(max(1.0 - cosine * cosine, 1e-12));
    let x = sqrt(1.0 / sine2 - 1.0);
    let y = clamp(-x * cosine / sine, -1.0, 1.0);
    let chord = sine * sqrt(1.0 - y * y);
    return max((cosine * acos(y) - x * chord) * sine2 + atan2(chord, x), 0.0) / PI;
}

/// Irradiance of a Lambertian disc, divided by its flux [1/m²]: on a plane with the unit `normal`, at `offset` [m] from the middle
/// of the disc. `axis` is the disc's unit normal and `radius2` [m²], which is not 0, its radius squared.
fn disc_irradiance(offset: vec3<f32>, axis: vec3<f32>, normal: vec3<f32>, radius2: f32) -> f32 {
    if dot(axis, offset) <= 0.0 {
        return 0.0;
    }
    let towards = disc_vector(offset, axis, radius2);
    let whole = length(towards);
    // The length is the squared sine of half the angle of a sphere that gives as much.
    let sine2 = clamp(whole * PI * radius2, 1e-30, 0.999999);
    let cosine = dot(normal, towards) / whole;
    if cosine * abs(cosine) >= sine2 {
        return cosine * whole;
    }
    if cosine * abs(cosine) <= -sine2 {
        return 0.0;
    }
    let tilt = dot(normal, axis);
    let reach = sqrt(max(radius2 * (1.0 - tilt * tilt), 1e-30));
    return clamp(2.0 * dot(normal, -offset) / reach, 0.0, 1.0) * cut_sphere(sine2, cosine) / (PI * radius2);
}
