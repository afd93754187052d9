//! Choices of lights against their probabilities, and irradiance against the sum over all lights.

mod choices;
mod cpu_reference;

use cpu_reference::{INFINITELY_FAR, irradiance};
use gather_light_tree::PASS;
use glam::{DVec3, Vec3, dvec3};
use interfaces::virtual_lights::VirtualLight;
use pass_test::{Harness, Outputs, random};

pass_test::shaders_are_valid!(PASS);

fn unit(index: u32, dimension: u32) -> f32 {
    random::unit_float(random::hash2(index, dimension)) as f32
}

/// Returns lights in a box of 4 × 2 × 4 m on the plane y = 0, which face everywhere; some are dark, and some infinitely far.
fn lights(count: u32) -> Vec<VirtualLight> {
    let light = |i: u32| {
        let [x, y, z, u, v, w] = [0, 1, 2, 3, 4, 5].map(|dimension| unit(i, dimension));
        let is_far = i % 23 == 4;
        let flux = if is_far { 0.02 } else { 0.5 } * (0.2 + unit(i, 7)) * if i % 11 == 3 { 0.0 } else { 1.0 };
        VirtualLight {
            position: [4.0 * x - 2.0, 0.05 + 2.0 * y, 4.0 * z - 2.0],
            area: 0.05 * unit(i, 6),
            normal: Vec3::new(u - 0.5, v - 0.8, w - 0.5).normalize_or(Vec3::X).to_array(),
            flux: [flux, 2.0 * flux * unit(i, 8), 0.5 * flux],
            kind: if is_far { INFINITELY_FAR } else { 0 },
            ..VirtualLight::default()
        }
    };
    (0..count).map(light).collect()
}

/// A view of the plane y = 0 from 2 m above it, whose pixels all see one place where it is narrow.
struct View {
    width: u32,
    height: u32,
    fov: f32,
}

impl View {
    const NARROW: View = View { width: 64, height: 48, fov: 1e-5 };

    fn harness(&self, lights: &[VirtualLight]) -> Harness<'static> {
        self.at_depth(lights, 2.0)
    }

    fn at_depth(&self, lights: &[VirtualLight], depth: f32) -> Harness<'static> {
        let camera = scene::Camera {
            position: Vec3::new(0.0, 2.0, 0.0),
            target: Vec3::ZERO,
            up: Vec3::NEG_Z,
            vertical_fov: self.fov,
            near: 0.01,
        };
        Harness::new(PASS)
            .frame(self.width, self.height)
            .scene("plane")
            .view(move |_, _| (depth, [0.0, 1.0, 0.0]))
            .camera(camera)
            .lights(lights)
            .light_tree(lights)
            .set("area_bound", 0.0)
    }

    /// Returns where each pixel looks.
    fn positions(&self) -> impl Iterator<Item = DVec3> {
        let tan = (f64::from(self.fov) / 2.0).tan() * 2.0;
        let (w, h) = (f64::from(self.width), f64::from(self.height));
        (0..self.width * self.height).map(move |i| {
            let (x, y) = (f64::from(i % self.width), f64::from(i / self.width));
            dvec3(((2.0 * x + 1.0) / w - 1.0) * tan * w / h, 0.0, ((2.0 * y + 1.0) / h - 1.0) * tan)
        })
    }
}

fn read(outputs: &Outputs) -> Vec<[f32; 4]> {
    outputs.read("irradiance")
}

/// Returns the mean over the values of a channel, and the standard deviation of that mean.
fn mean_of(values: &[[f32; 4]], channel: usize) -> (f64, f64) {
    pass_test::statistics::spread(values.iter().map(|value| value[channel]))
}

#[test]
fn the_mean_of_few_samples_is_the_sum_over_all_lights() {
    let lights = lights(700);
    let exact = irradiance(&lights, DVec3::ZERO, DVec3::Y, 6.0);
    for samples in [1, 3, 8, 20] {
        let harness = View::NARROW.harness(&lights).set("area_bound", 6.0).set("samples", samples);
        let harness = harness.set("interleave_x", 1).set("interleave_y", 1).seed(samples + 1);
        let Some(outputs) = harness.run() else { return };
        for channel in 0..4 {
            let (mean, deviation) = mean_of(&read(&outputs), channel);
            let wanted = exact[channel];
            // Five standard deviations, and what roundings of sums make.
            assert!(
                (mean - wanted).abs() <= 5.0 * deviation + 1e-4 * wanted,
                "{samples} samples, channel {channel}: {mean} ± {deviation} for {wanted}"
            );
            // The interval is narrow enough to find a light that is lost.
            assert!(deviation < 0.03 * exact[0], "{samples} samples, channel {channel}: ± {deviation}");
        }
    }
}

#[test]
fn pixels_of_a_window_have_stratified_choices() {
    const VIEW: View = View { width: 96, height: 96, fov: 1e-5 };
    let mut lights = lights(700);
    // Lights on a line, in the order of the leaves: their light changes smoothly.
    lights.sort_by(|a, b| a.position[0].total_cmp(&b.position[0]));
    for light in &mut lights {
        (light.normal, light.position, light.flux) =
            ([0.0, -1.0, 0.0], [light.position[0], 1.0, 0.0], [1.0; 3]);
    }
    let exact = irradiance(&lights, DVec3::ZERO, DVec3::Y, 6.0)[0];
    let run = |n: u32, m: u32| {
        let harness = VIEW.harness(&lights).set("area_bound", 6.0).set("samples", 4).seed(9);
        Some(read(&harness.set("interleave_x", n).set("interleave_y", m).run()?))
    };
    // Means over windows of 4 × 4 pixels, and their spread.
    let windows = |pixels: &[[f32; 4]]| {
        let View { width, height, .. } = VIEW;
        let means: Vec<[f32; 4]> = (0..width * height / 16)
            .map(|window| {
                let (x, y) = (window % (width / 4) * 4, window / (width / 4) * 4);
                let sum: f32 = (0..16).map(|i| pixels[((y + i / 4) * width + x + i % 4) as usize][0]).sum();
                [sum / 16.0; 4]
            })
            .collect();
        mean_of(&means, 0)
    };
    let (Some(alone), Some(together)) = (run(1, 1), run(4, 4)) else { return };
    let ((_, alone), (mean, together)) = (windows(&alone), windows(&together));
    assert!((mean - exact).abs() < 5.0 * together + 1e-4 * exact, "{mean} ± {together} for {exact}");
    // Without stratification they would be the same, to 6 % for so many windows.
    assert!(together < 0.7 * alone, "{together} of windows, and {alone} of pixels alone");
}

#[test]
fn as_many_samples_as_lights_give_the_sum() {
    // All leaves are in the cut: each gives its light, and nothing is left to chance.
    for (count, width, height) in [(1, 3, 3), (2, 4, 4), (37, 13, 9), (64, 9, 17)] {
        let lights = lights(count);
        let view = View { width, height, fov: 0.8 };
        for radii in [0.0, 2.0] {
            let harness = view.harness(&lights).set("samples", 64).set("area_bound", radii as f32);
            let Some(outputs) = harness.run() else { return };
            for (got, at) in read(&outputs).into_iter().zip(view.positions()) {
                let exact = irradiance(&lights, at, DVec3::Y, radii);
                for (got, wanted) in got.into_iter().zip(exact) {
                    let tolerance = 1e-4 * wanted.max(exact[0]);
                    assert!(
                        (f64::from(got) - wanted).abs() <= tolerance,
                        "{count} lights: {got} for {wanted}"
                    );
                }
            }
        }
    }
}

#[test]
fn extremes_give_the_sum() {
    let all = |change: &dyn Fn(&mut VirtualLight)| {
        let mut lights = lights(300);
        lights.iter_mut().for_each(change);
        lights
    };
    for (name, lights) in [
        ("none", Vec::new()),
        ("dark", all(&|light| light.flux = [0.0; 3])),
        ("in one place", all(&|light| light.position = [0.3, 1.0, -0.5])),
        ("infinitely far", all(&|light| light.kind = INFINITELY_FAR)),
        ("behind the plane", all(&|light| light.position[1] *= -1.0)),
        ("on the plane", all(&|light| light.position[1] = 0.0)),
        ("very bright", all(&|light| light.flux = light.flux.map(|flux| 1e20 * flux))),
        ("very dim", all(&|light| light.flux = light.flux.map(|flux| 1e-20 * flux))),
    ] {
        let Some(outputs) = View::NARROW.harness(&lights).run() else { return };
        let pixels = read(&outputs);
        assert!(pixels.iter().flatten().all(|value| value.is_finite() && *value >= 0.0), "{name}");
        let exact = irradiance(&lights, DVec3::ZERO, DVec3::Y, 0.0)[0];
        let (mean, deviation) = mean_of(&pixels, 0);
        assert!(
            (mean - exact).abs() <= 5.0 * deviation + 1e-4 * exact,
            "{name}: {mean} ± {deviation} for {exact}"
        );
    }
}

#[test]
fn lights_in_the_place_of_the_receiver_stay_finite() {
    let lights: Vec<_> = (0..9)
        .map(|i| VirtualLight {
            normal: if i % 2 == 0 { [0.0, 1.0, 0.0] } else { [0.0, -1.0, 0.0] },
            flux: [1e9; 3],
            ..VirtualLight::default()
        })
        .collect();
    let Some(outputs) = View::NARROW.harness(&lights).run() else { return };
    assert!(read(&outputs).into_iter().flatten().all(f32::is_finite));
}

#[test]
fn pixels_that_see_nothing_are_black() {
    let view = View { width: 5, height: 5, fov: 1.0 };
    let Some(outputs) = view.at_depth(&lights(50), 0.0).run() else { return };
    assert!(read(&outputs).iter().all(|value| *value == [0.0; 4]));
}

#[test]
fn a_module_says_which_lights_are_seen() {
    let view = View { width: 5, height: 5, fov: 0.6 };
    let lights = lights(20);
    let none = view.harness(&lights).run();
    let seen = view.harness(&lights).input("visibility", "Visibility", &[], Vec::new());
    let seen = seen.module("shaders/visibility-none.wgsl").run();
    let (Some(none), Some(seen)) = (none, seen) else { return };
    assert_eq!(read(&none), read(&seen), "all are seen, as without a module");
    // Maps of one light, in which all is nearer than the plane.
    let light = VirtualLight { position: [0.0, 1.0, 0.0], normal: [0.0, -1.0, 0.0], ..lights[0] };
    let atlas = pass::ResourceDesc::texture_2d_array(pass::Format::R32Float, (8, 8), 1);
    let maps = vec![("atlas", atlas, bytemuck::cast_slice(&[0.5f32; 64]).to_vec())];
    let facts = [("tile", 8), ("columns", 1), ("rows", 1)];
    let hidden = view.harness(&[light]).input("visibility", "Visibility", &facts, maps);
    let hidden =
        hidden.fact("depth_bias", 0.1).fact("slope_bias", 0.0).module("shaders/visibility-atlas.wgsl");
    let (Some(hidden), Some(open)) = (hidden.run(), view.harness(&[light]).run()) else { return };
    assert!(read(&hidden).iter().all(|value| *value == [0.0; 4]));
    assert!(read(&open).iter().all(|value| value[0] > 0.0));
}

#[test]
fn samples_of_several_dispatches_are_added() {
    let lights = lights(300);
    let view = View { width: 16, height: 12, fov: 0.8 };
    let run = |iterations: Option<u32>| {
        let harness = view.harness(&lights).set("samples", 64).set("geometry", "point-to-disc");
        let harness = harness.input("visibility", "Visibility", &[], Vec::new());
        let harness = match iterations {
            Some(iterations) => harness.fact("iterations", iterations),
            None => harness,
        };
        Some(read(&harness.module("shaders/visibility-none.wgsl").run()?))
    };
    // Lookups of so many loop iterations leave few samples to a dispatch.
    let (Some(one), Some(several)) = (run(None), run(Some(10_000))) else { return };
    for (one, several) in one.iter().flatten().zip(several.iter().flatten()) {
        assert!((one - several).abs() <= 1e-5 * one.abs(), "{several} for {one}");
    }
}
