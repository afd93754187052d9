//! Reservoirs of virtual lights, and what is true of every pass that resamples them.

use crate::random::{hash2, unit_float};
use crate::statistics::spread;
use crate::{Harness, buffer, scene};
use glam::{DVec3, Vec3, dvec3};
use interfaces::reservoirs::Reservoir;
use interfaces::virtual_lights::VirtualLight;
use scene::Camera;
use std::f64::consts::PI;

/// The pixels along a side of [`Harness::middle_of_plane`].
pub const SIDE: u32 = 96;

/// A camera from which all pixels see nearly the middle of the scene `plane`.
const CAMERA: Camera =
    Camera { position: Vec3::Y, target: Vec3::ZERO, up: Vec3::NEG_Z, vertical_fov: 1e-4, near: 0.01 };

/// The depth \[m\] and the normal of the plane as it is, for [`Harness::middle_of_plane`].
pub fn flat(_: u32, _: u32) -> (f32, [f32; 3]) {
    (1.0, [0.0, 1.0, 0.0])
}

/// The facts of the target that [`Harness::reservoirs`] gives: bound, least and doubt.
pub const TARGET: (f32, f32, f32) = (5.0, 0.5, 0.25);

/// Returns a reservoir of a light that was chosen with some probability among `count`.
pub fn reservoir(light: VirtualLight, probability: f64, count: f32) -> Reservoir {
    Reservoir { light, weight: (1.0 / probability) as f32, count, guess: 1.0, index: light.texel }
}

/// Returns lights that differ in flux, place and side, over the square of the scene `plane`: each has its index as its texel.
/// The last is infinitely far.
pub fn lights() -> Vec<VirtualLight> {
    let place = |x, y, z| dvec3(x, y, z);
    let places = [place(0.3, 0.4, 0.0), place(-0.4, 0.5, 0.3), place(0.2, 0.9, -0.5), place(-0.6, 0.8, -0.2)];
    let mut lights: Vec<VirtualLight> =
        places.iter().map(|at| crate::light_at(*at, -at.normalize())).collect();
    let mut far = crate::light_at(DVec3::Y, DVec3::NEG_Y);
    (far.kind, far.flux) = (1, [0.3; 3]);
    lights.push(far);
    for (index, light) in lights.iter_mut().enumerate() {
        light.texel = index as u32;
        light.area = 0.05;
        light.flux = light.flux.map(|flux| flux * (2.0 + index as f32));
    }
    lights
}

/// Computes the target of a light at a point of a surface, without the guess: the luminance of the irradiance, bounded near the light,
/// and the least that counts. `extent` \[m\] is the scene's.
pub fn target(light: &VirtualLight, at: DVec3, normal: DVec3, extent: f64) -> f64 {
    let vector = |v: [f32; 3]| DVec3::from(v.map(f64::from));
    let (bound, least, _) = TARGET;
    let [r, g, b] = light.flux.map(f64::from);
    let luminance = 0.2126 * r + 0.7152 * g + 0.0722 * b;
    if light.kind == 1 {
        return luminance * ((-normal.dot(vector(light.normal))).max(0.0) + f64::from(least));
    }
    let way = at - vector(light.position);
    let cosines =
        (vector(light.normal).dot(way).max(0.0) * (-normal.dot(way)).max(0.0)) / way.length_squared();
    let nearest = f64::from(bound * bound * light.area);
    let far = f64::from(least) / (PI * extent * extent);
    luminance * (cosines / (PI * way.length_squared()).max(nearest) + far)
}

/// Returns the share of each light in the sum of all targets, at a point on the scene `plane` \[m\] with that normal.
pub fn shares(lights: &[VirtualLight], at: [f64; 3], normal: [f64; 3]) -> Vec<f64> {
    let extent = f64::from(scene("plane").dense_extent());
    let targets = lights.iter().map(|light| target(light, at.into(), normal.into(), extent));
    let targets: Vec<f64> = targets.collect();
    let sum: f64 = targets.iter().sum();
    targets.iter().map(|target| target / sum).collect()
}

/// Returns a reservoir of one of the lights for each pixel, chosen by these shares, which sum to 1.
pub fn chosen_by(lights: &[VirtualLight], shares: &[f64], key: u32, count: f32) -> Vec<Reservoir> {
    let one = |pixel| {
        let number = unit_float(hash2(key, pixel));
        let mut sum = 0.0;
        let below = |share: &&f64| {
            sum += **share;
            sum <= number
        };
        let index = shares.iter().take_while(below).count().min(lights.len() - 1);
        reservoir(lights[index], shares[index], count)
    };
    (0..SIDE * SIDE).map(one).collect()
}

/// Returns how often each of `lights` lights was chosen.
pub fn counts(reservoirs: &[Reservoir], lights: usize) -> Vec<u32> {
    (0..lights as u32).map(|l| reservoirs.iter().filter(|r| r.light.texel == l).count() as u32).collect()
}

impl Harness<'_> {
    /// Sets the scene `plane` and a frame of [`SIDE`]² pixels that all see nearly its middle, of which `see` says the depth \[m\] and
    /// the normal at each pixel.
    pub fn middle_of_plane(self, see: impl Fn(u32, u32) -> (f32, [f32; 3])) -> Self {
        self.scene("plane").camera(CAMERA).frame(SIDE, SIDE).seed(1).seen(see)
    }

    /// Gives an input port these reservoirs, `per_pixel` for each pixel.
    pub fn reservoirs(self, port: &str, per_pixel: u32, reservoirs: &[Reservoir]) -> Self {
        let bytes = bytemuck::cast_slice(reservoirs).to_vec();
        let members = vec![("", buffer(bytes.len() as u64), bytes)];
        self.input(port, "Reservoirs", &[("per_pixel", per_pixel)], members).target_facts()
    }

    /// Gives an input port the reservoirs of the frame before, one for each pixel.
    pub fn past_reservoirs(self, port: &str, reservoirs: &[Reservoir]) -> Self {
        let bytes = bytemuck::cast_slice(reservoirs).to_vec();
        let members = vec![("", buffer(bytes.len() as u64), bytes)];
        self.past(port, "Reservoirs", 1, members).fact("per_pixel", 1u32).target_facts()
    }

    fn target_facts(self) -> Self {
        let (bound, least, doubt) = TARGET;
        self.fact("bound", bound).fact("least", least).fact("doubt", doubt)
    }
}

/// Asserts that the weight of each of `count` lights, which its texel names, is 1 in the mean over all reservoirs: then every sum
/// over the lights is estimated without bias. A weight is 0 where another light was chosen.
///
/// # Panics
/// Where a mean is not within its interval, or that is wide.
pub fn assert_unbiased(reservoirs: &[Reservoir], count: u32) {
    for light in 0..count {
        let weights = reservoirs
            .iter()
            .map(|reservoir| if reservoir.light.texel == light { reservoir.weight } else { 0.0 });
        let (mean, deviation) = spread(weights);
        assert!(deviation < 0.06, "light {light}: {mean} ± {deviation} is not precise");
        assert!((mean - 1.0).abs() < 4.5 * deviation, "light {light}: a mean weight of {mean} ± {deviation}");
    }
}
