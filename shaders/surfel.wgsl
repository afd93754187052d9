// Surfels in the maps of virtual lights: a surfel is the piece of the scene's triangles for which a sample stands.
//
// A file that imports this one imports also the module of a port Points, which gives surface_sample.

#import "light-projection.wgsl"
#import "mask.wgsl"
#import "random.wgsl"
#import "scene.wgsl"
#import "surface-sample.wgsl"
#import "triangle.wgsl"
#import "virtual-lights.wgsl"

/// Radius of the disc of a surfel whose triangle is smaller than the surface that the point stands for, over the square root of that
/// surface's area: beyond the triangle it thickens shadows.
const SMALL_RADIUS: f32 = 0.5;
/// The same of a surfel that ends with its triangle: where it overlaps others, it stores what they store.
const LARGE_RADIUS: f32 = 1.2;

/// What a thread splats.
struct Splat {
    /// The point; its area is 0 where there is none.
    point: SurfaceSample,
    /// The point in the light's frame [m].
    local: vec3<f32>,
    /// The index of the sample, among those of all maps.
    sample: u32,
}

/// Returns the map of the splat of an index among those of all maps: within a block, maps take turns.
fn map_of_splat(samples: SamplesWanted, candidates: u32, index: u32) -> u32 {
    let bits = samples.block_bits;
    let block = (index >> bits) / (samples.per_map / candidates);
    return (block << bits) + (index & ((1u << bits) - 1u));
}

/// Returns the splat of an index among those of a map and all others: one of as many points of its map as there are candidates.
/// (Talbot et al. 2005)
fn chosen(
    samples: SamplesWanted, candidates: u32, index: u32, map: u32, light: VirtualLight, frame: mat3x3<f32>,
) -> Splat {
    // The splats of a map. Points of a map that are this far apart in its order are far apart in the scene.
    let stride = samples.per_map / candidates;
    let bits = samples.block_bits;
    let first = index + ((map >> bits) * (samples.per_map - stride) << bits);
    var splat: Splat;
    var sum = 0.0;
    var share = 1.0;
    for (var i = 0u; i < candidates; i++) {
        let sample = first + (i * stride << bits);
        let point = surface_sample(samples, sample);
        let offset = point.position - light.position;
        let local = offset * frame;
        if point.area <= 0.0 || !above_horizon(local, scene_info.extent) {
            continue;
        }
        // Bounded at the light, and not zero for surfaces that are seen on edge.
        let is_far = light.kind == INFINITELY_FAR;
        let squared = dot(offset, offset);
        let cosine = abs(select(dot(point.normal, offset) * inverseSqrt(squared), dot(point.normal, light.normal), is_far));
        let weight = point.area / select(squared + point.area, 1.0, is_far) * mix(0.1, 1.0, cosine);
        sum += weight;
        if unit_float(hash2(index, i + samples.turn * candidates)) * sum <= weight {
            splat = Splat(point, local, sample);
            share = weight;
        }
    }
    // It stands for all candidates, in the measure by which it was taken.
    splat.point.area *= sum / share;
    return splat;
}

/// A surfel as a light sees it; in the light's frame.
struct Surfel {
    /// Of its triangle, unit.
    normal: vec3<f32>,
    /// Of its plane above the light, along the normal [m].
    height: f32,
    /// The point for which it stands [m].
    local: vec3<f32>,
    /// Of the disc that bounds it [m].
    radius: f32,
    /// The sides of its triangle: see map_homogeneous.
    edges: mat3x3<f32>,
    triangle: u32,
    /// [m²]
    triangle_area: f32,
    /// Whether its triangle is smaller than the surface for which the point stands; then it is the disc.
    is_small: bool,
    /// How far its image reaches along x and y of the map [px].
    reach: vec2<f32>,
}

/// Returns the surfel of a splat in a map of a light with `tile` texels along a side; `scale` is a factor on its radius, and
/// `side` its greatest side [px]. Where points fell into the map before, `share` is that of this frame's in all.
fn surfel_of(
    splat: Splat, light: VirtualLight, frame: mat3x3<f32>, tile: u32, scale: f32, side: f32, share: f32,
) -> Surfel {
    let local = splat.local;
    let area = splat.point.area;
    let distance = map_distance(light.kind, local);
    let centre = map_position(light.kind, local, distance);
    // Texels per metre across the ray.
    let density = 1.0 / map_texel_width(light.kind, local, distance, tile);
    let triangle = triangle_of_scene(splat.point.triangle);
    let corner = (triangle.corner - light.position) * frame;
    let a = map_homogeneous(light.kind, corner);
    let b = map_homogeneous(light.kind, corner + triangle.a * frame);
    let c = map_homogeneous(light.kind, corner + triangle.b * frame);
    var surfel: Surfel;
    surfel.normal = splat.point.normal * frame;
    surfel.height = dot(surfel.normal, local);
    surfel.local = local;
    surfel.triangle_area = normal_and_area(triangle.a, triangle.b).w;
    surfel.is_small = surfel.triangle_area < area * share;
    surfel.radius = scale * sqrt(area) * select(LARGE_RADIUS, SMALL_RADIUS * sqrt(share), surfel.is_small);
    surfel.edges = mat3x3(cross(b, c), cross(c, a), cross(a, b));
    surfel.triangle = splat.point.triangle;
    // In an orthographic map, x and y are the same directions everywhere, as in the middle of a paraboloid one.
    let extent = disc_extent(surfel.normal, select(centre, vec2(0.0), light.kind == INFINITELY_FAR));
    surfel.reach = min(surfel.radius * density * extent, vec2(0.5 * side));
    return surfel;
}

/// Where the ray of a map meets a surfel.
struct SurfelHit {
    /// [m]; negative where it does not.
    distance: f32,
    /// Whether the ray meets its triangle, not only the disc.
    is_of_triangle: bool,
}

/// Returns where the ray of a map meets a surfel.
fn meet_surfel(surfel: Surfel, ray: MapRay) -> SurfelHit {
    let times = (surfel.height - dot(surfel.normal, ray.origin)) / dot(surfel.normal, ray.direction);
    let met = ray.origin + times * ray.direction;
    let off = met - surfel.local;
    let distance = times * ray.length;
    // Rays of texels that only touch the disc point below the horizon.
    if !(distance > 0.0) || dot(off, off) > surfel.radius * surfel.radius || !above_horizon(met, scene_info.extent) {
        return SurfelHit(-1.0, false);
    }
    // On which side of each edge the ray passes: in proportion to the weights of the opposite corners.
    let sides = ray.image * surfel.edges;
    let is_of_triangle = (all(sides >= vec3(0.0)) || all(sides <= vec3(0.0)))
        && triangle_exists(surfel.triangle, sides.yz / (sides.x + sides.y + sides.z));
    return SurfelHit(select(-1.0, distance, surfel.is_small || is_of_triangle), is_of_triangle);
}

/// How far the image of a disc reaches along x and y of the square, over that of a disc across the ray. The map is conformal: x
/// and y follow two directions at right angles, along which the disc is as wide as the sines of the angles to its normal.
fn disc_extent(normal: vec3<f32>, centre: vec2<f32>) -> vec2<f32> {
    let r2 = dot(centre, centre);
    let product = centre.x * centre.y;
    let along_x = vec3(1.0 + r2 - 2.0 * centre.x * centre.x, -2.0 * product, -2.0 * centre.x) / (1.0 + r2);
    let along_y = vec3(-2.0 * product, 1.0 + r2 - 2.0 * centre.y * centre.y, -2.0 * centre.y) / (1.0 + r2);
    let cosines = vec2(dot(normal, along_x), dot(normal, along_y));
    return sqrt(max(1.0 - cosines * cosines, vec2(0.0)));
}

/// The texels of a tile whose centres are in a rectangle.
struct Texels {
    /// Column and row of the first.
    first: vec2<u32>,
    /// Columns and rows.
    size: vec2<u32>,
}

/// Returns the texels within `reach` [px] on either side of a point of the square.
fn texels_about(at: vec2<f32>, reach: vec2<f32>, tile: u32) -> Texels {
    let position = tile_position(at, tile);
    let low = vec2<u32>(max(ceil(position - reach - 0.5), vec2(0.0)));
    let high = vec2<u32>(min(ceil(position + reach - 0.5), vec2(f32(tile))));
    return Texels(low, high - low);
}
