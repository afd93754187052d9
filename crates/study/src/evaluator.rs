//! Takes measurements from the frames of a cell.

mod series;
mod times;

use crate::description::{Phase, StudyFigure};
use crate::error::Failure;
use crate::laboratory::{CellRun, Observed, Occluded, SceneFacts};
use crate::measure::Measure;
use crate::record::{FrameSeries, PassTime};
use crate::reference::Truth;
use metrics::temporal::{self, ErrorSeries, FrameError, TRACKED_PIXELS, Tid, View};
use metrics::virtual_lights::{self, Receiver};
use metrics::{
    DEFAULT_TRIM, Display, Epsilon, Image, Misalignment, PIXELS_PER_DEGREE, Pair, flip, hdr_flip, luminance,
    misalignment,
};
use series::Series;
use std::collections::BTreeMap;
use times::Times;

/// The greatest relative difference of depths that belong to the same surface.
const SAME_SURFACE: f64 = 0.01;
/// The share of the change that may remain when the light counts as converged after a jump, for the measure
/// `lag`.
const ARRIVED: f64 = 0.1;
/// Number of pixels for which it is tested which lights reach them.
const RECEIVERS: usize = 256;

/// Collects the measurements of the frames of one cell.
pub(crate) struct Evaluator<'a> {
    measures: &'a [Measure],
    figures: &'a [StudyFigure],
    /// The values of each figure, frame by frame.
    figure_values: Vec<Vec<f64>>,
    facts: &'a SceneFacts,
    /// Index of the frame of the jump among the measured ones.
    jump: Option<usize>,
    truth: Option<Truth>,
    pub(crate) frames: u32,
    /// Number of the first measured frame.
    first: u32,
    times: Times<'a>,
    series: Series,
    /// Errors of each frame that is compared with a reference.
    errors: BTreeMap<Measure, Vec<Option<f64>>>,
    tid: Tid,
    tid_of_reference: Tid,
    /// The reference of the last frame, where its temporal difference is measured.
    last_truth: Option<Image>,
    tracked: Vec<(usize, usize)>,
    /// Errors at the tracked pixels, and at all of them.
    tracked_errors: ErrorSeries,
    tone_errors: ErrorSeries,
    /// Mean luminance of each frame.
    luminances: Vec<f64>,
    /// Mean over RGB of each frame.
    means: Vec<f64>,
    pictures: Vec<Image>,
    moved: Vec<f64>,
    last: Option<Observed>,
    /// The first frame with pixels that are NaN or infinite.
    broken: Option<Failure>,
}

/// The measurements of a cell.
#[derive(Debug, Default)]
pub(crate) struct Measurements {
    pub(crate) measures: BTreeMap<String, Option<f64>>,
    pub(crate) passes: Vec<PassTime>,
    pub(crate) series: FrameSeries,
    pub(crate) frames: u32,
    pub(crate) image: Option<Image>,
    pub(crate) flip: Option<Image>,
    /// The reason why errors are missing.
    pub(crate) failure: Option<Failure>,
}

impl<'a> Evaluator<'a> {
    pub(crate) fn new(
        (measures, phases, figures): (&'a [Measure], &'a [Phase], &'a [StudyFigure]),
        facts: &'a SceneFacts,
        jump: Option<usize>,
        truth: Option<Truth>,
    ) -> Evaluator<'a> {
        Evaluator {
            measures,
            figures,
            figure_values: vec![Vec::new(); figures.len()],
            facts,
            jump,
            truth,
            frames: 0,
            first: 0,
            times: Times::new(phases),
            series: Series::default(),
            errors: BTreeMap::new(),
            tid: Tid::default(),
            tid_of_reference: Tid::default(),
            last_truth: None,
            tracked: Vec::new(),
            tracked_errors: ErrorSeries::default(),
            tone_errors: ErrorSeries::default(),
            luminances: Vec::new(),
            means: Vec::new(),
            pictures: Vec::new(),
            moved: Vec::new(),
            last: None,
            broken: None,
        }
    }

    fn wants(&self, measure: Measure) -> bool {
        self.measures.contains(&measure)
    }

    /// Adds the next measured frame.
    pub(crate) fn observe(&mut self, frame: Observed) -> Result<(), Failure> {
        if self.frames == 0 {
            self.first = frame.frame;
        }
        self.time(&frame);
        self.add_figures(&frame);
        if self.broken.is_none() {
            self.broken = Failure::check_finite(&frame.image, || format!("frame {}", frame.frame)).err();
        }
        if self.broken.is_none() {
            self.compare(&frame)?;
        }
        if self.wants(Measure::LightsMoved)
            && let (Some(before), Some(now)) =
                (self.last.as_ref().and_then(|last| last.lights.as_ref()), &frame.lights)
        {
            let moved = virtual_lights::share_of_lights_moved(before, now, self.facts.small_length);
            self.put(Measure::LightsMoved, moved);
            self.moved.extend(moved);
        }
        self.frames += 1;
        self.last = Some(frame);
        Ok(())
    }

    /// Adds a value of the current frame to the series, if the scene moves.
    fn put(&mut self, measure: Measure, value: Option<f64>) {
        if self.facts.moves {
            self.series.put(measure.key(), self.frames as usize, value);
        }
    }

    /// Adds the figures of a frame.
    fn add_figures(&mut self, frame: &Observed) {
        for (figure, values) in self.figures.iter().zip(&mut self.figure_values) {
            let value = frame.figures.iter().find(|(name, _)| *name == figure.of.value);
            let Some((_, value)) = value else { continue };
            values.push(*value);
            if self.facts.moves {
                self.series.put(&figure.key(), self.frames as usize, Some(*value));
            }
        }
    }

    fn time(&mut self, frame: &Observed) {
        self.times.add(&frame.passes);
        if frame.passes.is_empty() || !self.facts.moves {
            return;
        }
        if self.wants(Measure::GpuMs) {
            self.put(Measure::GpuMs, self.times.last_total());
        }
        for (key, ms) in self.times.last_phases() {
            self.series.put(&key, self.frames as usize, ms);
        }
    }

    /// Measures a frame in comparison with the frame before and with its reference.
    fn compare(&mut self, frame: &Observed) -> Result<(), Failure> {
        let index = self.frames as usize;
        if self.facts.moves {
            self.add_errors(&frame.image, index)?;
        }
        if self.wants(Measure::Tid)
            && let Some(before) = &self.last
            && let (Some(before), Some(now)) = (view(before), view(frame))
        {
            let pair = temporal::temporal_difference(&before, &now, SAME_SURFACE)?;
            self.put(Measure::Tid, pair.rms());
            self.tid.add(&pair);
        }
        if self.wants(Measure::TidOfReference) {
            self.follow_truth(frame, index)?;
        }
        if self.wants(Measure::E) || self.wants(Measure::EPrime) {
            self.track(frame, index)?;
        }
        if self.wants(Measure::ToneError) || self.wants(Measure::ToneChange) {
            self.follow_tone(frame, index)?;
        }
        if self.wants(Measure::Lag) {
            let sum: f64 = frame.image.pixels().iter().map(|pixel| grey(*pixel)).sum();
            self.luminances.push(sum / frame.image.pixels().len() as f64);
        }
        if self.wants(Measure::Mean) {
            let level = intensity(&frame.image);
            self.put(Measure::Mean, Some(level));
            self.means.push(level);
        }
        if self.wants(Measure::ClampedEnergy) {
            self.put(
                Measure::ClampedEnergy,
                frame.irradiance.as_ref().and_then(virtual_lights::clamped_share),
            );
        }
        if self.wants(Measure::StaticDeviation) && !self.facts.moves {
            self.pictures.push(frame.image.clone());
        }
        Ok(())
    }

    /// Measures how the reference differs from that of the frame before, at the surfaces that both frames see.
    fn follow_truth(&mut self, frame: &Observed, index: usize) -> Result<(), Failure> {
        let Some(truth) = &mut self.truth else { return Ok(()) };
        let truth = truth.frame(index)?.clone();
        if let (Some(last), Some(last_truth)) = (&self.last, &self.last_truth)
            && let (Some(before), Some(now)) = (view(last), view(frame))
        {
            let (before, now) = (View { image: last_truth, ..before }, View { image: &truth, ..now });
            let pair = temporal::temporal_difference(&before, &now, SAME_SURFACE)?;
            self.put(Measure::TidOfReference, pair.rms());
            self.tid_of_reference.add(&pair);
        }
        self.last_truth = Some(truth);
        Ok(())
    }

    fn track(&mut self, frame: &Observed, index: usize) -> Result<(), Failure> {
        if self.tracked.is_empty()
            && let Some(depth) = &frame.depth
        {
            self.tracked = temporal::tracked_pixels(depth, TRACKED_PIXELS);
        }
        let Some(truth) = &mut self.truth else { return Ok(()) };
        let truth = truth.frame(index)?;
        let at = |image: &Image, (x, y): (usize, usize)| grey(image.pixels()[y * image.width() + x]);
        let pairs = self.tracked.iter().map(|place| (at(&frame.image, *place), at(truth, *place)));
        let found = self.tracked_errors.add(pairs);
        self.put_errors([Measure::E, Measure::EPrime], found);
        Ok(())
    }

    /// Adds the errors of tone-mapped luminance at all pixels.
    fn follow_tone(&mut self, frame: &Observed, index: usize) -> Result<(), Failure> {
        let Some(truth) = &mut self.truth else { return Ok(()) };
        let pixels = frame.image.pixels().iter().zip(truth.frame(index)?.pixels());
        let found = self.tone_errors.add(pixels.map(|(found, expected)| (grey(*found), grey(*expected))));
        self.put_errors([Measure::ToneError, Measure::ToneChange], found);
        Ok(())
    }

    /// Adds an error and its change to the series.
    fn put_errors(&mut self, [error, change]: [Measure; 2], found: FrameError) {
        if self.wants(error) {
            self.put(error, Some(found.error));
        }
        if self.wants(change) {
            self.put(change, found.change.map(|change| change / self.facts.seconds_per_frame));
        }
    }

    /// Adds the errors of a picture in comparison with the reference of measured frame number `index`.
    fn add_errors(&mut self, image: &Image, index: usize) -> Result<(), Failure> {
        let Some(truth) = &mut self.truth else { return Ok(()) };
        let pair = Pair::new(image, truth.frame(index)?)?;
        let wanted = self.measures.iter().filter(|measure| {
            let needs = measure.needs();
            needs.reference && !needs.seeds && !needs.every_frame
        });
        for measure in wanted {
            let error = error_of(*measure, &pair);
            if self.facts.moves {
                self.series.put(measure.key(), index, error);
            }
            self.errors.entry(*measure).or_default().push(error);
        }
        Ok(())
    }

    /// Returns the measurements over all frames. `occluded` is called if lights that reach the image are
    /// counted.
    pub(crate) fn finish(
        mut self,
        run: &CellRun,
        over_frames: bool,
        occluded: &mut dyn FnMut(u32) -> Result<Occluded, Failure>,
    ) -> Measurements {
        let mut failure = self.broken.clone();
        let last = self.last.take();
        let mut flip_map = None;
        if let (Some(last), None) = (&last, &failure)
            && self.truth.is_some()
        {
            let index = self.frames.saturating_sub(1) as usize;
            let compared = if self.facts.moves { Ok(()) } else { self.add_errors(&last.image, index) };
            let map = compared.and_then(|()| self.flip_map(&last.image, index));
            match map {
                Ok(map) => flip_map = map,
                Err(why) => failure = Some(why),
            }
        }
        let mut measures = BTreeMap::new();
        let mut unknown = None;
        for measure in self.measures {
            let value = match measure {
                _ if failure.is_some() && needs_pixels(*measure) => None,
                Measure::LightsThatReach => reaching(last.as_ref(), occluded).unwrap_or_else(|why| {
                    unknown = Some(why);
                    None
                }),
                _ => self.value(*measure, run, over_frames, last.as_ref()),
            };
            measures.insert(measure.key().to_owned(), value.filter(|value| value.is_finite()));
        }
        measures.extend(self.times.phases(over_frames));
        let figures = self.figures.iter().zip(&self.figure_values);
        measures.extend(figures.map(|(figure, values)| (figure.key(), mean(values))));
        Measurements {
            measures,
            passes: self.times.medians(),
            series: self.series.finish(self.first, self.frames),
            frames: self.frames,
            image: last.map(|last| last.image),
            flip: flip_map,
            failure: failure.or(unknown),
        }
    }

    /// Returns a sign that the last frame is not of the camera of its reference.
    pub(crate) fn misalignment(&mut self) -> Option<Misalignment> {
        let index = self.frames.checked_sub(1)? as usize;
        let (last, truth) = (self.last.as_ref()?, self.truth.as_mut()?.frame(index).ok()?);
        misalignment(&Pair::new(&last.image, truth).ok()?)
    }

    fn flip_map(&mut self, image: &Image, index: usize) -> Result<Option<Image>, Failure> {
        let Some(truth) = &mut self.truth else { return Ok(None) };
        let pair = Pair::new(image, truth.frame(index)?)?;
        Ok(Some(flip(&pair, Display::default(), PIXELS_PER_DEGREE).to_image()))
    }

    fn value(
        &self,
        measure: Measure,
        run: &CellRun,
        over_frames: bool,
        last: Option<&Observed>,
    ) -> Option<f64> {
        match measure {
            Measure::GpuMs => self.times.total(over_frames),
            Measure::Memory => Some(run.memory.held as f64 / f64::from(1 << 20)),
            Measure::Tid => self.tid.value(),
            Measure::TidOfReference => self.tid_of_reference.value(),
            Measure::E => self.tracked_errors.average_error(),
            Measure::EPrime => self.tracked_errors.average_change(self.facts.seconds_per_frame),
            Measure::ToneError => self.tone_errors.average_error(),
            Measure::ToneChange => self.tone_errors.average_change(self.facts.seconds_per_frame),
            Measure::StaticDeviation => temporal::static_deviation(&self.pictures).ok()?.normalised,
            Measure::Lag => temporal::lag(&self.luminances, self.jump?, ARRIVED).map(|frames| frames as f64),
            Measure::LightsMoved => mean(&self.moved),
            Measure::Mean if self.facts.moves => mean(&self.means),
            Measure::Mean => self.means.last().copied(),
            Measure::ClampedEnergy => virtual_lights::clamped_share(last?.irradiance.as_ref()?),
            // These are measured elsewhere: from the pictures of all seeds once they are complete, or by the
            // code around this.
            Measure::Bias2 | Measure::Variance | Measure::LightsThatReach => None,
            _ => {
                let values: Option<Vec<f64>> = self.errors.get(&measure)?.iter().copied().collect();
                let values = values?;
                if measure == Measure::Rmse {
                    let squares: Vec<f64> = values.iter().map(|value| value * value).collect();
                    return mean(&squares).map(f64::sqrt);
                }
                mean(&values)
            }
        }
    }
}

/// Returns whether the measure is undefined for a picture with pixels that are NaN or infinite.
fn needs_pixels(measure: Measure) -> bool {
    !matches!(measure, Measure::GpuMs | Measure::Memory | Measure::LightsMoved | Measure::LightsThatReach)
}

/// Returns an error measure of one picture.
fn error_of(measure: Measure, pair: &Pair<'_>) -> Option<f64> {
    let epsilon = Epsilon::default();
    match measure {
        Measure::Rmse => Some(pair.rmse()),
        Measure::NormalisedRmse => pair.normalised_rmse(),
        Measure::RelMse => pair.rel_mse(epsilon),
        Measure::TrimmedRelMse => pair.trimmed_rel_mse(epsilon, DEFAULT_TRIM),
        Measure::Mape => pair.mape(epsilon),
        Measure::Ssim => Some(pair.ssim(Display::default())),
        Measure::Flip => Some(flip(pair, Display::default(), PIXELS_PER_DEGREE).mean()),
        Measure::HdrFlip => Some(hdr_flip(pair, PIXELS_PER_DEGREE).mean()),
        Measure::Energy => pair.energy_ratio(),
        Measure::Excess => pair.excess_and_missing().map(|[excess, _]| excess),
        Measure::Missing => pair.excess_and_missing().map(|[_, missing]| missing),
        _ => None,
    }
}

fn grey([r, g, b, _]: [f32; 4]) -> f64 {
    f64::from(luminance([r, g, b]))
}

/// Returns the mean over pixels and RGB.
fn intensity(image: &Image) -> f64 {
    let sum: f64 = image.pixels().iter().flat_map(|pixel| &pixel[..3]).map(|c| f64::from(*c)).sum();
    sum / (3 * image.pixels().len()) as f64
}

fn view(frame: &Observed) -> Option<View<'_>> {
    Some(View { image: &frame.image, depth: frame.depth.as_ref()?, camera: frame.camera })
}

/// Returns the share of the lights of a frame that reach a sample of its pixels; `None` without lights or
/// G-buffer.
fn reaching(
    frame: Option<&Observed>,
    occluded: &mut dyn FnMut(u32) -> Result<Occluded, Failure>,
) -> Result<Option<f64>, Failure> {
    let Some(frame) = frame else { return Ok(None) };
    let (Some(lights), Some(depth), Some(normal)) = (&frame.lights, &frame.depth, &frame.normal) else {
        return Ok(None);
    };
    if lights.is_empty() {
        return Ok(None);
    }
    let size = (depth.width(), depth.height());
    let receivers: Vec<Receiver> = temporal::tracked_pixels(depth, RECEIVERS)
        .into_iter()
        .map(|(x, y)| {
            let index = y * size.0 + x;
            let depth = f64::from(depth.pixels()[index][0]);
            let position = frame.camera.world(x as f64 + 0.5, y as f64 + 0.5, depth, size);
            let [nx, ny, nz, _] = normal.pixels()[index];
            Receiver { position: position.map(|c| c as f32), normal: [nx, ny, nz] }
        })
        .collect();
    let occluded = occluded(frame.frame)?;
    let reach = virtual_lights::lights_that_reach(lights, &receivers, &*occluded);
    Ok(Some(reach as f64 / lights.len() as f64))
}

fn mean(values: &[f64]) -> Option<f64> {
    (!values.is_empty()).then(|| values.iter().sum::<f64>() / values.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::intensity;
    use metrics::Image;

    #[test]
    fn intensity_is_the_mean_over_rgb() {
        // The mean is of RGB, not of luminance, and alpha does not count.
        let image = Image::new(2, 1, vec![[1.0, 2.0, 6.0, 1.0], [0.0, 0.0, 0.0, 1.0]]).unwrap();
        assert_eq!(intensity(&image), 1.5);
    }
}
