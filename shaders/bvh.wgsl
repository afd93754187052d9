// Rays by a bounding volume hierarchy that is built on the CPU: what ray-tracing.wgsl promises, on every adapter. No ray
// passes between triangles that share an edge or a vertex.
//
// [Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection"]; the CPU reference is crates/ray-tracing.

/// The boxes of four children, a coordinate of all four in a vector. A child is the index of a node or, with the
/// highest bit set, a run of triangles: three bits for their number less one, the rest for the first. Where there
/// are fewer than four, the boxes of the others are where no ray comes.
struct BvhNode {
    low_x: vec4<f32>,
    low_y: vec4<f32>,
    low_z: vec4<f32>,
    high_x: vec4<f32>,
    high_y: vec4<f32>,
    high_z: vec4<f32>,
    children: vec4<u32>,
}

struct BvhTriangle {
    a: vec3<f32>,
    /// As Hit has it; NO_HIT for one that cannot be hit.
    index: u32,
    b: vec3<f32>,
    pad0: u32,
    c: vec3<f32>,
    pad1: u32,
}

/// The first is the root.
var<storage, read> scene_bvh: array<BvhNode>;
/// In the order of the leaves.
var<storage, read> scene_bvh_triangles: array<BvhTriangle>;

/// Children that can wait. No tree is built that needs more.
const BVH_STACK = 64u;
const BVH_LEAF = 0x80000000u;
const BVH_MISS = 3.40282347e38f;

/// Outside of functions, where it is not zeroed for every ray.
var<private> bvh_stack: array<u32, BVH_STACK>;

/// The closest hit in (nearest, farthest).
fn trace(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> Hit {
    return bvh_search(bvh_ray(origin, direction), nearest, farthest, false);
}

/// Whether anything is hit in (nearest, farthest).
fn occluded(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> bool {
    return bvh_search(bvh_ray(origin, direction), nearest, farthest, true).triangle != NO_HIT;
}

/// What tests of boxes and triangles need of a ray.
struct BvhRay {
    origin: vec3<f32>,
    inverse: vec3<f32>,
    /// Takes a vertex, seen from the origin, to where the ray is the z axis with its direction's length as unit.
    shear: mat3x3<f32>,
}

fn bvh_ray(origin: vec3<f32>, direction: vec3<f32>) -> BvhRay {
    let d = direction;
    let size = abs(d);
    // Directions along an axis: never divided by zero, and off by less than rounding.
    let least = vec3(max(max(size.x, size.y), size.z) * 1e-12);
    let inverse = 1.0 / select(select(-least, least, d >= vec3(0.0)), d, size >= least);
    // [§3] The longest axis becomes z; the other two are sheared.
    var shear = mat3x3(vec3(-d.y, -d.z, 1.0) / d.x, vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0));
    if size.z > size.x && size.z > size.y {
        shear = mat3x3(vec3(1.0, 0.0, 0.0), vec3(0.0, 1.0, 0.0), vec3(-d.x, -d.y, 1.0) / d.z);
    } else if size.y > size.x {
        shear = mat3x3(vec3(0.0, 1.0, 0.0), vec3(-d.z, -d.x, 1.0) / d.y, vec3(1.0, 0.0, 0.0));
    }
    return BvhRay(origin, inverse, shear);
}

/// Depth first, the nearer child first; `stop` takes any hit.
fn bvh_search(ray: BvhRay, nearest: f32, farthest: f32, stop: bool) -> Hit {
    var hit = Hit(farthest, NO_HIT, vec2(0.0));
    var height = 0u;
    var current = 0u;
    loop {
        if current >= BVH_LEAF {
            let first = current & 0x0fffffffu;
            let end = first + ((current >> 28u) & 7u) + 1u;
            for (var i = first; i < end; i++) {
                if bvh_triangle(ray, i, nearest, &hit) && stop {
                    return hit;
                }
            }
        } else {
            let node = scene_bvh[current];
            let near = bvh_sorted(bvh_enter(ray, node, nearest, hit.distance), node.children);
            // The nearest is next; of the others, the farthest waits longest.
            if near.enter.x < BVH_MISS {
                current = near.child.x;
                if near.enter.w < BVH_MISS {
                    bvh_stack[height] = near.child.w;
                    height++;
                }
                if near.enter.z < BVH_MISS {
                    bvh_stack[height] = near.child.z;
                    height++;
                }
                if near.enter.y < BVH_MISS {
                    bvh_stack[height] = near.child.y;
                    height++;
                }
                continue;
            }
        }
        if height == 0u {
            break;
        }
        height--;
        current = bvh_stack[height];
    }
    return hit;
}

/// Where a ray enters each of four boxes, at least `nearest`; BVH_MISS where it does not before `farthest`.
fn bvh_enter(ray: BvhRay, node: BvhNode, nearest: f32, farthest: f32) -> vec4<f32> {
    let low_x = (node.low_x - ray.origin.x) * ray.inverse.x;
    let low_y = (node.low_y - ray.origin.y) * ray.inverse.y;
    let low_z = (node.low_z - ray.origin.z) * ray.inverse.z;
    let high_x = (node.high_x - ray.origin.x) * ray.inverse.x;
    let high_y = (node.high_y - ray.origin.y) * ray.inverse.y;
    let high_z = (node.high_z - ray.origin.z) * ray.inverse.z;
    let first = max(max(min(low_x, high_x), min(low_y, high_y)), min(low_z, high_z));
    let last = min(min(max(low_x, high_x), max(low_y, high_y)), max(low_z, high_z));
    let enter = max(first, vec4(nearest));
    // Above the rounding of the distances [Ize 2013].
    let exit = min(last * (1.0 + 1e-6), vec4(farthest));
    return select(vec4(BVH_MISS), enter, enter <= exit);
}

/// Four children by where a ray enters them.
struct BvhChildren {
    enter: vec4<f32>,
    child: vec4<u32>,
}

/// The nearest first.
fn bvh_sorted(enter: vec4<f32>, child: vec4<u32>) -> BvhChildren {
    // Within both halves; the nearer of both and the farther of both; the two between.
    let turn = enter.xz > enter.yw;
    let near = min(enter.xz, enter.yw);
    let far = max(enter.xz, enter.yw);
    let near_child = select(child.xz, child.yw, turn);
    let far_child = select(child.yw, child.xz, turn);
    let turn_near = near.x > near.y;
    let turn_far = far.x > far.y;
    let second = max(near.x, near.y);
    let third = min(far.x, far.y);
    let second_child = select(near_child.y, near_child.x, turn_near);
    let third_child = select(far_child.x, far_child.y, turn_far);
    let turn_middle = second > third;
    return BvhChildren(
        vec4(min(near.x, near.y), min(second, third), max(second, third), max(far.x, far.y)),
        vec4(
            select(near_child.x, near_child.y, turn_near),
            select(second_child, third_child, turn_middle),
            select(third_child, second_child, turn_middle),
            select(far_child.y, far_child.x, turn_far),
        ),
    );
}

/// Takes the hit of a triangle where it is closer.
fn bvh_triangle(ray: BvhRay, i: u32, nearest: f32, hit: ptr<function, Hit>) -> bool {
    let triangle = scene_bvh_triangles[i];
    let a = ray.shear * (triangle.a - ray.origin);
    let b = ray.shear * (triangle.b - ray.origin);
    let c = ray.shear * (triangle.c - ray.origin);
    let weights = vec3(bvh_side(c.xy, b.xy), bvh_side(a.xy, c.xy), bvh_side(b.xy, a.xy));
    let sum = weights.x + weights.y + weights.z;
    let outside = any(weights < vec3(0.0)) && any(weights > vec3(0.0));
    if outside || sum == 0.0 || triangle.index == NO_HIT {
        return false;
    }
    let barycentrics = weights / sum;
    let distance = dot(barycentrics, vec3(a.z, b.z, c.z));
    if !(distance > nearest && distance < (*hit).distance) {
        return false;
    }
#if MASKED
    if !hit_exists(triangle.index, barycentrics.yz) {
        return false;
    }
#endif
    *hit = Hit(distance, triangle.index, barycentrics.yz);
    return true;
}

/// On which side of the edge from `a` to `b` the ray passes. Both triangles of an edge compute it from the same end,
/// so that they agree however a compiler fuses the products.
fn bvh_side(a: vec2<f32>, b: vec2<f32>) -> f32 {
    let swap = a.x > b.x || (a.x == b.x && a.y > b.y);
    let p = select(a, b, swap);
    let q = select(b, a, swap);
    let side = p.x * q.y - p.y * q.x;
    return select(side, -side, swap);
}
