//! Functions of the library in `f64`, against the same written by hand.

use crate::library;
use glam::DVec3;
use precision::{Interpreter, Value};
use shader_library::Request;

/// What a function of a file gives in `f64`.
fn call(path: &str, name: &str, arguments: Vec<Value<f64>>) -> Vec<f64> {
    called(&Request::new(path), name, arguments).to_f64s()
}

fn called(request: &Request, name: &str, arguments: Vec<Value<f64>>) -> Value<f64> {
    let shader = library().load(request).unwrap_or_else(|error| panic!("{error}"));
    let mut interpreter = Interpreter::<f64>::new(&shader, &[]).unwrap_or_else(|fault| panic!("{fault}"));
    interpreter.call(name, arguments).unwrap_or_else(|fault| panic!("{fault}"))
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

fn whole(x: u32) -> Value<f64> {
    Value::Scalar(precision::Scalar::U32(x))
}

/// The whole numbers of a value.
fn numbers(value: &Value<f64>) -> Vec<u32> {
    let number = |scalar: &precision::Scalar<f64>| match scalar {
        precision::Scalar::U32(number) => *number,
        other => panic!("{other:?} is no u32"),
    };
    match value {
        Value::Scalar(scalar) => vec![number(scalar)],
        Value::Vector(vector) => vector.components().iter().map(number).collect(),
        other => panic!("{other:?} is neither"),
    }
}

/// Directions all over the sphere, some along the axes.
fn directions() -> impl Iterator<Item = [f64; 3]> {
    (0..=8).flat_map(|i| (0..16).map(move |k| (f64::from(i) / 8.0, f64::from(k) / 16.0))).map(|(u, v)| {
        let (z, angle) = (1.0 - 2.0 * u, std::f64::consts::TAU * v);
        let r = (1.0 - z * z).max(0.0).sqrt();
        [r * angle.cos(), r * angle.sin(), z]
    })
}

#[test]
fn the_octahedral_map_has_an_inverse() {
    for direction in directions() {
        let path = "shaders/octahedron.wgsl";
        let at = call(path, "octahedron_from_direction", vec![Value::floats(direction)]);
        assert!(at.iter().all(|x| x.abs() <= 1.0 + 1e-15), "{direction:?} is at {at:?}");
        let found = call(path, "direction_from_octahedron", vec![Value::floats([at[0], at[1]])]);
        for (found, expected) in found.iter().zip(direction) {
            assert!((found - expected).abs() < 1e-14, "{found} and {expected} of {direction:?}");
        }
    }
}

/// Of 16 elements from a multiple of 16 on, one lies in each box of area 1/16 whose sides are powers of two: so also where all bits
/// of the index count, and after Owen's scrambling.
#[test]
fn sobols_sequence_is_stratified_wherever_it_begins() {
    let shader =
        library().load(&Request::new("shaders/sobol.wgsl")).unwrap_or_else(|error| panic!("{error}"));
    let mut interpreter = Interpreter::<f64>::new(&shader, &[]).unwrap_or_else(|fault| panic!("{fault}"));
    for first in [0, 16, 0x1230, 0x0001_0000, 0x00ab_cd10, 0xfedc_ba90, 0xffff_fff0] {
        for seed in [None, Some(0), Some(7)] {
            let points: Vec<Vec<u32>> = (first..=first + 15)
                .map(|index: u32| {
                    let found = match seed {
                        None => interpreter.call("sobol2", vec![whole(index)]),
                        Some(seed) => interpreter.call("sobol2_bits_of", vec![whole(index), whole(seed)]),
                    };
                    numbers(&found.unwrap_or_else(|fault| panic!("{fault}")))
                })
                .collect();
            for columns in [1, 2, 4, 8, 16] {
                let cell = |x: u32, cells: u64| ((u64::from(x) * cells) >> 32) as usize;
                let mut counts = [0; 16];
                for point in &points {
                    let rows = 16 / columns;
                    counts[cell(point[1], rows) * columns as usize + cell(point[0], columns)] += 1;
                }
                assert_eq!(counts, [1; 16], "{columns} columns, from {first:#x} on, seed {seed:?}");
            }
        }
    }
}

#[test]
fn products_of_whole_numbers_have_their_upper_half() {
    for (a, b) in
        [(0, 9), (3, 5), (0x0001_0000, 0x0001_0000), (0x1234_5678, 0x9abc_def0), (u32::MAX, u32::MAX)]
    {
        let file = Request::new("shaders/random.wgsl");
        let found = numbers(&called(&file, "multiply_high", vec![whole(a), whole(b)]));
        assert_eq!(found, [((u64::from(a) * u64::from(b)) >> 32) as u32], "{a:#x} × {b:#x}");
    }
}

/// Against D G₂ F / (4 cosθ cosθ'), with the shadowing of microfacets of correlated heights written as 1 / (1 + Λ + Λ').
/// [Heitz 2014, Eq. 72 and 99]
#[test]
fn microfacets_reflect_as_they_are_defined() {
    let at = |degrees: f64, turn: f64| {
        let (polar, turn) = (degrees.to_radians(), turn.to_radians());
        [polar.sin() * turn.cos(), polar.sin() * turn.sin(), polar.cos()]
    };
    let dot = |a: [f64; 3], b: [f64; 3]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    for roughness in [0.3f64, 0.7, 1.0] {
        let a2 = roughness.powi(4);
        for (to_light, to_camera) in [
            (at(10.0, 0.0), at(30.0, 180.0)),
            (at(75.0, 0.0), at(20.0, 90.0)),
            (at(85.0, 0.0), at(80.0, 170.0)),
            (at(85.0, 0.0), at(85.0, 0.0)),
        ] {
            let sum: Vec<f64> = (0..3).map(|i| to_light[i] + to_camera[i]).collect();
            let length = sum.iter().map(|x| x * x).sum::<f64>().sqrt();
            let half = [sum[0] / length, sum[1] / length, sum[2] / length];
            let distribution = a2 / (std::f64::consts::PI * (half[2] * half[2] * (a2 - 1.0) + 1.0).powi(2));
            let lambda = |z: f64| 0.5 * ((1.0 + a2 * (1.0 / (z * z) - 1.0)).sqrt() - 1.0);
            let shadowing = 1.0 / (1.0 + lambda(to_light[2]) + lambda(to_camera[2]));
            let fresnel = |f0: f64| f0 + (1.0 - f0) * (1.0 - dot(to_light, half)).powi(5);
            let expected = [0.04, 0.5, 1.0]
                .map(|f0| distribution * shadowing * fresnel(f0) / (4.0 * to_light[2] * to_camera[2]));
            let arguments = vec![
                Value::floats([0.0, 0.0, 1.0]),
                Value::floats(to_light),
                Value::floats(to_camera),
                Value::floats([0.04, 0.5, 1.0]),
                Value::float(roughness),
            ];
            // π is that of f32.
            near(&call("shaders/ggx.wgsl", "ggx", arguments), &expected, 1e-7);
        }
    }
}

/// A disc across the direction `d` of a hemisphere's map reaches as far along x and y as the map is wide there; one with the normal `n`
/// by the sine of the angle between `n` and the way in which `d` moves along x or y.
#[test]
fn the_extent_of_a_disc_is_that_of_its_image() {
    let direction = |x: f64, y: f64| {
        call("shaders/paraboloid.wgsl", "direction_from_paraboloid", vec![Value::floats([x, y])])
    };
    let mut splats = Request::new("passes/splat/splat.wgsl");
    splats.modules.insert("points".to_owned(), "shaders/points-stored.wgsl".to_owned());
    let step = 1e-6;
    for (x, y) in [(0.0, 0.0), (0.4, -0.3), (-0.6, 0.7), (0.1, 0.9)] {
        for normal in directions().step_by(7) {
            let along = |dx: f64, dy: f64| {
                let (before, after) = (direction(x - dx, y - dy), direction(x + dx, y + dy));
                let way: Vec<f64> = after.iter().zip(&before).map(|(a, b)| a - b).collect();
                let length = way.iter().map(|x| x * x).sum::<f64>().sqrt();
                let cosine = way.iter().zip(normal).map(|(a, b)| a / length * b).sum::<f64>();
                (1.0 - cosine * cosine).max(0.0).sqrt()
            };
            let arguments = vec![Value::floats(normal), Value::floats([x, y])];
            let found = called(&splats, "disc_extent", arguments).to_f64s();
            for (found, expected) in found.iter().zip([along(step, 0.0), along(0.0, step)]) {
                assert!((found - expected).abs() < 1e-6, "{found} and {expected} of {normal:?} at {x}, {y}");
            }
        }
    }
}

#[test]
fn elements_of_a_sequence_stay_below_one_when_rounded() {
    let shader =
        library().load(&Request::new("shaders/random.wgsl")).unwrap_or_else(|error| panic!("{error}"));
    let mut interpreter = Interpreter::<f32>::new(&shader, &[]).unwrap_or_else(|fault| panic!("{fault}"));
    for (base, index) in [(2, u32::MAX), (3, 3_486_784_400), (5, 1_220_703_124)] {
        let arguments = [base, index].map(|x| Value::Scalar(precision::Scalar::U32(x))).to_vec();
        let found = interpreter.call("radical_inverse", arguments).unwrap_or_else(|fault| panic!("{fault}"));
        let found = found.to_f64s()[0];
        assert!((0.999_99..1.0).contains(&found), "{found} of {index} in base {base}");
    }
}

/// A receiver that a disc touches sees nothing else before it: the share of the half space above it that is on the side of the
/// disc, by the cosine. Rounding takes the disc's vector beyond what a half space can give.
#[test]
fn a_disc_that_touches_a_receiver_is_a_half_space() {
    let shader = library()
        .load(&Request::new("shaders/disc-irradiance.wgsl"))
        .unwrap_or_else(|error| panic!("{error}"));
    let mut interpreter = Interpreter::<f32>::new(&shader, &[]).unwrap_or_else(|fault| panic!("{fault}"));
    for radius2 in [1.0, 0.3, 7.0f64] {
        for off in [-0.95, -0.9, -0.8, -0.7, -0.6] {
            for height in [1e-5, 1e-6, 1e-7, 1e-9] {
                for tilt in [0.5, 1.0, 1.4f64] {
                    let arguments = vec![
                        Value::floats([off * radius2.sqrt(), 0.0, height]),
                        Value::floats([0.0, 0.0, 1.0]),
                        Value::floats([tilt.sin(), 0.0, -tilt.cos()]),
                        Value::float(radius2),
                    ];
                    let found = interpreter.call("disc_irradiance", arguments);
                    let found = found.unwrap_or_else(|fault| panic!("{fault}")).to_f64s()[0];
                    let expected = 0.5 * (1.0 + tilt.cos()) / (std::f64::consts::PI * radius2);
                    let wrong = (found / expected - 1.0).abs() > 1e-2;
                    assert!(!wrong, "{found} for {expected}, {off} off, {height} m away, tilted by {tilt}");
                }
            }
        }
    }
}

/// A half float says a direction to a degree, and is a normal number: never 0, which says that there is none.
#[test]
fn a_half_float_says_a_direction() {
    let path = "shaders/octahedron.wgsl";
    for direction in directions() {
        let number = call(path, "half_float_from_direction", vec![Value::floats(direction)]);
        assert!((2f64.powi(-14)..65504.0).contains(&number[0].abs()), "{direction:?} is {number:?}");
        assert_eq!(half::f16::from_f64(number[0]).to_f64(), number[0], "{direction:?}");
        let found = call(path, "direction_from_half_float", vec![Value::floats([number[0]])]);
        let cosine: f64 = found.iter().zip(direction).map(|(a, b)| a * b).sum();
        assert!(cosine > 1f64.to_radians().cos(), "{found:?} of {direction:?}");
    }
}

/// The mean of normals whose slopes are normally distributed says which of them face a direction.
#[test]
fn the_mean_of_normals_says_which_face_a_direction() {
    let path = "shaders/mean-normal.wgsl";
    let steps: Vec<f64> = (-60..=60).map(|i| f64::from(i) / 12.0).collect();
    for deviation in [0.05, 0.2, 0.4] {
        let slopes = steps.iter().flat_map(|x| steps.iter().map(move |y| (x, y))).map(|(x, y)| {
            let density = (-0.5 * (x * x + y * y)).exp() / (144.0 * std::f64::consts::TAU);
            (DVec3::new(-x * deviation, -y * deviation, 1.0).normalize(), density)
        });
        let mean: DVec3 = slopes.clone().map(|(normal, density)| normal * density).sum();
        for angle in [0.0, 40.0, 70.0, 85.0, 100.0] {
            let (sine, cosine) = f64::to_radians(angle).sin_cos();
            let to = DVec3::new(0.6 * sine, 0.8 * sine, cosine);
            let facing = slopes.clone().filter(|(normal, _)| normal.dot(to) > 0.0);
            let expected: DVec3 = facing.map(|(normal, density)| normal * density).sum();
            let given = vec![Value::floats(mean.to_array()), Value::floats(to.to_array())];
            let found = DVec3::from_slice(&call(path, "mean_facing", given));
            assert!(found.distance(expected) < 0.03, "{deviation}, {angle}°: {found} for {expected}");
        }
    }
}
