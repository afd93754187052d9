//! Faults of rendered pictures: values that are not finite, and pictures in which nothing is seen.

use crate::output::stderr;
use anyhow::{Result, bail};
use metrics::Image;
use renderer::Renderer;

/// The pixels of all pictures that are not finite.
#[derive(Default)]
pub(super) struct Broken {
    /// The first of them, in words.
    first: Option<String>,
    /// The number of them.
    pub(super) pixels: usize,
    /// The number of pictures that have them.
    pictures: usize,
}

impl Broken {
    /// Adds those of a picture of an output.
    pub(super) fn look(&mut self, picture: &Image, output: &str, frame: u32) {
        let is_broken = |pixel: &[f32; 4]| !pixel.iter().all(|value| value.is_finite());
        let count = picture.pixels().iter().filter(|pixel| is_broken(pixel)).count();
        let Some(first) = picture.pixels().iter().position(is_broken) else { return };
        let [r, g, b, _] = picture.pixels()[first];
        let (x, y) = (first % picture.width(), first / picture.width());
        self.first.get_or_insert_with(|| {
            format!("the first is ({x}, {y}) of `{output}` in frame {frame}, which has ({r}, {g}, {b})")
        });
        self.pixels += count;
        self.pictures += 1;
    }

    /// Fails if there are such pixels. The pictures have been written: they show where.
    pub(super) fn result(&self) -> Result<()> {
        let Some(first) = &self.first else { return Ok(()) };
        let pixels = if self.pixels == 1 { "1 pixel is" } else { "pixels are" };
        let counted = if self.pixels == 1 { pixels.to_owned() } else { format!("{} {pixels}", self.pixels) };
        let of = if self.pictures == 1 { String::new() } else { format!(" in {} pictures", self.pictures) };
        bail!("{counted} not finite{of}: {first}; --poison and --output PASS find the pass that makes them")
    }
}

/// Prints why a picture of light is black, if that is known.
pub(super) fn explain_black(renderer: &Renderer, picture: &Image, output: &str) {
    let is_black = picture.pixels().iter().all(|pixel| pixel[..3] == [0.0; 3]);
    if !is_black || !["image", "display"].contains(&output) {
        return;
    }
    let (scene, pose) = (renderer.scene(), renderer.pose());
    let (width, height) = renderer.size();
    let origin = scene.origin;
    let point = |at: glam::Vec3| {
        // To the digits of the numbers that the scene was given in.
        let at = (at.as_dvec3() + origin).as_vec3();
        format!("({}, {}, {})", at.x, at.y, at.z)
    };
    let (low, high) = scene.bounds();
    // A scene as small as this is seen by no pixel's centre, or by chance.
    let corners = (0..8u32).map(|i| {
        let take = |axis: u32| i >> axis & 1 == 1;
        let corner = glam::BVec3::new(take(0), take(1), take(2));
        pose.camera.project(glam::Vec3::select(corner, high, low), [width, height])
    });
    let corners: Option<Vec<glam::Vec2>> = corners.collect();
    let is_small = corners.is_some_and(|corners| {
        let far = |from: &glam::Vec2| corners.iter().any(|to| from.distance(*to) > 1.0);
        !corners.iter().any(far)
    });
    if !is_small && scene.is_in_view(pose, width as f32 / height as f32) {
        stderr!("note: the picture is black: no light reaches what is seen");
    } else {
        stderr!(
            "note: nothing is seen: the camera at {} looks at {}, and the scene lies within {} to {} m{}",
            point(pose.camera.position),
            point(pose.camera.target),
            point(low),
            point(high),
            if is_small { ", which is less than a pixel" } else { "" }
        );
    }
}
