//! Whether two pictures are of the same camera.

use crate::image::{is_finite, luminance};
use crate::statistics::median;
use crate::{Image, Pair};
use std::fmt;

/// The longer side of the pictures that are compared \[px\]: noise of single pixels is averaged away.
const SIDE: usize = 64;
/// The farthest that a picture is moved, in pixels of that size.
const FARTHEST: i32 = 4;
/// Pictures of one view have at least this correlation, however noisy they are.
const LEAST: f64 = 0.3;
/// The least by which another alignment must be better.
const BETTER: f64 = 0.02;

/// A sign that a picture is not of the camera of its reference.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Misalignment {
    /// It is the reference's mirror image.
    Mirrored {
        /// Left and right are exchanged.
        x: bool,
        /// Top and bottom are exchanged.
        y: bool,
    },
    /// It is the reference, moved by about so many pixels.
    Moved {
        /// To the right.
        x: i32,
        /// Downwards.
        y: i32,
    },
    /// It has little in common with the reference: the correlation.
    Unlike(f64),
}

impl fmt::Display for Misalignment {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Misalignment::Mirrored { x: true, y: true } => {
                f.write_str("it fits the reference when turned by 180°")
            }
            Misalignment::Mirrored { x: true, .. } => {
                f.write_str("it fits the reference when mirrored left to right")
            }
            Misalignment::Mirrored { .. } => f.write_str("it fits the reference when turned upside down"),
            Misalignment::Moved { x, y } => {
                write!(f, "it fits the reference better when moved by about ({}, {}) px", -x, -y)
            }
            Misalignment::Unlike(correlation) => {
                write!(f, "it has little in common with the reference: their correlation is {correlation:.2}")
            }
        }
    }
}

/// Looks for signs that a picture is not of the camera of its reference; `None` where there are none, or where either picture
/// is of one color. O(pixels).
pub fn misalignment(pair: &Pair<'_>) -> Option<Misalignment> {
    let [found, reference] = [pair.image(), pair.reference()].map(Levels::of);
    let as_it_is = found.correlation(&reference, |x, y| (x, y))?;
    let (width, height) = (found.width - 1, found.height - 1);
    let mirrors = [(true, false), (false, true), (true, true)].map(|(x, y)| {
        let place = move |i, j| (if x { width - i } else { i }, if y { height - j } else { j });
        (Misalignment::Mirrored { x, y }, found.correlation(&reference, place))
    });
    let steps = (-FARTHEST..=FARTHEST).flat_map(|y| (-FARTHEST..=FARTHEST).map(move |x| (x, y)));
    let moved = steps.filter(|step| *step != (0, 0)).map(|(x, y)| {
        let size = found.step as i32;
        let there = found.correlation(&reference, |i, j| (i + x, j + y));
        (Misalignment::Moved { x: x * size, y: y * size }, there)
    });
    let all = mirrors.into_iter().chain(moved).filter_map(|(how, correlation)| Some((how, correlation?)));
    let best = all.max_by(|a, b| a.1.total_cmp(&b.1));
    match best {
        // What another alignment leaves is less than half of what is left now.
        Some((how, better)) if better > as_it_is + BETTER && 1.0 - better < 0.5 * (1.0 - as_it_is) => {
            Some(how)
        }
        _ => (as_it_is < LEAST).then_some(Misalignment::Unlike(as_it_is)),
    }
}

/// Tone-mapped luminance in few pixels.
struct Levels {
    width: i32,
    height: i32,
    /// Pixels of the picture in one of these.
    step: usize,
    values: Vec<f64>,
}

impl Levels {
    fn of(image: &Image) -> Levels {
        let (width, height) = (image.width(), image.height());
        let step = width.max(height).div_ceil(SIDE);
        let grey = |pixel: &[f32; 4]| {
            if is_finite(*pixel) {
                f64::from(luminance([pixel[0], pixel[1], pixel[2]])).max(0.0)
            } else {
                0.0
            }
        };
        // What is brighter than most is noise, or a lamp: it is not to outweigh all else.
        let mut levels: Vec<f64> = image.pixels().iter().map(grey).filter(|level| *level > 0.0).collect();
        let middle = median(&mut levels).unwrap_or(1.0);
        let (columns, rows) = (width.div_ceil(step), height.div_ceil(step));
        let mut sums = vec![(0.0, 0.0); columns * rows];
        for (index, pixel) in image.pixels().iter().enumerate() {
            let (sum, count) = &mut sums[index / width / step * columns + index % width / step];
            let level = grey(pixel);
            (*sum, *count) = (*sum + level / (level + middle), *count + 1.0);
        }
        let values = sums.into_iter().map(|(sum, count)| sum / count).collect();
        Levels { width: columns as i32, height: rows as i32, step, values }
    }

    /// Returns the correlation with a reference whose pixel (x, y) is at `place` here; `None` where either has one level.
    fn correlation(&self, reference: &Levels, place: impl Fn(i32, i32) -> (i32, i32)) -> Option<f64> {
        let mut pairs = Vec::with_capacity(self.values.len());
        for (y, x) in (0..self.height).flat_map(|y| (0..self.width).map(move |x| (y, x))) {
            let (i, j) = place(x, y);
            if (0..self.width).contains(&i) && (0..self.height).contains(&j) {
                let at = |x: i32, y: i32| (y * self.width + x) as usize;
                pairs.push((self.values[at(i, j)], reference.values[at(x, y)]));
            }
        }
        let count = pairs.len() as f64;
        let (a, b) = pairs.iter().fold((0.0, 0.0), |sum, pair| (sum.0 + pair.0, sum.1 + pair.1));
        let (a, b) = (a / count, b / count);
        let of =
            |term: fn(f64, f64) -> f64| pairs.iter().map(|pair| term(pair.0 - a, pair.1 - b)).sum::<f64>();
        let (own, other) = (of(|a, _| a * a), of(|_, b| b * b));
        (own.min(other) > 1e-12 * count).then(|| of(|a, b| a * b) / (own * other).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A picture of a slanted step and a spot, seen by a camera that is moved or mirrored.
    fn view(place: impl Fn(i32, i32) -> (i32, i32), noise: u32) -> Image {
        let mut state = 1_u32;
        let mut pixel = |x: i32, y: i32| {
            let (x, y) = place(x, y);
            state = state.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            let step = if 2 * x + y > 100 { 1.0 } else { 0.2 };
            let spot = if (x - 20).pow(2) + (y - 25).pow(2) < 60 { 4.0 } else { 0.0 };
            // One of `noise` pixels is a hundred times as bright.
            let firefly = if noise > 0 && (state >> 16).is_multiple_of(noise) { 100.0 } else { 1.0 };
            let level = (step + spot) * firefly;
            [level, level, level, 1.0]
        };
        Image::new(
            80,
            60,
            (0..60).flat_map(|y| (0..80).map(move |x| (x, y))).map(|(x, y)| pixel(x, y)).collect(),
        )
        .unwrap()
    }

    fn of(image: &Image) -> Option<Misalignment> {
        let reference = view(|x, y| (x, y), 0);
        misalignment(&Pair::new(image, &reference).unwrap())
    }

    #[test]
    fn cameras_that_are_moved_or_mirrored_are_noticed() {
        assert_eq!(of(&view(|x, y| (x, y), 0)), None);
        assert_eq!(of(&view(|x, y| (x, y), 8)), None, "noise is none");
        assert_eq!(of(&view(|x, y| (79 - x, y), 0)), Some(Misalignment::Mirrored { x: true, y: false }));
        assert_eq!(of(&view(|x, y| (x, 59 - y), 8)), Some(Misalignment::Mirrored { x: false, y: true }));
        assert_eq!(of(&view(|x, y| (79 - x, 59 - y), 0)), Some(Misalignment::Mirrored { x: true, y: true }));
        let moved = of(&view(|x, y| (x - 4, y + 2), 0)).unwrap();
        assert_eq!(moved.to_string(), "it fits the reference better when moved by about (-4, 2) px");
        let turned = of(&view(|x, y| (y, x / 2), 0));
        assert!(matches!(turned, Some(Misalignment::Unlike(_))), "{turned:?}");
    }

    #[test]
    fn a_picture_of_one_color_says_nothing() {
        let flat = Image::new(80, 60, vec![[1.0; 4]; 4800]).unwrap();
        assert_eq!(of(&flat), None);
    }
}
