// Choice of a light by its share of the light at a point, down a tree of lights: for passes with a port `tree`.
// [Lin & Yuksel 2020, §4; Conty Estevez & Kulla 2018, §5]

#import "color.wgsl"
#import "light-nodes.wgsl"
#import "random.wgsl"

var<storage, read> tree: LightTree;

/// A light that was chosen.
struct LightChoice {
    /// NO_LIGHT where no light shines on the point.
    index: u32,
    /// The probability of this choice; 0 where there is none.
    probability: f32,
}

/// What is added to the cosines of a node, so that no light whose cosine is just above 0 is lost to rounding.
const LEAST_COSINE: f32 = 1e-3;

/// Cosine of an angle less another, from their cosines; 1 where the other is greater.
fn cosine_of_difference(cosine: f32, less: f32) -> f32 {
    if cosine >= less {
        return 1.0;
    }
    return cosine * less + sqrt(max((1.0 - cosine * cosine) * (1.0 - less * less), 0.0));
}

/// What is added to the estimate for a node: in x of the flux of its lights on surfaces [1/m²], in y of the irradiance by those
/// infinitely far. With numbers above 0, lights that give nothing to a point are chosen too.
var<private> light_floor: vec2<f32>;

/// Estimate of the irradiance at a point by the lights of a node, without shadows [W/m²], and the floor. It is above 0 wherever one of
/// them gives light to the point, which has that unit normal.
fn light_importance(node: LightNode, at: vec3<f32>, normal: vec3<f32>) -> f32 {
    var importance = 0.0;
    if node.flux > 0.0 {
        let half = 0.5 * (node.high - node.low);
        let offset = at - (node.low + half);
        let distance2 = dot(offset, offset);
        let radius2 = dot(half, half);
        // Finite within the box, and no nearer than the radius of the disc that a light stands for.
        let bounded2 = max(distance2 + 0.5 * radius2, max(node.area / PI, 1e-30));
        let per_distance = inverseSqrt(bounded2);
        // The greatest heights of the box above the plane of the receiver, and of the receiver above planes across the axis.
        let received = dot(abs(normal), half) - dot(normal, offset);
        let emitted = dot(abs(node.axis), half) + dot(node.axis, offset);
        let farthest = sqrt(distance2) + sqrt(radius2);
        // Below the plane, the least angle is that of the farthest light.
        let along = select(emitted / max(farthest, 1e-15), emitted * per_distance, emitted >= 0.0);
        let cosine = cosine_of_difference(clamp(along, -1.0, 1.0), node.cosine);
        let cosines = max(min(received * per_distance, 1.0) + LEAST_COSINE, 0.0) * max(cosine + LEAST_COSINE, 0.0);
        importance = node.flux * (cosines / (PI * bounded2) + light_floor.x);
    }
    if node.far > 0.0 {
        let cosine = cosine_of_difference(clamp(-dot(normal, node.axis), -1.0, 1.0), node.cosine);
        importance += node.far * (max(cosine + LEAST_COSINE, 0.0) + light_floor.y);
    }
    // The sum of two of them is a number.
    return min(importance, 1e37);
}

/// Chooses one of the lights below a node, by 32 random bits. Numbers that are stratified give choices that are.
fn choose_light_below(start: u32, at: vec3<f32>, normal: vec3<f32>, number: u32) -> LightChoice {
    let finest = 1.0 / 16777216.0;
    var node = start;
    var probability = 1.0;
    // At each node, the number is stretched to the share of the child that it chose; so are the steps between such numbers.
    var rest = unit_float(number);
    var grain = finest;
    var state = number;
    while node < tree.leaves {
        let left = light_importance(tree.nodes[2u * node], at, normal);
        let right = light_importance(tree.nodes[2u * node + 1u], at, normal);
        if !(left + right > 0.0) {
            return LightChoice(NO_LIGHT, 0.0);
        }
        if grain > 16.0 * finest {
            // Random digits in place of those that were used.
            state = hash(state);
            rest = min(rest + grain * unit_float(state), ALMOST_ONE);
            grain = finest;
        }
        var share = left / (left + right);
        let is_left = rest < share;
        if is_left {
            rest /= share;
        } else {
            rest -= share;
            share = right / (left + right);
            rest /= share;
        }
        rest = min(rest, ALMOST_ONE);
        grain /= share;
        probability *= share;
        node = 2u * node + select(1u, 0u, is_left);
    }
    let light = tree.nodes[node].light;
    return LightChoice(light, select(probability, 0.0, light == NO_LIGHT));
}

/// Chooses one of all lights, by 32 random bits: roughly in proportion to the irradiance at the point, without shadows, and never
/// with probability 0 where a light gives any.
fn choose_light(at: vec3<f32>, normal: vec3<f32>, number: u32) -> LightChoice {
    return choose_light_below(tree.root, at, normal, number);
}
