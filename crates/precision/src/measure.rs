//! Errors of `f32` over a range of magnitudes, beside those that no formula avoids.

use crate::interpret::Fault;
use crate::probe::{Compared, Probe};
use crate::value::Value;

/// The greatest error of rounding one number to `f32`, relative to it: half a unit in the last place.
pub const ROUNDING: f64 = 1.0 / 16_777_216.0;

/// The share of samples that may be on the other side of a branch: they are not judged.
pub(crate) const MOST_LOST: f64 = 0.01;

/// Number of random roundings of the inputs from which the unavoidable error is measured.
const CHANGES: u64 = 4;

/// Computes a probe in `f32`: the interpreter, or a GPU.
pub trait Evaluator {
    /// Returns the name of the device or program, for the report.
    fn name(&self) -> String;

    /// Returns the result for each of the inputs.
    ///
    /// # Errors
    /// Fails if it cannot be computed.
    fn evaluate(&self, probe: &Probe, given: &[Value<f32>]) -> Result<Vec<[f32; 4]>, Fault>;
}

/// Computes in `f32` by the interpreter: each operation is rounded once, and none are contracted.
#[derive(Clone, Copy, Debug, Default)]
pub struct Interpreted;

impl Evaluator for Interpreted {
    fn name(&self) -> String {
        "interpreter".to_owned()
    }

    fn evaluate(&self, probe: &Probe, given: &[Value<f32>]) -> Result<Vec<[f32; 4]>, Fault> {
        let one = |given: &Value<f32>| Ok(probe.interpret::<f32>(given)?.map(|x| x as f32));
        given.iter().map(one).collect()
    }
}

/// Options of a measurement.
#[derive(Clone, Copy, Debug)]
pub struct Options {
    /// Number of magnitudes, at equal ratios.
    pub magnitudes: usize,
    /// Samples of each magnitude, unless the probe has fewer.
    pub samples: usize,
    /// Seed of the random numbers.
    pub seed: u64,
}

impl Default for Options {
    fn default() -> Self {
        Options { magnitudes: 33, samples: 128, seed: 0 }
    }
}

/// Relative errors of the samples of a magnitude.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// The median.
    pub median: f64,
    /// The 99th percentile: the rest are samples on the other side of a branch.
    pub most: f64,
}

impl Errors {
    fn of(mut errors: Vec<f64>) -> Errors {
        errors.sort_by(f64::total_cmp);
        // The least that as many samples do not exceed.
        let at = |share: f64| {
            let count = (share * errors.len() as f64).ceil() as usize;
            errors.get(count.max(1) - 1).copied().unwrap_or(0.0)
        };
        Errors { median: at(0.5), most: at(1.0 - MOST_LOST) }
    }
}

/// A magnitude with its errors.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// The magnitude.
    pub magnitude: f64,
    /// Errors of the results in `f32`.
    pub errors: Errors,
    /// Errors of results in `f64` that are rounded to `f32`, from inputs that are off by the rounding of `f32`.
    pub unavoidable: Errors,
    /// The share of samples that are lost: their error is infinite, since the result in `f32` is infinite or no number, or is not 0
    /// where it should be.
    pub lost: f64,
}

impl Point {
    /// Returns the error over the unavoidable one. Where that is infinite, as at a jump, nothing exceeds it.
    pub fn ratio(&self) -> f64 {
        if self.unavoidable.most.is_finite() { self.errors.most / self.unavoidable.most } else { 0.0 }
    }
}

/// A probe with its errors.
#[derive(Clone, Debug)]
pub struct Measured {
    /// The probe.
    pub probe: Probe,
    /// From the least magnitude to the greatest.
    pub points: Vec<Point>,
}

impl Measured {
    /// Returns the error that is demanded at a point.
    pub fn demanded(&self, point: &Point) -> f64 {
        self.probe.bound * point.unavoidable.most
    }

    /// Returns the point where the error is greatest as a multiple of the unavoidable one.
    pub fn worst(&self) -> Option<&Point> {
        self.points.iter().max_by(|a, b| a.ratio().total_cmp(&b.ratio()))
    }

    /// Returns whether the errors of all magnitudes are as demanded.
    pub fn holds(&self) -> bool {
        self.points.iter().all(|point| point.errors.most <= self.demanded(point))
    }
}

/// Measures a probe.
///
/// # Errors
/// Fails if it cannot be computed.
pub fn measure(probe: &Probe, evaluator: &dyn Evaluator, options: &Options) -> Result<Measured, Fault> {
    let samples = options.samples.min(probe.most_samples).max(1);
    let count = options.magnitudes.max(2);
    let (low, high) = (probe.range.0.ln(), probe.range.1.ln());
    let mut random = fastrand::Rng::with_seed(options.seed);
    // `f32` has multiples of 2^-24.
    let mut number = || f64::from(random.u32(..1 << 24)) * ROUNDING;
    let mut magnitudes = Vec::with_capacity(count);
    let mut given = Vec::with_capacity(count * samples);
    for i in 0..count {
        let magnitude = (low + (high - low) * i as f64 / (count - 1) as f64).exp();
        magnitudes.push(f64::from(magnitude as f32));
        for _ in 0..samples {
            given.push(probe.given(f64::from(magnitude as f32), std::array::from_fn(|_| number()))?);
        }
    }
    let results = evaluator.evaluate(probe, &given)?;
    if results.len() != given.len() {
        return Err(Fault::new(format!("{} results of {} inputs came back", results.len(), given.len())));
    }
    let mut points = Vec::with_capacity(count);
    for (magnitude, (given, results)) in
        magnitudes.into_iter().zip(given.chunks(samples).zip(results.chunks(samples)))
    {
        let mut errors = Vec::with_capacity(samples);
        let mut unavoidable = Vec::with_capacity(samples);
        for (given, result) in given.iter().zip(results) {
            let exact = given.map_floats(&mut |x| f64::from(x));
            let expected = probe.interpret::<f64>(&exact)?;
            let result = result.map(f64::from);
            errors.push(error(probe.compared, expected, result));
            let mut most: f64 = 0.0;
            for _ in 0..CHANGES {
                let changed = given.map_floats(&mut |x| changed(x, number() < 0.5));
                most = most.max(error(probe.compared, expected, probe.interpret::<f64>(&changed)?));
            }
            unavoidable.push(most + ROUNDING);
        }
        let lost = errors.iter().filter(|error| error.is_infinite()).count() as f64 / samples as f64;
        points.push(Point {
            magnitude,
            errors: Errors::of(errors),
            unavoidable: Errors::of(unavoidable),
            lost,
        });
    }
    Ok(Measured { probe: probe.clone(), points })
}

/// A number that rounds to `x`, or nearly so: half a unit in its last place away from it.
fn changed(x: f32, up: bool) -> f64 {
    let next = f32::from_bits(x.to_bits() + 1);
    if x == 0.0 || !next.is_finite() {
        return f64::from(x);
    }
    let half = 0.5 * (f64::from(next) - f64::from(x));
    if up { f64::from(x) + half } else { f64::from(x) - half }
}

/// The error of a result, relative to what is expected.
fn error(compared: Compared, expected: [f64; 4], result: [f64; 4]) -> f64 {
    let relative = |difference: f64, whole: f64| {
        if difference == 0.0 {
            0.0
        } else if difference.is_finite() && whole > 0.0 {
            difference / whole
        } else {
            f64::INFINITY
        }
    };
    match compared {
        Compared::Components => {
            let pairs = expected.iter().zip(result);
            pairs
                .map(|(expected, result)| relative((result - expected).abs(), expected.abs()))
                .fold(0.0, f64::max)
        }
        Compared::Vector => {
            // The squares of numbers of f32 are within the range of f64.
            let length = |v: [f64; 4]| v.iter().map(|x| x * x).sum::<f64>().sqrt();
            let difference = std::array::from_fn(|i| result[i] - expected[i]);
            relative(length(difference), length(expected))
        }
    }
}
