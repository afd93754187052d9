// Points that are stored in the order of their triangles, of which maps take one in turn (ACRSM §5.3.2).

#import "lattice-points.wgsl"
#import "random.wgsl"
#import "samples-in-turn.wgsl"
#import "surface-sample.wgsl"

var<storage, read> points: LatticePoints;

/// Returns the number of samples to generate for all maps together.
fn samples_requested() -> u32 {
    return points.requested;
}

/// Sample `index` of those of all maps. Neighbours are near each other, and belong to different maps.
fn surface_sample(wanted: SamplesWanted, index: u32) -> SurfaceSample {
    let place = place_of_sample(wanted, index, points.requested, points.step);
    if !place.exists {
        return SurfaceSample();
    }
    let point = points.points[multiply_high(place.number << 1u, points.stored)];
    // A map has so many times fewer samples than there are points.
    let area = point.area * f32(points.stored) * place.step * exp2(-31.0) * f32(wanted.maps);
    return SurfaceSample(point.position, place.map, point.normal, area, point.triangle, 0u, 0u, 0u);
}
