//! The crops that a study declares, as PNG files for papers, and the figures of them.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use metrics::{Display, Image};

use super::composed::Figures;
use super::encoded::reduced;
use super::{Truth, of_cell, with_pictures};
use crate::report::digest::Digest;
use crate::report::figures;
use report::{Raster, escape};

/// The least length of the longer side of a file [px]: pixels of smaller crops are repeated.
const LEAST_SIDE: usize = 384;
/// The greatest number of files.
const MOST: usize = 512;

/// Returns the crops of each reference, and of each combination's first picture: name and content of each file; with them
/// the figures that are composed of them. Crops that are left out are reported in `notes`.
pub(super) fn insets(
    digest: &Digest<'_>,
    folder: &Path,
    truths: &[Truth],
    notes: &mut Vec<String>,
) -> Vec<(PathBuf, Vec<u8>)> {
    let crops = &digest.results.study.crops;
    if crops.is_empty() {
        return Vec::new();
    }
    let mut files = Files::default();
    let mut figures: Vec<Figures<'_>> = truths
        .iter()
        .map(|truth| {
            let scene = digest.scenes[truth.of.0];
            let mut figures = Figures::new(digest, scene);
            if let Some(image) = &truth.linear {
                figures.picture = Some(files.whole(image, truth.display, &[scene, "reference"]));
                figures.add(files.crops(image, crops, truth.display, scene, &["reference"]), None);
            }
            figures
        })
        .collect();
    let most = MOST / crops.len();
    let rows = digest.rows.iter().filter_map(|row| Some((row, *with_pictures(row).first()?)));
    for (index, (row, cell)) in rows.enumerate() {
        if index == most {
            notes.push(format!("Crops are in `figures/` for the first {most} combinations only."));
            break;
        }
        let path = cell.images.image.as_deref().unwrap_or_default();
        // The viewer reports pictures that cannot be read.
        if let Ok(image) = Image::read(folder.join(path)) {
            let truth = of_cell(digest, truths, row, cell);
            let (display, scene) = (truths[truth].display, digest.scenes[row.scene]);
            let names = [digest.pipelines[row.pipeline].as_str(), &digest.values_text(row, &digest.varied())];
            let figures = &mut figures[truth];
            if figures.picture.is_none() {
                figures.picture = Some(files.whole(&image, display, &[scene, "picture"]));
            }
            figures.add(files.crops(&image, crops, display, scene, &names), Some((names, row)));
        }
    }
    for figures in figures {
        figures.write(digest, &mut files);
    }
    files.all
}

/// Files of `figures/`, each of a name of its own.
#[derive(Default)]
pub(super) struct Files {
    taken: BTreeSet<String>,
    all: Vec<(PathBuf, Vec<u8>)>,
}

impl Files {
    /// Returns a name that no other file has, of these parts.
    fn name(&mut self, parts: &[&str], ending: &str) -> String {
        let parts: Vec<String> =
            parts.iter().filter(|part| !part.is_empty()).map(|part| escape::file_name(part)).collect();
        figures::unique(&mut self.taken, &format!("{}.{ending}", parts.join("-")))
    }

    pub(super) fn add(&mut self, name: &str, bytes: Vec<u8>) {
        self.all.push((PathBuf::from(name), bytes));
    }

    /// Returns the name of two files of these parts, a PDF file and one for LaTeX.
    pub(super) fn figure(&mut self, parts: &[&str]) -> String {
        self.name(parts, "pdf")
    }

    /// Adds a whole picture.
    fn whole(&mut self, image: &Image, display: Display, parts: &[&str]) -> Raster {
        let image = reduced(image);
        let name = self.name(parts, "png");
        if let Ok(bytes) = image.png(display) {
            self.add(&name, bytes);
        }
        raster(&image, display, name)
    }

    /// Adds the crops of a picture.
    fn crops(
        &mut self,
        image: &Image,
        crops: &[[f64; 4]],
        display: Display,
        scene: &str,
        names: &[&str],
    ) -> Vec<Raster> {
        (1..)
            .zip(crops)
            .map(|(number, crop)| {
                let number = format!("crop-{number}");
                let name = self.name(&[&[scene, &number], names].concat(), "png");
                let part = part(image, *crop);
                if let Ok(bytes) = enlarged(&part).png(display) {
                    self.add(&name, bytes);
                }
                raster(&part, display, name)
            })
            .collect()
    }
}

fn raster(image: &Image, display: Display, file: String) -> Raster {
    let rgb = image.srgb8(display).flatten().collect();
    Raster { width: image.width(), height: image.height(), rgb, file }
}

/// Returns a part of a picture, given in shares of its sides: `[left, top, width, height]`.
fn part(image: &Image, [left, top, width, height]: [f64; 4]) -> Image {
    let (columns, rows) = (range(left, width, image.width()), range(top, height, image.height()));
    let pixel = |x: usize, y: usize| image.pixels()[(rows.start + y) * image.width() + columns.start + x];
    Image::from_fn(columns.len(), rows.len(), pixel).expect("a crop has at least a pixel")
}

/// Returns a picture enlarged by a whole factor, if it is small.
fn enlarged(image: &Image) -> Image {
    let factor = LEAST_SIDE.div_ceil(image.width().max(image.height()));
    let pixel = |x: usize, y: usize| image.pixels()[y / factor * image.width() + x / factor];
    Image::from_fn(image.width() * factor, image.height() * factor, pixel).expect("it has at least a pixel")
}

/// Returns the pixels of a part of a side; at least one.
fn range(start: f64, length: f64, count: usize) -> std::ops::Range<usize> {
    let at = |share: f64| (share * count as f64).round() as usize;
    let first = at(start).min(count - 1);
    first..at(start + length).clamp(first + 1, count)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crops_are_enlarged_by_whole_factors() {
        let image = Image::from_fn(100, 50, |x, y| [x as f32, y as f32, 0.0, 1.0]).expect("pixels");
        let crop = enlarged(&part(&image, [0.25, 0.5, 0.1, 0.1]));
        assert_eq!((crop.width(), crop.height()), (390, 195), "10 by 5 pixels, 39 times");
        assert_eq!(crop.pixels()[0][..2], [25.0, 25.0]);
        assert_eq!(crop.pixels()[390 * 195 - 1][..2], [34.0, 29.0]);
        assert_eq!((range(0.999, 0.001, 100), range(1.0, 0.0, 4), range(0.0, 1.0, 7)), (99..100, 3..4, 0..7));
    }
}
