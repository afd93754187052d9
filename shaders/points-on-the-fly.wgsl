// On-the-fly points, generated where they are read from the triangles as they are in this frame (TCAS §5.2): only each
// triangle's share of the points is stored.
//
// Samples follow the cumulated shares, and so the triangles in their order, as those of a tessellator do; each triangle has its
// share of them, rounded up or down. Along the other side of the square, a map's samples follow van der Corput's sequence,
// scrambled differently for each map: with the first coordinate, Hammersley's points.

#import "amplification.wgsl"
#import "mask.wgsl"
#import "random.wgsl"
#import "samples-in-turn.wgsl"
#import "scene.wgsl"
#import "sobol.wgsl"
#import "surface-sample.wgsl"
#import "triangle-samples.wgsl"
#import "triangle.wgsl"

struct PointsFacts {
    /// The seed of the pass that generates the samples.
    seed: u32,
}

var<uniform> points_facts: PointsFacts;
var<storage, read> points: Amplification;

/// Returns how many points the triangles before one have.
fn interval_start(triangle: u32) -> u32 {
    return points.starts[triangle];
}

/// Returns the number of samples to generate for all maps together: the triangles' sum, or ANY_NUMBER.
fn samples_requested() -> u32 {
    return points.requested;
}

/// Sample `index` of those of all maps. Neighbours are near each other, and belong to different maps.
fn surface_sample(wanted: SamplesWanted, index: u32) -> SurfaceSample {
    let place = place_of_sample(wanted, index, points.requested, points.step);
    if !place.exists {
        return SurfaceSample();
    }
    let number = place.number;
    // Between two entries of the guide table there are few triangles, mostly one or two.
    let guide = scene_info.triangles + 1u + (number >> (31u - points.guide_bits));
    let triangle = triangle_at(number, points.starts[guide], points.starts[guide + 1u]);
    let start = points.starts[triangle];
    let width = points.starts[triangle + 1u] - start;
    let second = scramble(reverseBits(place.stratum), hash2(points_facts.seed, place.map + wanted.turn * wanted.maps));
    let at = triangle_from_square(vec2(min((f32(number - start) + 0.5) / f32(width), 1.0), unit_float(second)));

    let edges = triangle_of_scene(triangle);
    let shape = normal_and_area(edges.a, edges.b);
    let position = edges.corner + at.x * edges.a + at.y * edges.b;
    // The step in intervals is that between two samples of any map.
    let share = place.step / f32(width);
    let area = select(0.0, shape.w * share * f32(wanted.maps), triangle_exists(triangle, at));
    return SurfaceSample(position, place.map, shape.xyz, area, triangle, 0u, 0u, 0u);
}
