// Renders one exact paraboloid depth map per virtual light: the baseline. [ISM §5]
//
// This file rasterises every triangle into every map; trace.wgsl traces a ray for each texel instead, which takes less time
// where triangles are many. Both find the same distances.
//
// Projecting vertices and filling straight edges is wrong for triangles that span many texels: edges are arcs (Brabec et al.
// 2002). Here the vertex stage covers a triangle's image with a right-angled triangle twice the size of its bounding box,
// and the fragment stage meets each texel's ray with the triangle itself. Where maps are kept, list-moved.wgsl lists those
// whose lights moved, and clear.wgsl clears them first.
//
// visibility.atlas: r32float, the distance [m] along the ray through the centre of each texel; NOTHING where nothing is.
//
// Distances are those of the centres of texels, so a plane needs no depth bias; there is one for surfaces that bend within a
// texel, and for shading normals, which are not those of the triangles.

#input lights: VirtualLights // The lights: one map each, over the hemisphere around its normal.
#input past: Visibility optional // The maps of the frame before, which are kept where a light stays: `prev` of the output
    // `visibility`, reset by `Scene`, `Reload`, `Setting` and `Moved`.
#input rendered: Stands optional // `prev` of the output `stands`, reset by the same; needed with `past`.
#output visibility: Visibility(
    size: (atlas_width, atlas_height),
    layers: atlas_layers,
    tile: settings.map,
    columns: atlas_columns,
    rows: atlas_rows,
    depth_bias: 0.2 * settings.depth_bias,
    slope_bias: 0.0,
) continues past module "visibility-atlas.wgsl" // The maps.
#output stands: Stands(count: lights.count) cleared // Where the lights stand whose maps these are; zero where maps are not
    // kept.
#exact maps: pass visibility-ray-traced // A ray for each light and pixel.

#option MASKED false // whether triangles do not count where alpha is below their material's cutoff
#option PAST false // whether maps are kept, and only those that are listed are rendered

#import "light-projection.wgsl"
#import "mask.wgsl"
#import "scene.wgsl"
#import "virtual-lights.wgsl"

struct Settings {
    /// Side of a map (ISM compares with 256). Larger: sharper shadows, but more time. [default: 64, min: 1, max: 8192, unit:
    /// "px"]
    map: u32,
    /// Factor on the bias of the depth test that these maps need. Surfaces shadow themselves less and light leaks more with
    /// it. [default: 1.0, min: 0.0]
    depth_bias: f32,
    /// How maps are rendered; the distances are the same but for rounding. rasterised: every triangle into every map. traced: a
    /// ray for each texel. auto: the faster of both, by the number of triangles for each texel of a map. [default: "auto",
    /// one_of: ["auto", "rasterised", "traced"]]
    method: u32,
    visibility_size: vec2<u32>,
    visibility_columns: u32,
    visibility_rows: u32,
#if PAST
    layer: u32,
#else
    /// The first map of the layer.
    first_map: u32,
#endif
}

var<uniform> settings: Settings;
var<storage, read> lights: VirtualLights;
#if PAST
/// The maps to render, by index, and where those of each layer begin.
var<storage, read> moved: array<u32>;
var<storage, read> begins: array<u32>;
#endif

struct Cover {
    @builtin(position) position: vec4<f32>,
    /// The triangle in the light's frame [m].
    @location(0) @interpolate(flat) a: vec3<f32>,
    @location(1) @interpolate(flat) b: vec3<f32>,
    @location(2) @interpolate(flat) c: vec3<f32>,
    /// First texel of the light's tile.
    @location(3) @interpolate(flat) origin: vec2<u32>,
    /// That of the light.
    @location(5) @interpolate(flat) kind: u32,
#if MASKED
    @location(4) @interpolate(flat) triangle: u32,
#endif
}

/// A box in the square [-1, 1]².
struct Box {
    low: vec2<f32>,
    high: vec2<f32>,
}

/// A box that contains another and the image of the segment between two points above or on the light's plane.
///
/// The segment's directions are on a great circle with the normal n; its image is an arc of a circle of radius
/// |n| / |n.z|. Within the disc an arc is at most half of its circle, so it leaves its chord by no more than
/// its sagitta.
fn grown(box: Box, p: vec3<f32>, q: vec3<f32>) -> Box {
    let p_length = length(p);
    let q_length = length(q);
    // The light is on the triangle, which may be seen in any direction.
    if min(p_length, q_length) <= 1e-6 * scene_info.extent {
        return Box(vec2(-1.0), vec2(1.0));
    }
    let n = cross(p / p_length, q / q_length);
    let n_length = length(n);
    let curvature = select(abs(n.z) / n_length, 1.0, n_length < 1e-6);
    let start = paraboloid_from_direction(p / p_length);
    let end = paraboloid_from_direction(q / q_length);
    let half_chord2 = 0.25 * dot(end - start, end - start);
    let sagitta = half_chord2 * curvature / (1.0 + sqrt(max(1.0 - half_chord2 * curvature * curvature, 0.0)));
    return Box(min(box.low, min(start, end) - sagitta), max(box.high, max(start, end) + sagitta));
}

/// The point where the segment between points on different sides of the light's plane meets it.
fn at_horizon(p: vec3<f32>, q: vec3<f32>) -> vec3<f32> {
    return vec3(mix(p.xy, q.xy, p.z / (p.z - q.z)), 0.0);
}

/// Bounds of the image of the part of a triangle above the light's plane, which is not empty.
fn image_bounds(a: vec3<f32>, b: vec3<f32>, c: vec3<f32>) -> Box {
    var box = Box(vec2(1.0), vec2(-1.0));
    var corners = array(a, b, c);
    var crossings: array<vec3<f32>, 2>;
    var crossed = 0u;
    for (var i = 0u; i < 3u; i++) {
        var p = corners[i];
        var q = corners[(i + 1u) % 3u];
        if (p.z < 0.0) != (q.z < 0.0) {
            let crossing = at_horizon(p, q);
            crossings[crossed & 1u] = crossing;
            crossed++;
            if p.z < 0.0 {
                p = crossing;
            } else {
                q = crossing;
            }
        } else if p.z < 0.0 {
            continue;
        }
        box = grown(box, p, q);
    }
    if crossed == 2u {
        box = grown(box, crossings[0], crossings[1]);
    }
    return box;
}

/// Three vertices per triangle, one instance per light of the layer.
@vertex
fn cover(@builtin(vertex_index) vertex: u32, @builtin(instance_index) map: u32) -> Cover {
    // All positions zero: no fragment.
    var out: Cover;
#if PAST
    let light = moved[begins[settings.layer] + map];
#else
    let light = settings.first_map + map;
#endif
    if light >= lights.count || all(lights.lights[light].flux == vec3(0.0)) {
        return out;
    }
    let first = vertex / 3u * 3u;
    let position = lights.lights[light].position;
    let frame = frame_from_normal(lights.lights[light].normal);
    let a = (scene_vertices[scene_indices[first]].position - position) * frame;
    let b = (scene_vertices[scene_indices[first + 1u]].position - position) * frame;
    let c = (scene_vertices[scene_indices[first + 2u]].position - position) * frame;
    if max(max(a.z, b.z), c.z) <= 1e-6 * scene_info.extent {
        return out;
    }
    let kind = lights.lights[light].kind;
    var box: Box;
    if kind == INFINITELY_FAR {
        let low = min(min(a.xy, b.xy), c.xy);
        let high = max(max(a.xy, b.xy), c.xy);
        box = Box(map_position(kind, vec3(low, 0.0), 0.0), map_position(kind, vec3(high, 0.0), 0.0));
    } else {
        box = image_bounds(a, b, c);
    }
    // The texels whose centres are inside; a hundredth of a texel covers rounding.
    let tile = settings.map;
    let low = max(ceil(tile_position(box.low, tile) - 0.51), vec2(0.0));
    let high = min(floor(tile_position(box.high, tile) + 0.51), vec2(f32(tile)));
    if any(low >= high) {
        return out;
    }
    let corner = vec2<f32>(vec2(vertex % 3u) == vec2(1u, 2u));
    let origin = tile_origin(light, settings.visibility_columns, settings.visibility_rows, tile).xy;
    let at = vec2<f32>(origin) + low + corner * 2.0 * (high - low);
    let ndc = vec2(2.0, -2.0) * at / vec2<f32>(settings.visibility_size) + vec2(-1.0, 1.0);
#if MASKED
    return Cover(vec4(ndc, 0.0, 1.0), a, b, c, origin, kind, vertex / 3u);
#else
    return Cover(vec4(ndc, 0.0, 1.0), a, b, c, origin, kind);
#endif
}

struct Hit {
    @location(0) visibility_atlas: f32,
    /// Nearer is greater.
    @builtin(frag_depth) nearness: f32,
}

@fragment
fn hit(in: Cover) -> Hit {
    let tile = settings.map;
    // Left of and above the tile, this wraps to large numbers.
    let texel = vec2<u32>(in.position.xy) - in.origin;
    if any(texel >= vec2(tile)) {
        discard;
    }
    let ray = map_ray(in.kind, texel_centre(texel, tile));
    // On which side of each edge the ray passes. Triangles that share an edge get opposite numbers there, so no
    // ray slips between them.
    let a = map_homogeneous(in.kind, in.a);
    let b = map_homogeneous(in.kind, in.b);
    let c = map_homogeneous(in.kind, in.c);
    let sides = vec3(dot(ray.image, cross(b, c)), dot(ray.image, cross(c, a)), dot(ray.image, cross(a, b)));
    let normal = cross(in.b - in.a, in.c - in.a);
    let along = dot(normal, ray.direction);
    if !(all(sides >= vec3(0.0)) || all(sides <= vec3(0.0))) || along == 0.0 {
        discard;
    }
    let times = dot(normal, in.a - ray.origin) / along;
    let distance = times * ray.length;
    // Rays of texels that only touch the disc point below the horizon, and may meet the triangle backwards.
    if !(distance > 0.0 && distance < NOTHING) || !above_horizon(ray.origin + times * ray.direction, scene_info.extent) {
        discard;
    }
#if MASKED
    // The numbers of the edges are in proportion to the weights of the vertices on the other side.
    if !triangle_exists(in.triangle, sides.yz / (sides.x + sides.y + sides.z)) {
        discard;
    }
#endif
    return Hit(distance, scene_info.extent / (scene_info.extent + distance));
}
