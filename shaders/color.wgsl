// Linear Rec. 709.

const PI: f32 = 3.14159265358979;

/// Weights of the channels in luminance (BT.709).
const LUMINANCE: vec3<f32> = vec3(0.2126, 0.7152, 0.0722);

/// Relative luminance (BT.709).
fn luminance(rgb: vec3<f32>) -> f32 {
    return dot(rgb, LUMINANCE);
}
