//! Pictures for the page: tone-mapped, 8 bits, with the exposure of their reference, within a size budget.

mod encoded;

use std::path::Path;

use metrics::{Display, FileFormat, Image, Pair, Tonemap};
use rayon::prelude::*;
use serde::Serialize;

use encoded::{Encoded, step, white};

use super::digest::{Digest, Row};
use super::number::{self, Measured};
use crate::Cell;

/// The greatest number of characters of base64 for all pictures together: keeps the page below 40 MB.
const MOST_CHARACTERS: usize = 36_000_000;
/// The share of white at which signed differences saturate.
const DIFFERENCE_END: f32 = 0.25;
/// Number of pictures that are read and encoded between checks of the budget.
const BATCH: usize = 16;

/// The data of the page's image viewer.
#[derive(Serialize)]
pub(super) struct Pictures {
    truths: Vec<Truth>,
    cells: Vec<View>,
    /// Notes for the reader: files that could not be read, pictures that were left out.
    #[serde(skip)]
    pub(super) notes: Vec<String>,
}

/// A reference, or the stand-in for one if a scene has none.
#[derive(Serialize)]
struct Truth {
    /// `None` if there is no reference.
    picture: Option<Encoded>,
    /// How radiance was mapped to display values, and other notes.
    note: String,
    /// Signed differences of ± this value saturate [radiance].
    end: String,
    /// Scene, and path relative to the study's folder; no path for a stand-in.
    #[serde(skip)]
    of: (usize, Option<String>),
    #[serde(skip)]
    linear: Option<Image>,
    #[serde(skip)]
    display: Display,
}

/// A cell with a picture.
#[derive(Serialize)]
struct View {
    scene: String,
    /// Index into [`Pictures::truths`].
    truth: usize,
    pipeline: String,
    values: String,
    seed: u32,
    key: String,
    /// Labels and values of its measures.
    facts: Vec<(String, String)>,
    image: Option<Encoded>,
    flip: Option<Encoded>,
    difference: Option<Encoded>,
    /// The reason why there is no picture; empty if there is one.
    missing: String,
}

/// The pictures of one cell.
#[derive(Default)]
struct Set {
    image: Option<Encoded>,
    flip: Option<Encoded>,
    difference: Option<Encoded>,
    notes: Vec<String>,
}

impl Pictures {
    pub(super) fn new(digest: &Digest<'_>, folder: &Path) -> Pictures {
        let mut notes = Vec::new();
        let mut truths = truths(digest, folder, &mut notes);
        let mut left = MOST_CHARACTERS;
        for truth in &mut truths {
            let size = truth.picture.as_ref().map_or(0, |picture| picture.data.len());
            if size > left {
                truth.picture = None;
                let scene = digest.scenes[truth.of.0];
                notes.push(format!("A reference of {scene} is left out: the page would be too large."));
            } else {
                left -= size;
            }
        }
        // One seed of each combination first, then the others, so that the budget cuts repetitions.
        let rows = || digest.rows.iter().map(|row| (row, with_pictures(row)));
        let first = rows().filter_map(|(row, cells)| Some((row, *cells.first()?)));
        let others = rows().flat_map(|(row, cells)| cells.into_iter().skip(1).map(move |cell| (row, cell)));
        let order: Vec<(&Row<'_>, &Cell)> = first.chain(others).collect();

        let (mut cells, mut left_out) = (Vec::new(), 0);
        for batch in order.chunks(BATCH) {
            if left == 0 {
                left_out += batch.len();
                continue;
            }
            let truth = |row: &Row<'_>, cell: &Cell| {
                let path = reference_of(digest, row.scene, cell);
                let with = |truth: &Truth| truth.of.0 == row.scene && truth.of.1.as_deref() == path;
                let without = |truth: &Truth| truth.of == (row.scene, None);
                truths.iter().position(with).or_else(|| truths.iter().position(without)).unwrap_or(0)
            };
            let sets: Vec<(usize, Set)> = batch
                .par_iter()
                .map(|(row, cell)| {
                    let truth = truth(row, cell);
                    (truth, Set::new(&truths[truth], cell, folder))
                })
                .collect();
            for ((row, cell), (truth, set)) in batch.iter().zip(sets) {
                notes.extend(set.notes.iter().cloned());
                let size = set.len();
                if size > left {
                    // Smaller pictures further on are left out too: including them would make the choice look
                    // arbitrary.
                    left = 0;
                    left_out += 1;
                    continue;
                }
                left -= size;
                cells.push(View::new(digest, row, cell, truth, set));
            }
        }
        if left_out > 0 {
            notes.push(format!(
                "{left_out} of {} pictures are left out to keep this page below 40 MB; the seeds after the first \
                 are left out first. All are in the study’s folder.",
                order.len()
            ));
        }
        // The viewer lists cells in the study's order.
        let place = |view: &View| {
            let at = |row: &Row<'_>| row.cells.iter().any(|cell| cell.key == view.key);
            (digest.rows.iter().position(at), view.seed)
        };
        cells.sort_by_cached_key(place);
        Pictures { truths, cells, notes }
    }

    /// Returns the number of cells that have a picture.
    pub(super) fn count(&self) -> usize {
        self.cells.len()
    }
}

/// Returns the references of cells, and a stand-in for each scene that has none.
fn truths(digest: &Digest<'_>, folder: &Path, notes: &mut Vec<String>) -> Vec<Truth> {
    let mut paths: Vec<(usize, &str)> = Vec::new();
    for row in &digest.rows {
        for path in row.cells.iter().filter_map(|cell| reference_of(digest, row.scene, cell)) {
            if !paths.contains(&(row.scene, path)) {
                paths.push((row.scene, path));
            }
        }
    }
    let mut truths: Vec<Truth> = Vec::new();
    for (scene, path) in paths {
        match Image::read(folder.join(path)) {
            Ok(image) => truths.push(Truth::new(scene, path, image)),
            Err(error) => {
                notes.push(format!("Reference of {}: {}", digest.scenes[scene], told(path, &error)));
            }
        }
    }
    truths.extend((0..digest.scenes.len()).map(|scene| Truth::stand_in(digest, scene, folder)));
    truths
}

/// Returns the path of the reference that a cell was compared with.
fn reference_of<'a>(digest: &Digest<'a>, scene: usize, cell: &'a Cell) -> Option<&'a str> {
    let of_scene = || {
        let records = digest.results.study.references.iter();
        let mut images =
            records.filter(|r| r.scene == digest.scenes[scene]).filter_map(|r| r.image.as_deref());
        let only = images.next()?;
        images.next().is_none().then_some(only)
    };
    cell.images.reference.as_deref().or_else(of_scene)
}

impl Truth {
    fn new(scene: usize, path: &str, image: Image) -> Truth {
        let truth = Truth::exposed(scene, path, &image, "the reference");
        Truth {
            picture: Some(Encoded::new(&image, truth.display)),
            of: (scene, Some(path.to_owned())),
            linear: Some(image),
            ..truth
        }
    }

    /// Without a reference, the first picture of the scene determines the exposure of all of them.
    fn stand_in(digest: &Digest<'_>, scene: usize, folder: &Path) -> Truth {
        let cells = digest.of_scene(scene).flat_map(|row| with_pictures(row));
        let without = cells.filter(|cell| reference_of(digest, scene, cell).is_none());
        let first = without.filter_map(|cell| cell.images.image.as_deref()).find_map(|path| {
            let image = Image::read(folder.join(path)).ok()?;
            Some(Truth::exposed(scene, path, &image, "the first picture, for want of a reference"))
        });
        first.unwrap_or(Truth {
            picture: None,
            note: String::new(),
            end: String::new(),
            of: (scene, None),
            linear: None,
            display: Display::AS_IS,
        })
    }

    /// Returns an entry with the exposure that a picture needs.
    fn exposed(scene: usize, path: &str, image: &Image, whose: &str) -> Truth {
        let is_display = FileFormat::of(Path::new(path)).is_some_and(FileFormat::is_display_referred);
        let white = if is_display { 1.0 } else { white(image) };
        let display = Display { tonemap: Tonemap::Clamp, exposure: -white.log2() };
        let mut note = if is_display {
            "Shown as they are.".to_owned()
        } else {
            format!(
                "Exposure {:+.2} EV, sRGB, cut at white, which is the 99th percentile of luminance of {whose}.",
                display.exposure
            )
        };
        let step = step(image);
        if step > 1 {
            note += &format!(" Averaged over {step}×{step} pixels: the files are larger.");
        }
        let end = number::short(f64::from(white * DIFFERENCE_END), 3);
        Truth { picture: None, note, end, of: (scene, None), linear: None, display }
    }
}

impl Set {
    fn new(truth: &Truth, cell: &Cell, folder: &Path) -> Set {
        let mut set = Set::default();
        let who = format!("{}, {}, seed {}", cell.scene, cell.pipeline, cell.seed);
        if let Some(path) = &cell.images.image {
            match Image::read(folder.join(path)) {
                Ok(image) => {
                    set.image = Some(Encoded::new(&image, truth.display));
                    set.difference = truth.linear.as_ref().and_then(|reference| {
                        let gain = truth.display.exposure.exp2() / DIFFERENCE_END;
                        match Pair::new(&image, reference) {
                            Ok(pair) => Some(Encoded::new(&pair.signed_difference(gain), Display::AS_IS)),
                            Err(error) => {
                                set.notes.push(format!("{who}: {error}"));
                                None
                            }
                        }
                    });
                }
                Err(error) => set.notes.push(format!("{who}: {}", told(path, &error))),
            }
        }
        if let Some(path) = &cell.images.flip {
            match Image::read(folder.join(path)) {
                Ok(image) => set.flip = Some(Encoded::new(&image, Display::AS_IS)),
                Err(error) => set.notes.push(format!("{who}: {}", told(path, &error))),
            }
        }
        set
    }

    fn len(&self) -> usize {
        [&self.image, &self.flip, &self.difference]
            .into_iter()
            .flatten()
            .map(|picture| picture.data.len())
            .sum()
    }
}

impl View {
    fn new(digest: &Digest<'_>, row: &Row<'_>, cell: &Cell, truth: usize, set: Set) -> View {
        let fact = |measure: &crate::MeasureInfo| {
            let value = cell.measures.get(&measure.key).copied().flatten()?;
            let unit = if measure.unit.is_empty() { String::new() } else { format!(" {}", measure.unit) };
            let text = Measured::single(value).text();
            Some((measure.label.clone(), format!("{text}{unit}")))
        };
        View {
            scene: digest.scenes[row.scene].to_owned(),
            truth,
            pipeline: digest.pipelines[row.pipeline].to_owned(),
            values: digest.values_text(row, &digest.varied()),
            seed: cell.seed,
            key: cell.key.clone(),
            facts: digest.results.study.measures.iter().filter_map(fact).collect(),
            missing: if set.image.is_some() { String::new() } else { set.notes.join("; ") },
            image: set.image,
            flip: set.flip,
            difference: set.difference,
        }
    }
}

/// Returns the cells of a row that have a picture to show.
fn with_pictures<'a>(row: &Row<'a>) -> Vec<&'a Cell> {
    row.cells.iter().copied().filter(|cell| cell.images.image.is_some()).collect()
}

/// Formats an error with the path as the study names it: the page may be read on another machine.
fn told(path: &str, error: &metrics::ImageError) -> String {
    let error = error.to_string();
    let reason = error.split_once(": ").map_or(&*error, |(_, reason)| reason);
    format!("{path}: {reason}")
}
