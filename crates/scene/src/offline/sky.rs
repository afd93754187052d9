//! Light from infinitely far, in the forms of offline renderers.

use std::f64::consts::{PI, TAU};
use std::path::PathBuf;

use data_file::Span;
use glam::{DMat3, DVec2, DVec3, Vec3};

use super::report::{Report, error};
use crate::codes;
use crate::environment::Environment;
use crate::error::SceneError;
use crate::light::BRIGHTEST;

/// The samples along each side of a texel when a map takes another form.
const SAMPLES: u32 = 4;

/// Light from infinitely far.
pub(super) enum Sky {
    /// The same radiance from everywhere \[W/(m² sr)\].
    Uniform(Vec3),
    /// A map of radiance.
    Map {
        file: PathBuf,
        factor: Vec3,
        form: Form,
        /// To the world of the file.
        transform: DMat3,
    },
}

/// The form of a map.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Form {
    /// By longitude and latitude about +y, as Mitsuba has it: the first column is −z, a quarter of the row on +x.
    LongitudeLatitude,
    /// The square of equal areas of pbrt-v4 (Clarberg 2008), with +z in its middle.
    EqualArea,
}

impl Sky {
    /// Returns the environment of a scene that is the world of the file, mirrored.
    pub(super) fn environment(
        &self,
        mirror: DVec3,
        span: &Span,
        report: &mut Report<'_>,
    ) -> Result<Environment, SceneError> {
        let (file, factor, form, transform) = match self {
            Sky::Uniform(radiance) => {
                let clamped = radiance.clamp(Vec3::ZERO, Vec3::splat(BRIGHTEST));
                if clamped != *radiance {
                    report.note(span, "the radiance is not within 0 to 10³⁰ and is taken as the nearer");
                }
                return Ok(Environment::uniform(clamped.into()));
            }
            Sky::Map { file, factor, form, transform } => (file, factor, *form, transform),
        };
        let wrong = |problem: String| error(&codes::MAP, span, problem, "this map");
        let mut map = Environment::read(file, factor.to_array()).map_err(wrong)?;
        if form == Form::EqualArea && map.width != map.height {
            return Err(wrong(format!(
                "{}: a map of pbrt-v4 must be a square of equal areas; found {} x {} pixels",
                file.display(),
                map.width,
                map.height
            )));
        }
        if let Some((width, height)) = map.shrink() {
            report.note(
                span,
                format!(
                    "the map is reduced from {width} x {height} to {} x {} pixels",
                    map.width, map.height
                ),
            );
        }
        let to_map = transform.inverse() * DMat3::from_diagonal(mirror);
        if !to_map.is_finite() {
            return Err(error(&codes::RANGE, span, "the transform of the map has no inverse", "this map"));
        }
        if form == Form::LongitudeLatitude
            && let Some(rotation) = turn(to_map)
        {
            return Ok(Environment { rotation, ..map });
        }
        report.take(2 * map.texels.len(), size_of::<[f32; 3]>(), span)?;
        Ok(resampled(&map, form, to_map))
    }
}

/// Returns the angle by which a map of Mitsuba is turned in a scene, if all that its transform does is to turn it about +y.
fn turn(to_map: DMat3) -> Option<f32> {
    let x = to_map.x_axis;
    let turned = DMat3::from_rotation_y((-x.z).atan2(x.x));
    // The first column of the map is what the middle one is in an environment.
    let angle = (-(-x.z).atan2(x.x) + PI).rem_euclid(TAU);
    to_map.abs_diff_eq(turned, 1e-6).then_some(angle as f32)
}

/// Returns a map by longitude and latitude, each texel of which is the mean of what another map has there.
fn resampled(map: &Environment, form: Form, to_map: DMat3) -> Environment {
    let (width, height) = match form {
        Form::LongitudeLatitude => (map.width, map.height),
        Form::EqualArea => (2 * map.width, map.height),
    };
    let texel = |x: u32, y: u32| {
        let mut sum = DVec3::ZERO;
        for (i, j) in (0..SAMPLES).flat_map(|i| (0..SAMPLES).map(move |j| (i, j))) {
            let place = |at: u32, sample: u32| f64::from(at) + (f64::from(sample) + 0.5) / f64::from(SAMPLES);
            let longitude = TAU * (place(x, i) / f64::from(width) - 0.5);
            let (level, up) = (PI * place(y, j) / f64::from(height)).sin_cos();
            let direction = DVec3::new(level * longitude.sin(), up, -level * longitude.cos());
            let [u, v] = form.place((to_map * direction).normalize_or(DVec3::Z));
            let at = |place: f64, count: u32| ((place * f64::from(count)) as u32).min(count - 1);
            let index = at(v, map.height) as usize * map.width as usize + at(u, map.width) as usize;
            sum += DVec3::from(map.texels[index].map(f64::from));
        }
        (sum / f64::from(SAMPLES * SAMPLES)).as_vec3().to_array()
    };
    let texels =
        (0..height).flat_map(|y| (0..width).map(move |x| (x, y))).map(|(x, y)| texel(x, y)).collect();
    Environment { width, height, texels, rotation: 0.0 }
}

impl Form {
    /// Returns the place of a direction in the map, from 0 to 1 to the right and down.
    fn place(self, direction: DVec3) -> [f64; 2] {
        match self {
            Form::LongitudeLatitude => {
                let u = direction.x.atan2(-direction.z) / TAU;
                [u.rem_euclid(1.0), direction.y.clamp(-1.0, 1.0).acos() / PI]
            }
            Form::EqualArea => equal_area(direction),
        }
    }
}

/// Returns the place of a unit direction in the square of equal areas [Clarberg 2008; pbrt-v4, `EqualAreaSphereToSquare`].
fn equal_area(direction: DVec3) -> [f64; 2] {
    let DVec3 { x, y, z } = direction.abs();
    let radius = (1.0 - z).max(0.0).sqrt();
    let (longer, shorter) = (x.max(y), x.min(y));
    let angle = if longer == 0.0 { 0.0 } else { (shorter / longer).atan() * 2.0 / PI };
    let angle = if x < y { 1.0 - angle } else { angle };
    let v = angle * radius;
    let mut at = DVec2::new(radius - v, v);
    if direction.z < 0.0 {
        at = DVec2::ONE - DVec2::new(at.y, at.x);
    }
    let signed = at * DVec2::new(1_f64.copysign(direction.x), 1_f64.copysign(direction.y));
    ((signed + 1.0) * 0.5).to_array()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_square_of_equal_areas_has_equal_areas() {
        for (direction, expected) in [
            (DVec3::Z, [0.5, 0.5]),
            (DVec3::X, [1.0, 0.5]),
            (DVec3::NEG_X, [0.0, 0.5]),
            (DVec3::Y, [0.5, 1.0]),
            (DVec3::NEG_Y, [0.5, 0.0]),
        ] {
            let found = equal_area(direction);
            assert!(
                (found[0] - expected[0]).abs() + (found[1] - expected[1]).abs() < 1e-12,
                "{direction}: {found:?}"
            );
        }
        // Directions spread evenly over the sphere are spread evenly over the square.
        let mut counts = [0; 64];
        let count = 64_000;
        for i in 0..count {
            let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
            let angle = f64::from(i) * PI * (3.0 - 5_f64.sqrt());
            let level = (1.0 - z * z).sqrt();
            let [u, v] = equal_area(DVec3::new(level * angle.cos(), level * angle.sin(), z));
            counts[(v * 8.0) as usize * 8 + (u * 8.0) as usize] += 1;
        }
        assert!(counts.iter().all(|in_cell| (in_cell - 1000_i32).abs() < 60), "{counts:?}");
    }

    /// A map in which each texel has its own value.
    fn numbered(width: u32, height: u32) -> Environment {
        let texels = (0..width * height).map(|i| [i as f32, 0.0, 0.0]).collect();
        Environment { width, height, texels, rotation: 0.0 }
    }

    /// Returns the value of an environment in a direction, by what its fields are documented to mean.
    fn seen(environment: &Environment, direction: DVec3) -> f32 {
        let unturned = DMat3::from_rotation_y(-f64::from(environment.rotation)) * direction;
        let u = 0.5 + unturned.x.atan2(-unturned.z) / TAU;
        let v = unturned.y.acos() / PI;
        let at = |place: f64, count: u32| ((place.rem_euclid(1.0) * f64::from(count)) as u32).min(count - 1);
        environment.texels
            [(at(v, environment.height) * environment.width + at(u, environment.width)) as usize][0]
    }

    #[test]
    fn a_map_that_is_turned_is_not_resampled() {
        let map = numbered(16, 8);
        for degrees in [0.0_f64, 45.0, 100.0, -135.0] {
            let to_map = DMat3::from_rotation_y(degrees.to_radians()).inverse();
            let rotation = turn(to_map).expect("a turn");
            let turned = Environment { rotation, ..map.clone() };
            for direction in
                [DVec3::new(1.0, 0.3, 0.2), DVec3::new(-0.4, -0.5, 0.6), DVec3::new(0.1, 0.2, -0.9)]
            {
                let direction = direction.normalize();
                let [u, v] = Form::LongitudeLatitude.place(to_map * direction);
                let expected = map.texels[((v * 8.0) as u32 * 16 + (u * 16.0) as u32) as usize][0];
                assert_eq!(seen(&turned, direction), expected, "{degrees}: {direction}");
            }
        }
        assert_eq!(turn(DMat3::from_rotation_x(0.5)), None);
        assert_eq!(turn(DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0))), None);
    }

    #[test]
    fn a_map_in_another_form_has_the_same_light_from_everywhere() {
        let to_map = DMat3::from_rotation_x(0.7) * DMat3::from_diagonal(DVec3::new(1.0, 1.0, -1.0));
        let smooth = |direction: DVec3| 2.0 + direction.dot(DVec3::new(0.3, -0.8, 0.5));
        for form in [Form::LongitudeLatitude, Form::EqualArea] {
            let (width, height) = if form == Form::EqualArea { (64, 64) } else { (128, 64) };
            let mut map = numbered(width, height);
            // What is nearest to each texel, by search.
            let mut nearest = vec![(f64::MAX, 0.0); map.texels.len()];
            for i in 0..400_000 {
                let z = 1.0 - (2.0 * f64::from(i) + 1.0) / 400_000.0;
                let angle = f64::from(i) * PI * (3.0 - 5_f64.sqrt());
                let level = (1.0 - z * z).sqrt();
                let direction = DVec3::new(level * angle.cos(), level * angle.sin(), z);
                let [u, v] = form.place(direction);
                let place = DVec2::new(u * f64::from(width), v * f64::from(height));
                let cell = place.floor().min(DVec2::new(f64::from(width - 1), f64::from(height - 1)));
                let index = (cell.y * f64::from(width) + cell.x) as usize;
                let off = (place - cell - 0.5).length();
                if off < nearest[index].0 {
                    nearest[index] = (off, smooth(direction));
                }
            }
            map.texels = nearest.iter().map(|(_, value)| [*value as f32, 0.0, 0.0]).collect();
            let made = resampled(&map, form, to_map);
            for direction in [DVec3::X, DVec3::Y, DVec3::NEG_Z, DVec3::new(-0.5, 0.5, 0.7).normalize()] {
                let (found, expected) = (seen(&made, direction), smooth(to_map * direction) as f32);
                // A texel of either map is up to 0.05 rad high, over which the light changes by as much.
                assert!((found - expected).abs() < 0.1, "{direction}: {found}, not {expected}");
            }
        }
    }
}
