//! Comparison of pictures, on a thread of its own.

use super::model::SideId;
use super::side::Side;
use eframe::egui::{Color32, ColorImage};
use metrics::{Display, Epsilon, Image, PIXELS_PER_DEGREE, Pair, flip, srgb_from_linear};
use std::sync::Arc;
use std::sync::mpsc::{Receiver, Sender, channel};
use std::time::{Duration, Instant};

/// Numbers that change more often cannot be read.
const INTERVAL: Duration = Duration::from_millis(300);

/// The measures that are requested.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Measures {
    /// Whether errors are computed: of A and B against the reference where there is one, else of A against B.
    pub(crate) errors: bool,
    /// The picture of differences that is wanted.
    pub(crate) map: Option<Map>,
    /// Factor of differences in their picture.
    pub(crate) gain: f32,
}

/// A picture of the differences between two.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Map {
    /// The absolute difference, times a gain.
    Difference,
    /// ꟻLIP's map of errors.
    Flip,
}

/// The errors of a picture.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Errors {
    /// The side of the picture.
    pub(crate) of: SideId,
    /// The side that it is compared with.
    pub(crate) to: SideId,
    /// [`Pair::rmse`].
    pub(crate) rmse: f64,
    /// [`Pair::rel_mse`].
    pub(crate) rel_mse: Option<f64>,
    /// The mean of ꟻLIP.
    pub(crate) flip: f64,
    /// [`Pair::energy_ratio`].
    pub(crate) energy: Option<f64>,
}

/// A comparison.
#[derive(Debug, Default)]
pub(crate) struct Measured {
    /// Errors of each pair.
    pub(crate) errors: Vec<Errors>,
    /// The picture of differences, and of which two it is.
    pub(crate) map: Option<(SideId, SideId, Arc<ColorImage>)>,
    /// Grows with every comparison.
    pub(crate) version: u64,
}

/// Pictures on their way to be compared.
struct Work {
    measures: Measures,
    images: Vec<(SideId, Image)>,
    version: u64,
}

/// The thread that compares, as the session sees it.
pub(super) struct Measuring {
    measures: Measures,
    work: Sender<Work>,
    results: Receiver<Measured>,
    /// Whether the thread has something to do.
    under_way: bool,
    /// The last comparison: its measures, and the versions of the pictures.
    compared: Option<(Measures, Vec<(SideId, u64)>)>,
    last: Instant,
    count: u64,
}

impl Measuring {
    /// Starts the thread, which ends with this.
    pub(super) fn start() -> Measuring {
        let (work, to_do) = channel::<Work>();
        let (done, results) = channel();
        let compare = move || {
            for work in to_do {
                if done.send(compare(&work)).is_err() {
                    return;
                }
            }
        };
        // Without the thread there are no numbers, and nothing else is amiss.
        let _ = std::thread::Builder::new().name("measure".to_owned()).spawn(compare);
        Measuring {
            measures: Measures::default(),
            work,
            results,
            under_way: false,
            compared: None,
            last: Instant::now(),
            count: 0,
        }
    }

    /// Sets what is compared.
    pub(super) fn set(&mut self, measures: Measures) {
        self.measures = measures;
    }

    /// Returns what is compared.
    pub(super) fn measures(&self) -> Measures {
        self.measures
    }

    /// Hands the newest pictures over, if they are wanted and the thread has nothing to do.
    pub(super) fn offer(&mut self, sides: &[(SideId, Side)]) {
        let wanted = self.measures.errors || self.measures.map.is_some();
        if !wanted || self.under_way || sides.len() < 2 || self.last.elapsed() < INTERVAL {
            return;
        }
        let versions: Vec<(SideId, u64)> =
            sides.iter().filter_map(|(id, side)| Some((*id, side.picture_version()?))).collect();
        let now = (self.measures, versions);
        if self.compared.as_ref() == Some(&now) {
            return;
        }
        let images = sides.iter().filter_map(|(id, side)| Some((*id, side.image().ok()?))).collect();
        self.count += 1;
        self.compared = Some(now);
        self.last = Instant::now();
        self.under_way =
            self.work.send(Work { measures: self.measures, images, version: self.count }).is_ok();
    }

    /// Returns a comparison that has come since the last call.
    pub(super) fn newest(&mut self) -> Option<Arc<Measured>> {
        let newest = self.results.try_iter().last()?;
        self.under_way = false;
        Some(Arc::new(newest))
    }

    /// Whether pictures wait to be compared, so that the session has to ask again.
    pub(super) fn waits(&self) -> bool {
        self.under_way
    }
}

fn compare(work: &Work) -> Measured {
    let image = |id: SideId| work.images.iter().find(|(known, _)| *known == id).map(|(_, image)| image);
    let pairs: Vec<(SideId, SideId)> = match image(SideId::Reference) {
        Some(_) => vec![(SideId::A, SideId::Reference), (SideId::B, SideId::Reference)],
        None => vec![(SideId::A, SideId::B)],
    };
    let display = Display::default();
    let errors = pairs.iter().filter(|_| work.measures.errors).filter_map(|(of, to)| {
        let pair = Pair::new(image(*of)?, image(*to)?).ok()?;
        Some(Errors {
            of: *of,
            to: *to,
            rmse: pair.rmse(),
            rel_mse: pair.rel_mse(Epsilon::default()),
            flip: flip(&pair, display, PIXELS_PER_DEGREE).mean(),
            energy: pair.energy_ratio(),
        })
    });
    let errors = errors.collect();
    let shown = if image(SideId::B).is_some() { SideId::B } else { SideId::Reference };
    let map = work.measures.map.and_then(|map| {
        let pair = Pair::new(image(SideId::A)?, image(shown)?).ok()?;
        let picture = match map {
            Map::Difference => pair.absolute_difference(work.measures.gain),
            Map::Flip => flip(&pair, display, PIXELS_PER_DEGREE).to_image(),
        };
        Some((SideId::A, shown, Arc::new(to_screen(&picture))))
    });
    Measured { errors, map, version: work.version }
}

/// A linear picture, encoded for a screen.
pub(crate) fn to_screen(image: &Image) -> ColorImage {
    let byte = |linear: f32| (srgb_from_linear(linear.clamp(0.0, 1.0)) * 255.0).round() as u8;
    let pixel = |pixel: &[f32; 4]| match pixel[..3].iter().all(|channel| channel.is_finite()) {
        true => Color32::from_rgb(byte(pixel[0]), byte(pixel[1]), byte(pixel[2])),
        false => Color32::from_rgb(255, 0, 255),
    };
    ColorImage::new([image.width(), image.height()], image.pixels().iter().map(pixel).collect())
}
