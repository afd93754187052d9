//! Inputs that functions of the pixel describe: what a camera sees, and light that was gathered there.

use crate::{Harness, Member, halves, member};
use bytemuck::NoUninit;
use glam::{DVec3, dvec3};
use pass::{Format, ResourceDesc};
use scene::{Camera, Scene};

/// The camera of [`Harness::view`]: at the origin, looking along −z, with a vertical field of view of 0.8 rad.
pub const CAMERA: Camera = Camera {
    position: glam::Vec3::ZERO,
    target: glam::Vec3::NEG_Z,
    up: glam::Vec3::Y,
    vertical_fov: 0.8,
    near: 0.01,
};

impl Harness<'_> {
    /// Gives the input port `view` a G-buffer of the frame's size, in which `see` says the depth \[m\] and the normal of
    /// each pixel, seen by [`CAMERA`].
    pub fn view(self, see: impl Fn(u32, u32) -> (f32, [f32; 3])) -> Self {
        self.camera(CAMERA).seen(see)
    }

    /// Gives the input port `view` a G-buffer of the frame's size, in which `see` says the depth \[m\] and the normal of
    /// each pixel.
    pub fn seen(self, see: impl Fn(u32, u32) -> (f32, [f32; 3])) -> Self {
        let normal = |[x, y, z]: [f32; 3]| halves([x, y, z, 0.0].map(f64::from));
        let members = vec![
            picture("depth", Format::R32Float, self.size, |x, y| see(x, y).0),
            picture("normal", Format::Rgba16Float, self.size, |x, y| normal(see(x, y).1)),
        ];
        self.input("view", "GBuffer", &[], members)
    }

    /// Gives the input port `irradiance` a picture of the frame's size, interleaved by `n` × `m` sub-images, in which
    /// `value` says each pixel.
    pub fn irradiance(self, (n, m): (u32, u32), value: impl Fn(u32, u32) -> [f32; 4]) -> Self {
        let members = vec![picture("", Format::Rgba32Float, self.size, value)];
        self.input("irradiance", "Irradiance", &[("interleave_x", n), ("interleave_y", m)], members)
    }
}

/// Returns a member that is a texture of `width` × `height`, in which `texel` says each by column and row.
pub fn picture<T: NoUninit>(
    name: &str,
    format: Format,
    (width, height): (u32, u32),
    texel: impl Fn(u32, u32) -> T,
) -> Member<'_> {
    let texels: Vec<T> = (0..width * height).map(|i| texel(i % width, i / width)).collect();
    member(name, ResourceDesc::texture_2d(format, (width, height)), &texels)
}

/// Returns the depth and the place at which a pixel of a frame of `width` × `height` sees the square of the scene `plane`
/// (y = 0, side 2 m); `None` where it sees nothing.
pub fn floor_seen(scene: &Scene, (width, height): (u32, u32), pixel: u32) -> Option<(f32, DVec3)> {
    let view = scene.camera.view().inverse().as_dmat4();
    let tangent = f64::from(scene.camera.vertical_fov * 0.5).tan();
    let ndc_x = (f64::from(pixel % width) + 0.5) / f64::from(width) * 2.0 - 1.0;
    let ndc_y = 1.0 - (f64::from(pixel / width) + 0.5) / f64::from(height) * 2.0;
    let aspect = f64::from(width) / f64::from(height);
    let ray = view.transform_vector3(dvec3(ndc_x * tangent * aspect, ndc_y * tangent, -1.0));
    let eye = scene.camera.position.as_dvec3();
    let depth = -eye.y / ray.y;
    let at = eye + ray * depth;
    (depth > 0.0 && at.x.abs() < 1.0 && at.z.abs() < 1.0).then_some((depth as f32, at))
}

/// Depth \[m\] and normal of a pixel.
pub type See<'a> = &'a dyn Fn(u32, u32) -> (f32, [f32; 3]);

/// Irradiance of a pixel.
pub type Light<'a> = &'a dyn Fn(u32, u32) -> [f32; 4];

/// The side of the pictures of [`assert_edges_stay`] \[px\].
pub const SIDE: u32 = 48;

/// The normal of what faces [`CAMERA`].
pub const TOWARDS: [f32; 3] = [0.0, 0.0, 1.0];

/// Asserts what holds of every filter that stops at edges of the geometry, on pictures of [`SIDE`]² pixels: what is
/// nearer, or faces another way, gives nothing; what sees nothing is black and gives nothing; and a floor at a grazing
/// angle is one surface. `filtered` runs the filter.
///
/// # Panics
/// Where one of these does not hold.
pub fn assert_edges_stay(filtered: impl Fn(See<'_>, Light<'_>) -> Option<Vec<[f32; 4]>>) {
    let at = |i: usize| (i as u32 % SIDE, i as u32 / SIDE);
    let left = |x: u32| x < SIDE / 2;
    let step = |x: u32, _: u32| (if left(x) { 3.0f32 } else { 5.0 }, TOWARDS);
    let crease = |x: u32, _: u32| (3.0, if left(x) { TOWARDS } else { [1.0, 0.0, 0.0] });
    let halves = |x: u32, _: u32| if left(x) { [1.0; 4] } else { [9.0; 4] };
    for (name, see) in [("step", &step as See<'_>), ("crease", &crease)] {
        let Some(pixels) = filtered(see, &halves) else { return };
        for (i, value) in pixels.iter().enumerate() {
            let (x, y) = at(i);
            let wanted = halves(x, y);
            assert!((value[0] - wanted[0]).abs() < 1e-3, "{name}: {value:?} for {wanted:?} at {x}, {y}");
        }
    }

    let hole = |x: u32, y: u32| if (x, y) == (20, 20) { (0.0f32, [0.0; 3]) } else { (3.0, TOWARDS) };
    let bright = |x: u32, y: u32| if (x, y) == (20, 20) { [1e6; 4] } else { [2.0; 4] };
    let Some(pixels) = filtered(&hole, &bright) else { return };
    for (i, value) in pixels.iter().enumerate() {
        let wanted = if at(i) == (20, 20) { 0.0 } else { 2.0 };
        assert!((value[0] - wanted).abs() < 1e-4, "{value:?} for {wanted} beside what sees nothing");
    }

    // 1 m below the camera: the depths of neighbouring rows differ by far more than any threshold.
    let floor = |_: u32, y: u32| {
        let down = ((y as f32 + 0.5) / SIDE as f32 * 2.0 - 1.0) * 0.4f32.tan();
        if down > 0.02 { (1.0 / down, [0.0, 1.0, 0.0]) } else { (0.0, [0.0; 3]) }
    };
    let stripes = |_: u32, y: u32| [(y % 2) as f32; 4];
    let Some(pixels) = filtered(&floor, &stripes) else { return };
    for x in 16..32 {
        let value = pixels[(36 * SIDE + x) as usize];
        assert!((value[0] - 0.5).abs() < 0.05, "stripes remain on a floor: {value:?}");
    }
}
