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
