// Linear Rec. 709.

const PI: f32 = 3.14159265358979;

/// Relative luminance (BT.709).
fn luminance(rgb: vec3<f32>) -> f32 {
    return dot(rgb, vec3(0.2126, 0.7152, 0.0722));
}
