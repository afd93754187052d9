//! Functions of the library in `f64`, against the same written by hand.

use crate::library;
use precision::{Interpreter, Value};
use shader_library::Request;

/// What a function of a file gives in `f64`.
fn call(path: &str, name: &str, arguments: Vec<Value<f64>>) -> Vec<f64> {
    let shader = library().load(&Request::new(path)).unwrap_or_else(|error| panic!("{error}"));
    let mut interpreter = Interpreter::<f64>::new(&shader, &[]).unwrap_or_else(|fault| panic!("{fault}"));
    interpreter.call(name, arguments).unwrap_or_else(|fault| panic!("{fault}")).to_f64s()
}

fn near(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance * expected.abs(), "{found} and {expected}");
    }
}

#[test]
fn normal_and_area_of_a_right_triangle() {
    let found = call(
        "shaders/triangle.wgsl",
        "normal_and_area",
        vec![Value::floats([3.0, 0.0, 0.0]), Value::floats([0.0, 1.0, 1.0])],
    );
    let half = std::f64::consts::FRAC_1_SQRT_2;
    near(&found, &[0.0, -half, half, 1.5 * 2f64.sqrt()], 1e-15);
}

#[test]
fn the_density_of_the_paraboloid_map() {
    let (x, y) = (0.3, -0.6);
    let found = call("shaders/paraboloid.wgsl", "paraboloid_density", vec![Value::floats([x, y])]);
    near(&found, &[4.0 / (1.0f64 + x * x + y * y).powi(2)], 1e-15);
}

#[test]
fn frames_are_orthonormal() {
    for normal in [[0.6, 0.0, 0.8], [0.0, 0.6, -0.8], [0.0, 0.0, -1.0]] {
        let frame = call("shaders/tangent-frame.wgsl", "frame_from_normal", vec![Value::floats(normal)]);
        let column = |i: usize| &frame[3 * i..3 * i + 3];
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        for i in 0..3 {
            for k in 0..3 {
                let expected = f64::from(u8::from(i == k));
                assert!((dot(column(i), column(k)) - expected).abs() < 1e-15, "{frame:?}");
            }
        }
        assert_eq!(column(2), normal);
    }
}

#[test]
fn hashes_and_sequences_are_whole_numbers() {
    // Elements of van der Corput's sequence in base 3.
    for (index, expected) in [(1, 1.0 / 3.0), (2, 2.0 / 3.0), (3, 1.0 / 9.0), (5, 7.0 / 9.0)] {
        let arguments = [3, index].map(|x| Value::Scalar(precision::Scalar::U32(x))).to_vec();
        near(&call("shaders/random.wgsl", "radical_inverse", arguments), &[expected], 1e-15);
    }
}

#[test]
fn exponential_times_are_logarithms() {
    for x in [0.0, 1e-9, 1e-3, 0.1, 0.249, 0.251, 0.9, 0.9999] {
        let found =
            call("passes/resample-points/exponential.wgsl", "exponential_time", vec![Value::float(x)]);
        // The series ends before z⁸ / 9, z = 1/7.
        near(&found, &[-(-x).ln_1p()], 3e-8);
    }
}

#[test]
fn hables_curve_is_over_one_denominator() {
    let files = shader_library::Request::new("shaders/tonemap.wgsl").define("TONEMAP", "filmic");
    let shader = library().load(&files).unwrap_or_else(|error| panic!("{error}"));
    let mut interpreter = Interpreter::<f64>::new(&shader, &[]).unwrap();
    for x in [0.001, 0.18, 1.0, 11.2] {
        let found = interpreter.call("hable", vec![Value::floats([x; 3])]).unwrap().to_f64s();
        // [Hable 2010: A 0.15, B 0.50, C 0.10, D 0.20, E 0.02, F 0.30]
        let curve = (x * (0.15 * x + 0.05) + 0.004) / (x * (0.15 * x + 0.5) + 0.06) - 0.02 / 0.3;
        near(&found, &[curve; 3], 1e-6);
    }
}

#[test]
fn a_texel_has_the_solid_angle_between_its_corners() {
    // ∫ of the cosine cubed over the rectangle, by atan(xy / √(1 + x² + y²)) at its corners.
    let corner = |x: f64, y: f64| (x * y / (1.0 + x * x + y * y).sqrt()).atan();
    for (x, y, width, height) in [(0.0, 0.0, 2.0, 2.0), (0.7, -0.3, 0.1, 0.2), (-2.0, 1.0, 1e-2, 3e-3)] {
        let arguments = vec![Value::floats([x, y]), Value::floats([width, height])];
        let found = call("shaders/beam.wgsl", "rectangle_solid_angle", arguments);
        let (low, high) = ((x - 0.5 * width, y - 0.5 * height), (x + 0.5 * width, y + 0.5 * height));
        let exact =
            corner(high.0, high.1) - corner(low.0, high.1) - corner(high.0, low.1) + corner(low.0, low.1);
        near(&found, &[exact], 1e-9);
    }
}

#[test]
fn visible_normals_lie_on_the_cap_that_is_seen() {
    let files = shader_library::Request::new("shaders/scatter.wgsl").define("GLOSSY", true);
    let shader = library().load(&files).unwrap_or_else(|error| panic!("{error}"));
    let mut interpreter = Interpreter::<f64>::new(&shader, &[]).unwrap();
    // Seen along the surface's normal with alpha 1, a normal's half vector is uniform in 1 - cos: [Dupuy & Benyoub 2023]
    // z = 1 - 2 u, and halfway to z lies √((1 + z) / 2).
    for u in [1e-6, 0.25, 0.9] {
        let arguments = vec![Value::floats([0.0, 0.0, 1.0]), Value::float(1.0), Value::floats([0.3, u])];
        let found = interpreter.call("visible_normal", arguments).unwrap().to_f64s();
        near(&found[2..], &[(1.0 - u).sqrt()], 1e-12);
    }
}
