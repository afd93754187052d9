// Rays by a bounding volume hierarchy that is built on the CPU: what ray-tracing.wgsl promises, on every adapter. No ray
// passes between triangles that share an edge or a vertex.
//
// [Woop, Benthin, Wald 2013, "Watertight ray/triangle intersection"]; the CPU reference is crates/ray-tracing.

/// A node or a triangle, so that a step of a ray has the same three loads for either. Bytes of a word begin with the
/// lowest.
struct BvhItem {
    /// In a node: the origin of its boxes, and a byte for each axis with the exponent of their unit, as floats have it.
    /// In a triangle: its first vertex, and its index as Hit has it; NO_HIT for one that cannot be hit.
    a: vec4<u32>,
    /// In a node: low x, low y, low z and high x of its boxes, a byte for each of four children. In a triangle: its
    /// second vertex.
    b: vec4<u32>,
    /// In a node: high y and high z; the index of the first child, which the others follow; and the kind of each child
    /// in a byte: the number of its items, which is 0 for none, and the highest bits of what stands for it (see
    /// BVH_TRIANGLE). Of a triangle: its third vertex.
    c: vec4<u32>,
}

/// The first is the root.
var<storage, read> scene_bvh: array<BvhItem>;

/// Children that can wait. No tree is built that needs more.
const BVH_STACK = 64u;
/// A child is the index of an item. This bit is set where that is a triangle; the next three have the number of
/// triangles that follow.
const BVH_TRIANGLE = 0x80000000u;
const BVH_FOLLOWING = 0x70000000u;
const BVH_INDEX = 0x0fffffffu;
const BVH_MISS = 3.40282347e38f;

/// Children that wait, and where the ray enters their boxes. Outside of functions, where they are not zeroed for every
/// ray; two arrays, since one of vectors is far slower on lavapipe.
var<private> bvh_stack: array<u32, BVH_STACK>;
var<private> bvh_stack_enter: array<f32, BVH_STACK>;

/// The closest hit in (nearest, farthest).
fn trace(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> Hit {
    return bvh_search(bvh_ray(origin, direction), nearest, farthest, false);
}

/// Whether anything is hit in (nearest, farthest).
fn occluded(origin: vec3<f32>, direction: vec3<f32>, nearest: f32, farthest: f32) -> bool {
    return bvh_search(bvh_ray(origin, direction), nearest, farthest, true).triangle != NO_HIT;
}

/// A ray, prepared for tests of boxes and triangles.
struct BvhRay {
    origin: vec3<f32>,
    inverse: vec3<f32>,
    /// Takes a vertex, seen from the origin, to where the ray is the z axis with its direction's length as unit.
    shear: mat3x3<f32>,
}

/// Prepares a ray from `origin` [m] for traversal; `direction` has any length but 0.
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

/// Depth first, the nearer child first, a node or a triangle in each step; `stop` takes any hit.
fn bvh_search(ray: BvhRay, nearest: f32, farthest: f32, stop: bool) -> Hit {
    var hit = Hit(farthest, NO_HIT, vec2(0.0));
    var height = 0u;
    var current = 0u;
    loop {
        let item = scene_bvh[current & BVH_INDEX];
        var ended = true;
        if current >= BVH_TRIANGLE {
            if bvh_triangle(ray, item, nearest, &hit) && stop {
                return hit;
            }
            ended = (current & BVH_FOLLOWING) == 0u;
            // One item on, of which one fewer follow.
            current -= BVH_INDEX;
        } else {
            let near = bvh_sorted(bvh_enter(ray, item, nearest, hit.distance), bvh_children(item));
            // The nearest is next; of the others, the farthest waits longest.
            if near.enter.x < BVH_MISS {
                ended = false;
                current = near.child.x;
                if near.enter.w < BVH_MISS {
                    bvh_stack[height] = near.child.w;
                    bvh_stack_enter[height] = near.enter.w;
                    height++;
                }
                if near.enter.z < BVH_MISS {
                    bvh_stack[height] = near.child.z;
                    bvh_stack_enter[height] = near.enter.z;
                    height++;
                }
                if near.enter.y < BVH_MISS {
                    bvh_stack[height] = near.child.y;
                    bvh_stack_enter[height] = near.enter.y;
                    height++;
                }
            }
        }
        // A box beyond a hit that was found since it was pushed is left out.
        while ended && height > 0u {
            height--;
            current = bvh_stack[height];
            ended = bvh_stack_enter[height] >= hit.distance;
        }
        if ended {
            break;
        }
    }
    return hit;
}

/// The four bytes of a word, each in the lowest bits.
fn bvh_bytes(word: u32) -> vec4<u32> {
    return (vec4(word) >> vec4(0u, 8u, 16u, 24u)) & vec4(0xffu);
}

/// The same as floats. Signed integers are converted faster by CPUs.
fn bvh_floats(word: u32) -> vec4<f32> {
    return vec4<f32>(vec4<i32>(bvh_bytes(word)));
}

/// Returns the distance at which a ray enters the boxes of each of four children, at least `nearest`; BVH_MISS where it does not before
/// `farthest`.
fn bvh_enter(ray: BvhRay, node: BvhItem, nearest: f32, farthest: f32) -> vec4<f32> {
    let start = (bitcast<vec3<f32>>(node.a.xyz) - ray.origin) * ray.inverse;
    let step = bitcast<vec3<f32>>(bvh_bytes(node.a.w).xyz << vec3(23u)) * ray.inverse;
    let low = node.b.xyz;
    let high = vec3(node.b.w, node.c.xy);
    let near = select(low, high, ray.inverse < vec3(0.0));
    let far = select(high, low, ray.inverse < vec3(0.0));
    let near_x = bvh_floats(near.x) * step.x + start.x;
    let near_y = bvh_floats(near.y) * step.y + start.y;
    let near_z = bvh_floats(near.z) * step.z + start.z;
    let far_x = bvh_floats(far.x) * step.x + start.x;
    let far_y = bvh_floats(far.y) * step.y + start.y;
    let far_z = bvh_floats(far.z) * step.z + start.z;
    let enter = max(max(near_x, near_y), max(near_z, vec4(nearest)));
    // Above the rounding of the distances [Ize 2013].
    let exit = min(min(min(far_x, far_y), far_z) * (1.0 + 1e-6), vec4(farthest));
    return select(vec4(BVH_MISS), enter, (enter <= exit) & (bvh_bytes(node.c.w) != vec4(0u)));
}

/// The four children, whose items follow each other; no more than a number where there is none.
fn bvh_children(node: BvhItem) -> vec4<u32> {
    // Each byte the sum of those below.
    let before = (node.c.w & 0x0f0f0f0fu) * 0x01010100u;
    let flags = (vec4(node.c.w) << vec4(24u, 16u, 8u, 0u)) & vec4(BVH_TRIANGLE | BVH_FOLLOWING);
    return flags | (vec4(node.c.z) + bvh_bytes(before));
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
fn bvh_triangle(ray: BvhRay, triangle: BvhItem, nearest: f32, hit: ptr<function, Hit>) -> bool {
    let a = ray.shear * (bitcast<vec3<f32>>(triangle.a.xyz) - ray.origin);
    let b = ray.shear * (bitcast<vec3<f32>>(triangle.b.xyz) - ray.origin);
    let c = ray.shear * (bitcast<vec3<f32>>(triangle.c.xyz) - ray.origin);
    let index = triangle.a.w;
    let weights = vec3(bvh_side(c.xy, b.xy), bvh_side(a.xy, c.xy), bvh_side(b.xy, a.xy));
    let sum = weights.x + weights.y + weights.z;
    let outside = any(weights < vec3(0.0)) && any(weights > vec3(0.0));
    if outside || sum == 0.0 || index == NO_HIT {
        return false;
    }
    let barycentrics = weights / sum;
    let distance = dot(barycentrics, vec3(a.z, b.z, c.z));
    if !(distance > nearest && distance < (*hit).distance) {
        return false;
    }
    if !triangle_exists(index, barycentrics.yz) {
        return false;
    }
    *hit = Hit(distance, index, barycentrics.yz);
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
