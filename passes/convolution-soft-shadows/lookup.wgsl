// Visibility of discs by basis images of shadow maps: sums of prefiltered images are the share of a region of a map that is
// in front of a receiver, and the mean depth of that share. [Annen et al. 2007 and 2008; ACRSM §3.1.2, §3.2.5, Eq. 3.2-3.5]
//
// Depths z are heights above the light's plane, as a share of the map's greatest. What is not in front of the depth d has
// the share f(d, z) = 1/2 + 2 Σ a_k / c_k sin(c_k (z - d)), c_k = π (2k - 1), where a_k attenuate high orders.

#import "atlas-lookup.wgsl"
#import "basis.wgsl"
#import "disc-shadow.wgsl"

struct VisibilityFacts {
    atlas: AtlasFacts,
    /// Searches for blockers, each in a region that follows from the one before.
    search: u32,
    /// Least height of a blocker above the light's plane, as a share of the receiver's.
    nearest: f32,
    /// Orders of the expansion.
    order: u32,
    /// Levels above the maps.
    levels: u32,
    /// The attenuation of high orders.
    attenuation: f32,
    /// The bias of the comparison towards the light, in depths of 1 / order.
    offset: f32,
    /// Words of a map in the buffer of basis images.
    stride: u32,
}

var<uniform> visibility_facts: VisibilityFacts;
var<storage, read> visibility_basis: array<u32>;

/// The share of a region that blocks below which it counts as none: more than the expansion rings.
const LEAST_BLOCKED: f32 = 0.03;

/// The part of a map that stands for a disc beside a receiver.
struct DiscImage {
    /// Centre in the map [px].
    centre: vec2<f32>,
    radius: f32,
}

/// The image of the disc about the receiver, parallel to the light, in front of the receiver's plane.
fn disc_image(receiver: vec3<f32>, plane_normal: vec3<f32>, radius: f32) -> DiscImage {
    let facts = visibility_facts;
    var middle = receiver;
    var kept = radius;
    // DEVIATION(front): behind the receiver's plane the map holds that plane, lower than the receiver. So the disc is cut
    // where the plane is lower by half of what the comparison leaves free, and what is left is replaced by the disc within.
    let slope = length(plane_normal.xy);
    let height = max(-dot(plane_normal, receiver), 0.0);
    let free = 0.5 * facts.offset / f32(facts.order) * height;
    if slope * radius > free {
        let behind = free / slope;
        middle += vec3(plane_normal.xy / slope * (0.5 * (radius - behind)), 0.0);
        kept = 0.5 * (radius + behind);
    }
    // Along the way from the middle of the map, and across it.
    let along = length(middle.xy);
    let direction = select(vec2(1.0, 0.0), middle.xy / along, along > 0.0);
    let ends = along + vec2(-kept, kept);
    let images = ends / (sqrt(ends * ends + middle.z * middle.z) + middle.z);
    let across = kept / (sqrt(dot(middle, middle) + kept * kept) + middle.z);
    let extent = sqrt(0.5 * (images.y - images.x) * across);
    let centre = tile_position(direction * (0.5 * (images.x + images.y)), facts.atlas.tile);
    return DiscImage(centre, 0.5 * f32(facts.atlas.tile) * extent);
}

/// The level whose texels, interpolated, spread as a disc of that radius [px] does.
fn level_of(radius: f32) -> f32 {
    return clamp(log2(max(radius, 1.0)), 0.0, f32(visibility_facts.levels));
}

/// Comparison with a depth d: a_k / c_k (cos(c_k d), -sin(c_k d)) for each order.
struct Comparison {
    terms: array<vec2<f32>, ORDERS>,
}

fn comparison(depth: f32) -> Comparison {
    let facts = visibility_facts;
    var all: Comparison;
    let step = turned(first_order(depth), first_order(depth));
    var turn = first_order(depth);
    for (var k = 0u; k < facts.order; k++) {
        let odd = f32(2u * k + 1u);
        let share = odd / f32(2u * facts.order);
        // [Annen et al. 2007 §4.2]
        all.terms[k] = exp(-facts.attenuation * share * share) / (PI * odd) * vec2(turn.x, -turn.y);
        turn = turned(turn, step);
    }
    return all;
}

/// f(d, z) for one depth z.
fn seen_at_depth(compared: Comparison, depth: f32) -> f32 {
    var sum = 0.5;
    let step = turned(first_order(depth), first_order(depth));
    var turn = first_order(depth);
    for (var k = 0u; k < visibility_facts.order; k++) {
        sum += 2.0 * dot(compared.terms[k], turn.yx);
        turn = turned(turn, step);
    }
    return sum;
}

/// Four texels of a level and their weights.
struct Corners {
    first: vec4<u32>,
    weights: vec4<f32>,
}

/// The texels around a position in a map [px]. None is of another map: those beyond the edge are the nearest at the edge.
fn corners(map: u32, level: u32, position: vec2<f32>) -> Corners {
    let facts = visibility_facts;
    let side = level_side(facts.atlas.tile, level);
    let at = position / f32(1u << level) - 0.5;
    let low = floor(at);
    let weight = at - low;
    let last = vec2(f32(side - 1u));
    let x = vec2(u32(clamp(low.x, 0.0, last.x)), u32(clamp(low.x + 1.0, 0.0, last.x)));
    let y = vec2(u32(clamp(low.y, 0.0, last.y)), u32(clamp(low.y + 1.0, 0.0, last.y)));
    let begin = map * facts.stride + level_begin(facts.atlas.tile, level, facts.order);
    let texels = vec4(y.x * side + x, y.y * side + x);
    let rows = vec2(1.0 - weight.x, weight.x);
    return Corners(begin + texels * texel_words(facts.order), vec4((1.0 - weight.y) * rows, weight.y * rows));
}

/// A pair of terms, interpolated between the texels.
fn interpolated(corners: Corners, word: u32) -> vec2<f32> {
    return corners.weights[0] * unpack2x16snorm(visibility_basis[corners.first[0] + word])
        + corners.weights[1] * unpack2x16snorm(visibility_basis[corners.first[1] + word])
        + corners.weights[2] * unpack2x16snorm(visibility_basis[corners.first[2] + word])
        + corners.weights[3] * unpack2x16snorm(visibility_basis[corners.first[3] + word]);
}

/// The mean of f(d, z) over a region of a map. [ACRSM Eq. 3.4]
fn seen_share(compared: Comparison, corners: Corners) -> f32 {
    var sum = 0.5;
    for (var k = 0u; k < visibility_facts.order; k++) {
        sum += 2.0 * dot(compared.terms[k], interpolated(corners, k));
    }
    return sum;
}

/// The blockers in a region of a map.
struct Blockers {
    /// The share of the region.
    share: f32,
    /// Mean depth of that share.
    depth: f32,
}

/// The means of 1 - f(d, z), and of z over that share. [ACRSM §3.2.5, after Annen et al. 2008]
fn find_blockers(compared: Comparison, corners: Corners) -> Blockers {
    let order = visibility_facts.order;
    var sum = 0.0;
    for (var i = 0u; i < 4u; i++) {
        sum += 0.5 * corners.weights[i] * bitcast<f32>(visibility_basis[corners.first[i] + 2u * order]);
    }
    for (var k = 0u; k < order; k++) {
        sum -= 2.0 * dot(compared.terms[k], interpolated(corners, order + k));
    }
    let share = 1.0 - seen_share(compared, corners);
    return Blockers(share, sum / max(share, LEAST_BLOCKED));
}

/// The four nearest texels of the map itself, weighted after the depth test.
fn seen_nearby(lookup: ParaboloidLookup, origin: vec3<u32>) -> f32 {
    let tile = visibility_facts.atlas.tile;
    let corner = floor(lookup.position - 0.5);
    let weight = lookup.position - 0.5 - corner;
    var sum = 0.0;
    for (var i = 0u; i < 4u; i++) {
        let beside = vec2(f32(i % 2u), f32(i / 2u));
        let texel = texel_in_map(corner + beside, tile);
        let stored = stored_in_atlas(origin, texel);
        let shares = mix(1.0 - weight, weight, beside);
        sum += select(0.0, shares.x * shares.y, is_seen(lookup, texel, tile, stored));
    }
    return sum;
}

fn visibility_by_map(index: u32, light: VirtualLight, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    let facts = visibility_facts;
    let frame = frame_from_normal(light.normal);
    let receiver = (at - light.position) * frame;
    if receiver.z <= 0.0 {
        return 0.0;
    }
    let plane_normal = normal * frame;
    let lookup = atlas_lookup(light, at, normal);
    let radius = disc_radius(light.area);
    if radius == 0.0 {
        return seen_once(lookup, index);
    }
    // DEVIATION(finest): the finest level is the map itself, compared without an expansion.
    let exact = seen_nearby(lookup, origin_in_atlas(index));
    let far = bitcast<f32>(visibility_basis[index * facts.stride]);
    let greatest = greatest_depth(facts.order, facts.offset);
    // What is higher than all that the map holds has no depth.
    if facts.levels == 0u || receiver.z * greatest > far {
        return exact;
    }

    let depth = depth_of_height(receiver.z, far, greatest);
    let compared = comparison(max(depth - facts.offset / f32(facts.order), 0.0));
    // DEVIATION(searches): each region is as wide as the penumbra of what the one before held, so that walls beside the
    // receiver, which hide nothing of the light, leave it.
    var reach = search_radius(radius, facts.nearest);
    var blockers = Blockers(0.0, 0.0);
    for (var i = 0u; i < facts.search; i++) {
        let region = disc_image(receiver, plane_normal, reach);
        let level = u32(clamp(round(level_of(region.radius)), 1.0, f32(facts.levels)));
        blockers = find_blockers(compared, corners(index, level, region.centre));
        if blockers.share < LEAST_BLOCKED {
            return exact;
        }
        let height = blockers.depth * far / greatest;
        reach = penumbra_radius(radius, receiver.z, clamp(height, facts.nearest * receiver.z, receiver.z));
    }

    let kernel = disc_image(receiver, plane_normal, reach);
    let level = level_of(kernel.radius);
    if level == 0.0 {
        return exact;
    }
    let coarse = u32(ceil(level));
    // DEVIATION(contrast): blockers near the receiver are not wholly in front of what it is compared with.
    let lit = seen_at_depth(compared, depth);
    let dark = seen_at_depth(compared, min(blockers.depth, depth));
    let contrast = 1.0 / max(lit - dark, LEAST_BLOCKED);
    let seen = clamp((seen_share(compared, corners(index, coarse, kernel.centre)) - dark) * contrast, 0.0, 1.0);
    var finer = exact;
    if coarse > 1u {
        finer = clamp((seen_share(compared, corners(index, coarse - 1u, kernel.centre)) - dark) * contrast, 0.0, 1.0);
    }
    return mix(finer, seen, level - f32(coarse - 1u));
}
