//! The filter removes the pattern of interleaving, and only that.

mod cpu_reference;

use cpu_reference::window;
use pass_test::Harness;

/// The irradiance that both ways of filtering make of what a function describes: depth [m] and normal. `None`
/// without a GPU.
fn filtered(
    size: (u32, u32),
    see: impl Fn(u32, u32) -> (f32, [f32; 3]),
    irradiance: impl Fn(u32, u32) -> [f32; 4],
    interleave: (u32, u32),
    thresholds: (f32, f32),
) -> Option<[Vec<[f32; 4]>; 2]> {
    let run = |separable| run(size, &see, &irradiance, interleave, thresholds, separable);
    Some([run(true)?, run(false)?])
}

fn run(
    (width, height): (u32, u32),
    see: impl Fn(u32, u32) -> (f32, [f32; 3]),
    irradiance: impl Fn(u32, u32) -> [f32; 4],
    interleave: (u32, u32),
    (alpha, beta): (f32, f32),
    separable: bool,
) -> Option<Vec<[f32; 4]>> {
    let outputs = Harness::new(geometry_aware_blur::PASS)
        .frame(width, height)
        .set("alpha", alpha)
        .set("beta", beta)
        .set("separable", separable)
        .view(see)
        .irradiance(interleave, irradiance)
        .run()?;
    Some(outputs.read("filtered"))
}

const TOWARDS: [f32; 3] = [0.0, 0.0, 1.0];

/// A wall across the axis.
fn wall(_: u32, _: u32) -> (f32, [f32; 3]) {
    (3.0, TOWARDS)
}

/// Another value for each pixel of a block of n×m.
fn pattern(n: u32, m: u32) -> impl Fn(u32, u32) -> [f32; 4] {
    move |x, y| {
        let subset = (y % m * n + x % n) as f32;
        [subset, 2.0 * subset * subset, 1.0, 100.0 - subset]
    }
}

#[test]
fn a_window_has_each_residue_once() {
    for period in 1..=16 {
        for size in [period, period + 1, 2 * period + 3, 40] {
            for at in 0..size {
                let mut weights = vec![0.0; period as usize];
                window(at, size, period)
                    .iter()
                    .for_each(|(other, weight)| weights[(other % period) as usize] += weight);
                assert!(
                    weights.iter().all(|weight| *weight == 1.0),
                    "{at} of {size}, period {period}: {weights:?}"
                );
            }
        }
    }
}

#[test]
fn windows_are_symmetric() {
    for period in 1..=16 {
        let offset: f64 =
            window(50, 100, period).iter().map(|(other, weight)| (f64::from(*other) - 50.0) * weight).sum();
        assert_eq!(offset, 0.0, "period {period}");
    }
}

#[test]
fn no_pattern_of_interleaving_remains() {
    for (size, n, m) in
        [((32, 24), 4, 4), ((21, 13), 4, 4), ((17, 9), 3, 2), ((40, 33), 8, 16), ((4, 4), 4, 4)]
    {
        let Some(got) = filtered(size, wall, pattern(n, m), (n, m), (0.02, 0.9)) else { return };
        let mut mean = [0.0f64; 4];
        for (x, y) in (0..n * m).map(|i| (i % n, i / n)) {
            pattern(n, m)(x, y)
                .iter()
                .zip(&mut mean)
                .for_each(|(value, mean)| *mean += f64::from(*value) / f64::from(n * m));
        }
        for (i, got) in got.iter().flatten().enumerate() {
            for c in 0..4 {
                assert!(
                    (f64::from(got[c]) - mean[c]).abs() <= 1e-5 * mean[c],
                    "pixel {i} of {size:?}: {got:?} for {mean:?}"
                );
            }
        }
    }
}

#[test]
fn a_floor_at_a_grazing_angle_is_one_surface() {
    // The plane y = -1: the depth of a row is 1 over minus its slope, and changes by half from row to row near
    // the horizon.
    let (width, height) = (16, 32);
    let tan = 0.4f32.tan();
    let floor = |_: u32, y: u32| {
        let slope = (1.0 - (2.0 * y as f32 + 1.0) / height as f32) * tan;
        if slope < 0.0 { (-1.0 / slope, [0.0, 1.0, 0.0]) } else { (0.0, [0.0; 3]) }
    };
    let Some(got) = filtered((width, height), floor, pattern(4, 4), (4, 4), (0.02, 0.9)) else { return };
    for y in 0..height {
        for x in 0..width {
            let got = got.each_ref().map(|got| got[(y * width + x) as usize]);
            if y < 16 {
                assert_eq!(got, [[0.0; 4]; 2], "the sky at ({x}, {y}) is black");
            } else if y >= 18 {
                assert!(got.iter().all(|got| (got[0] - 7.5).abs() < 1e-4), "({x}, {y}) is {got:?}");
            }
        }
    }
}

#[test]
fn nothing_crosses_a_step_or_a_crease() {
    let left = |x: u32| x < 9;
    let value = |x: u32, _: u32| if left(x) { [1.0; 4] } else { [5.0; 4] };
    let step = |x: u32, _: u32| if left(x) { (3.0, TOWARDS) } else { (3.5, TOWARDS) };
    let crease = |x: u32, _: u32| (3.0, if left(x) { TOWARDS } else { [0.8, 0.0, 0.6] });
    let across = |got: &Vec<[f32; 4]>| (0..18 * 8).all(|i| got[i as usize] == value(i % 18, i / 18));
    // The tilted normal's plane leaves the wall, so only the angle may tell: alpha is out of the way.
    for (name, got) in [
        ("step", filtered((18, 8), step, value, (4, 4), (0.02, 0.9))),
        ("crease", filtered((18, 8), crease, value, (4, 4), (1e3, 0.9))),
    ] {
        let Some(got) = got else { return };
        assert!(got.iter().all(across), "{name}");
    }
}

#[test]
fn a_pixel_without_neighbours_keeps_its_own() {
    // Normals that all differ, and thresholds that even rounding of the pixel's own normal does not meet.
    let lone = |x: u32, y: u32| {
        let angle = (x * 7 + y * 3) as f32;
        (1.0 + (x ^ y) as f32, [angle.sin(), 0.0, angle.cos()])
    };
    let value = |x: u32, y: u32| [(x + 10 * y) as f32; 4];
    let Some(got) = filtered((7, 5), lone, value, (4, 4), (0.0, 1.0)) else { return };
    for (i, got) in got[0].iter().zip(&got[1]).enumerate() {
        let own = value(i as u32 % 7, i as u32 / 7);
        assert_eq!(got, (&own, &own), "pixel {i}");
    }
}

#[test]
fn a_frame_of_one_pixel_is_unchanged() {
    let Some(got) = filtered((1, 1), wall, |_, _| [0.25; 4], (4, 4), (0.02, 0.9)) else { return };
    assert_eq!(got, [[[0.25; 4]], [[0.25; 4]]]);
}
