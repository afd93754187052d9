//! Pictures for the page: linear, with the exposure that their reference asks for, within a size budget.

mod composed;
mod encoded;
mod insets;
mod linear;

use std::path::{Path, PathBuf};

use metrics::{Display, FileFormat, Image, Pair, Tonemap};
use rayon::prelude::*;
use serde::Serialize;

use encoded::{Encoded, diverging, step, white};
use linear::Linear;

use super::digest::{Digest, Row, distinct};
use crate::Cell;
use report::Measured;

/// The greatest number of characters of base64 for all pictures together: keeps the page below 40 MB.
const MOST_CHARACTERS: usize = 36_000_000;
/// Number of pictures that are read and encoded between checks of the budget.
const BATCH: usize = 16;

/// The data of the page's image viewer.
#[derive(Serialize)]
pub(super) struct Pictures {
    truths: Vec<Truth>,
    cells: Vec<View>,
    /// The crops of the study, in shares of the sides: left, top, width, height.
    crops: Vec<[f64; 4]>,
    /// The colors of differences: see [`diverging`].
    diverging: String,
    /// Names and content of the files of crops, and of the figures of them.
    #[serde(skip)]
    pub(super) insets: Vec<(PathBuf, Vec<u8>)>,
    /// Notes for the reader: files that could not be read, pictures that were left out.
    #[serde(skip)]
    pub(super) notes: Vec<String>,
}

/// A reference, or the stand-in for one if a scene has none.
#[derive(Serialize)]
struct Truth {
    /// `None` if there is no reference.
    picture: Option<Linear>,
    /// The choice of the exposure, and other notes.
    note: String,
    /// Radiance is shown times 2 to this power, unless the reader chooses another.
    exposure: f32,
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
    image: Option<Linear>,
    flip: Option<Encoded>,
    /// The reason why there is no picture; empty if there is one.
    missing: String,
}

/// The pictures of one cell.
#[derive(Default)]
struct Set {
    image: Option<Linear>,
    flip: Option<Encoded>,
    notes: Vec<String>,
}

impl Pictures {
    pub(super) fn new(digest: &Digest<'_>, folder: &Path) -> Pictures {
        let mut notes = Vec::new();
        let mut truths = truths(digest, folder, &mut notes);
        let insets = insets::insets(digest, folder, &truths, &mut notes);
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
            let sets: Vec<(usize, Set)> = batch
                .par_iter()
                .map(|(row, cell)| {
                    let truth = of_cell(digest, &truths, row, cell);
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
        let crops = digest.results.study.crops.clone();
        Pictures { truths, cells, crops, diverging: diverging(), insets, notes }
    }

    /// Returns the number of cells that have a picture.
    pub(super) fn count(&self) -> usize {
        self.cells.len()
    }
}

/// Returns the references of cells, and a stand-in for each scene that has none.
fn truths(digest: &Digest<'_>, folder: &Path, notes: &mut Vec<String>) -> Vec<Truth> {
    let cells = digest.rows.iter().flat_map(|row| row.cells.iter().map(|cell| (row.scene, *cell)));
    let paths = distinct(cells.filter_map(|(scene, cell)| Some((scene, reference_of(digest, scene, cell)?))));
    let mut truths: Vec<Truth> = Vec::new();
    for (scene, path) in paths {
        match Image::read(folder.join(path)) {
            Ok(image) => truths.push(Truth::new(scene, path, image)),
            Err(error) => {
                notes.push(format!("Reference of {}: {}", digest.scenes[scene], message(path, &error)));
            }
        }
    }
    truths.extend((0..digest.scenes.len()).map(|scene| Truth::stand_in(digest, scene, folder)));
    truths
}

/// Returns the index of the entry for the reference of a cell.
fn of_cell(digest: &Digest<'_>, truths: &[Truth], row: &Row<'_>, cell: &Cell) -> usize {
    let path = reference_of(digest, row.scene, cell);
    let with = |truth: &Truth| truth.of.0 == row.scene && truth.of.1.as_deref() == path;
    let without = |truth: &Truth| truth.of == (row.scene, None);
    truths.iter().position(with).or_else(|| truths.iter().position(without)).unwrap_or(0)
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
            picture: Some(Linear::new(&image)),
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
            exposure: 0.0,
            of: (scene, None),
            linear: None,
            display: Display::AS_IS,
        })
    }

    /// Returns an entry with the exposure that a picture needs.
    fn exposed(scene: usize, path: &str, image: &Image, whose: &str) -> Truth {
        let is_display = is_display(path);
        let display = exposed_for(path, image);
        let mut note = if is_display {
            "Auto is 0 EV: shown as they are.".to_owned()
        } else {
            format!(
                "Auto is {:+.2} EV: white is the 99th percentile of luminance of {whose}. sRGB, cut at white.",
                display.exposure
            )
        };
        let step = step(image);
        if step > 1 {
            note += &format!(" Averaged over {step}×{step} pixels: the files are larger.");
        }
        Truth { picture: None, note, exposure: display.exposure, of: (scene, None), linear: None, display }
    }
}

impl Set {
    fn new(truth: &Truth, cell: &Cell, folder: &Path) -> Set {
        let mut set = Set::default();
        let who = format!("{}, {}, seed {}", cell.scene, cell.pipeline, cell.seed);
        if let Some(path) = &cell.images.image {
            match Image::read(folder.join(path)) {
                Ok(image) => {
                    set.image = Some(Linear::new(&image));
                    if let Some(Err(error)) =
                        truth.linear.as_ref().map(|reference| Pair::new(&image, reference))
                    {
                        set.notes.push(format!("{who}: {error}"));
                    }
                }
                Err(error) => set.notes.push(format!("{who}: {}", message(path, &error))),
            }
        }
        if let Some(path) = &cell.images.flip {
            match Image::read(folder.join(path)) {
                Ok(image) => set.flip = Some(Encoded::new(&image)),
                Err(error) => set.notes.push(format!("{who}: {}", message(path, &error))),
            }
        }
        set
    }

    fn len(&self) -> usize {
        self.image.as_ref().map_or(0, |picture| picture.data.len())
            + self.flip.as_ref().map_or(0, |picture| picture.data.len())
    }
}

impl View {
    fn new(digest: &Digest<'_>, row: &Row<'_>, cell: &Cell, truth: usize, set: Set) -> View {
        let fact = |measure: &crate::MeasureInfo| {
            let value = cell.measures.get(&measure.key).copied().flatten()?;
            let unit = if measure.unit.is_empty() { String::new() } else { format!(" {}", measure.unit) };
            let text = Measured::new(value, None).text();
            Some((measure.label.clone(), format!("{text}{unit}")))
        };
        View {
            scene: digest.scenes[row.scene].to_owned(),
            truth,
            pipeline: digest.pipelines[row.pipeline].clone(),
            values: digest.values_text(row, &digest.varied()),
            seed: cell.seed,
            key: cell.key.clone(),
            facts: digest.results.study.measures.iter().filter_map(fact).collect(),
            missing: if set.image.is_some() { String::new() } else { set.notes.join("; ") },
            image: set.image,
            flip: set.flip,
        }
    }
}

fn is_display(path: &str) -> bool {
    FileFormat::of(Path::new(path)).is_some_and(FileFormat::is_display_referred)
}

/// Returns the exposure that the picture in a file needs: white is the 99th percentile of luminance.
pub(super) fn exposed_for(path: &str, image: &Image) -> Display {
    let white = if is_display(path) { 1.0 } else { white(image) };
    Display { tonemap: Tonemap::Clamp, exposure: -white.log2() }
}

/// Returns the cells of a row that have a picture to show.
fn with_pictures<'a>(row: &Row<'a>) -> Vec<&'a Cell> {
    row.cells.iter().copied().filter(|cell| cell.images.image.is_some()).collect()
}

/// Formats an error with the path as the study names it: the page may be read on another machine.
pub(super) fn message(path: &str, error: &metrics::ImageError) -> String {
    let error = error.to_string();
    let reason = error.split_once(": ").map_or(&*error, |(_, reason)| reason);
    format!("{path}: {reason}")
}
