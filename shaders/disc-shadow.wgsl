// Shadows of a light that is a disc in the plane z = 0 of its own frame, by similar triangles. [Fernando 2005, ACRSM Eq. 3.2]
//
// Where what blocks is at the height b, the part of the disc at p is hidden from the receiver r where the light's map has a
// blocker in the direction of r + p (r.z - b) / b. So the kernel of a soft lookup is the disc itself, scaled and moved to the
// receiver. All lengths are in metres.

#import "color.wgsl"
#import "paraboloid-lookup.wgsl"

/// Radius of a light of that area [m²].
fn disc_radius(area: f32) -> f32 {
    return sqrt(max(area, 0.0) / PI);
}

/// Radius around the receiver of the region that blockers are looked for in: as wide as the penumbra of the nearest blockers
/// to the light that are to be found, at the height `nearest` as a share of the receiver's.
fn search_radius(radius: f32, nearest: f32) -> f32 {
    return radius * (1.0 - nearest) / nearest;
}

/// Half the width of the penumbra that blockers cast on a receiver, both at a height above the light's plane. [ACRSM Eq. 3.2]
fn penumbra_radius(radius: f32, receiver: f32, blocker: f32) -> f32 {
    return radius * max(receiver - blocker, 0.0) / blocker;
}
