//! Values that change over time.

use glam::{Quat, Vec3};
use serde::Serialize;

/// The value of a track outside its keys.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) enum Outside {
    /// The value of the first or last key.
    Hold,
    /// The track repeats with this period \[s\].
    Repeat(f32),
}

/// Interpolation between the keys of a track.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) enum Between<T> {
    /// The value of the earlier key.
    Step,
    /// Linear; for rotations along the shorter arc.
    Linear,
    /// Cubic Hermite, with the slopes \[1/s\] into and out of each key.
    Cubic(Vec<[T; 2]>),
}

/// Keys at rising times \[s\]; never empty.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct Track<T> {
    pub(crate) keys: Vec<(f32, T)>,
    pub(crate) between: Between<T>,
    pub(crate) outside: Outside,
}

/// A type whose values can be interpolated.
pub(crate) trait Animated: Copy + PartialEq {
    fn is_finite(self) -> bool;
    fn linear(self, to: Self, t: f32) -> Self;
    /// Returns the sum, weighted by `weights`, of: this value, its slope, the next value, the next slope.
    fn blend(values: [Self; 4], weights: [f32; 4]) -> Self;
}

impl Animated for f32 {
    fn is_finite(self) -> bool {
        f32::is_finite(self)
    }

    fn linear(self, to: Self, t: f32) -> Self {
        self + (to - self) * t
    }

    fn blend(values: [Self; 4], weights: [f32; 4]) -> Self {
        values.into_iter().zip(weights).map(|(v, w)| v * w).sum()
    }
}

impl Animated for Vec3 {
    fn is_finite(self) -> bool {
        Vec3::is_finite(self)
    }

    fn linear(self, to: Self, t: f32) -> Self {
        self.lerp(to, t)
    }

    fn blend(values: [Self; 4], weights: [f32; 4]) -> Self {
        values.into_iter().zip(weights).map(|(v, w)| v * w).sum()
    }
}

impl Animated for Quat {
    fn is_finite(self) -> bool {
        Quat::is_finite(self)
    }

    fn linear(self, to: Self, t: f32) -> Self {
        self.slerp(to, t).normalize()
    }

    fn blend(values: [Self; 4], weights: [f32; 4]) -> Self {
        let sum = values
            .into_iter()
            .zip(weights)
            .fold(glam::Vec4::ZERO, |sum, (v, w)| sum + glam::Vec4::from(v) * w);
        Quat::from_vec4(sum.normalize_or(glam::Vec4::W))
    }
}

impl<T: Animated> Track<T> {
    /// Creates a track through `keys`. Returns the reason as an error if there are no keys, their times do
    /// not rise, or their numbers are not finite.
    pub(crate) fn new(keys: Vec<(f32, T)>, between: Between<T>, outside: Outside) -> Result<Self, String> {
        if keys.is_empty() {
            return Err("it has no keys".into());
        }
        if let Some(i) = keys.iter().position(|(time, value)| !time.is_finite() || !value.is_finite()) {
            return Err(format!("key {i} is not finite"));
        }
        if let Some(i) = keys.windows(2).position(|pair| pair[1].0 <= pair[0].0) {
            return Err(format!("key {} is not later than the key before it", i + 1));
        }
        if let Between::Cubic(slopes) = &between
            && (slopes.len() != keys.len() || slopes.iter().flatten().any(|s| !s.is_finite()))
        {
            return Err("its tangents are not finite".into());
        }
        Ok(Track { keys, between, outside })
    }

    /// Returns the value at `time` \[s\].
    pub(crate) fn at(&self, time: f32) -> T {
        let time = match self.outside {
            Outside::Repeat(period) if period > 0.0 && time.is_finite() => time.rem_euclid(period),
            _ => time,
        };
        // The first key later than `time`; if `time` is NaN, this is the first key.
        let next = self.keys.partition_point(|(t, _)| *t <= time);
        let Some(&(t1, after)) = self.keys.get(next) else { return self.keys[self.keys.len() - 1].1 };
        let Some(&(t0, before)) = next.checked_sub(1).and_then(|i| self.keys.get(i)) else { return after };
        let (dt, t) = (t1 - t0, (time - t0) / (t1 - t0));
        match &self.between {
            Between::Step => before,
            Between::Linear => before.linear(after, t),
            Between::Cubic(slopes) => {
                let (t2, t3) = (t * t, t * t * t);
                T::blend(
                    [before, slopes[next - 1][1], after, slopes[next][0]],
                    [
                        2.0 * t3 - 3.0 * t2 + 1.0,
                        dt * (t3 - 2.0 * t2 + t),
                        3.0 * t2 - 2.0 * t3,
                        dt * (t3 - t2),
                    ],
                )
            }
        }
    }

    /// Returns the time of the last key \[s\].
    pub(crate) fn end(&self) -> f32 {
        self.keys[self.keys.len() - 1].0
    }

    /// Returns whether the value ever changes.
    pub(crate) fn moves(&self) -> bool {
        self.keys.iter().any(|(_, value)| *value != self.keys[0].1)
    }
}

impl Track<Vec3> {
    /// Creates a smooth track: Catmull-Rom for keys at any times. The slope at a key is that between the keys
    /// before and after it; at the ends, that to the only neighbour.
    pub(crate) fn smooth(keys: Vec<(f32, Vec3)>, outside: Outside) -> Result<Self, String> {
        let slopes = (0..keys.len())
            .map(|i| {
                let (a, b) = (keys[i.saturating_sub(1)], keys[(i + 1).min(keys.len() - 1)]);
                [if b.0 > a.0 { (b.1 - a.1) / (b.0 - a.0) } else { Vec3::ZERO }; 2]
            })
            .collect();
        Track::new(keys, Between::Cubic(slopes), outside)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_smooth_track_meets_its_keys_and_reproduces_a_line() {
        let keys: Vec<_> = [0.0, 1.0, 1.5, 4.0].map(|t| (t, Vec3::new(2.0 * t, 1.0 - t, 0.5))).to_vec();
        let track = Track::smooth(keys.clone(), Outside::Hold).unwrap();
        for (t, value) in keys {
            assert!(track.at(t).abs_diff_eq(value, 1e-6), "the key at {t} s");
        }
        for t in [0.3f32, 1.2, 3.9] {
            assert!(track.at(t).abs_diff_eq(Vec3::new(2.0 * t, 1.0 - t, 0.5), 1e-5), "the line at {t} s");
        }
        assert_eq!(track.at(-1.0), track.at(0.0), "holds before");
        assert_eq!(track.at(9.0), track.at(4.0), "holds after");
        assert!(track.at(f32::NAN).is_finite(), "any time gives a value");
    }

    #[test]
    fn a_repeating_track_repeats_and_slopes_match_gltf() {
        // CUBICSPLINE of glTF 2.0, appendix C: p(t) with values 0, 1 and slopes 0 is the smooth step.
        let between = Between::Cubic(vec![[Vec3::ZERO; 2]; 2]);
        let track =
            Track::new(vec![(0.0, Vec3::ZERO), (2.0, Vec3::ONE)], between, Outside::Repeat(2.0)).unwrap();
        let t = 0.25f32;
        let smoothstep = 3.0 * t * t - 2.0 * t * t * t;
        assert!((track.at(0.5).x - smoothstep).abs() < 1e-6, "smooth step");
        assert!((track.at(4.5).x - smoothstep).abs() < 1e-6, "two periods later");
        assert!((track.at(-1.5).x - smoothstep).abs() < 1e-6, "a period earlier");
    }

    #[test]
    fn keys_that_make_no_track_are_refused() {
        fn check<T: Animated + std::fmt::Debug>(value: T, infinite: T) {
            let equal = vec![(0.0, value), (0.0, value)];
            for keys in [vec![], equal, vec![(f32::NAN, value)], vec![(0.0, infinite)]] {
                assert!(Track::new(keys.clone(), Between::Linear, Outside::Hold).is_err(), "{keys:?}");
            }
            let with =
                |slope| Track::new(vec![(0.0, value)], Between::Cubic(vec![[value, slope]]), Outside::Hold);
            assert!(with(value).is_ok() && with(infinite).is_err(), "{infinite:?}");
        }
        check(1.0, f32::INFINITY);
        check(Vec3::ONE, Vec3::INFINITY);
        check(Quat::IDENTITY, Quat::from_xyzw(0.0, 0.0, 0.0, f32::NAN));
    }
}
