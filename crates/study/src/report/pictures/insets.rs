//! The crops that a study declares, as PNG files for papers.

use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

use metrics::{Display, Image};

use super::{Truth, of_cell, with_pictures};
use crate::report::digest::Digest;
use crate::report::figures;
use report::escape;

/// The least length of the longer side of a file [px]: pixels of smaller crops are repeated.
const LEAST_SIDE: usize = 384;
/// The greatest number of files.
const MOST: usize = 512;

/// Returns the crops of each reference, and of each combination's first picture: name and content of each file. Crops
/// that are left out are reported in `notes`.
pub(super) fn insets(
    digest: &Digest<'_>,
    folder: &Path,
    truths: &[Truth],
    notes: &mut Vec<String>,
) -> Vec<(PathBuf, Vec<u8>)> {
    let crops = &digest.results.study.crops;
    let mut taken = BTreeSet::new();
    let mut files = Vec::new();
    let mut add = |image: &Image, display: Display, scene: usize, name: &[&str]| {
        for (number, crop) in (1..).zip(crops) {
            let number = format!("crop-{number}");
            let parts: Vec<String> = [digest.scenes[scene], &number]
                .iter()
                .chain(name)
                .filter(|part| !part.is_empty())
                .map(|part| escape::file_name(part))
                .collect();
            let name = figures::unique(&mut taken, &format!("{}.png", parts.join("-")));
            files.extend(enlarged(image, *crop).png(display).map(|bytes| (PathBuf::from(name), bytes)));
        }
    };
    if crops.is_empty() {
        return Vec::new();
    }
    for truth in truths {
        if let Some(image) = &truth.linear {
            add(image, truth.display, truth.of.0, &["reference"]);
        }
    }
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
            let display = truths[of_cell(digest, truths, row, cell)].display;
            let values = digest.values_text(row, &digest.varied());
            add(&image, display, row.scene, &[&digest.pipelines[row.pipeline], &values]);
        }
    }
    files
}

/// Returns a part of a picture, given in shares of its sides: `[left, top, width, height]`. Small ones are enlarged by a
/// whole factor.
fn enlarged(image: &Image, [left, top, width, height]: [f64; 4]) -> Image {
    let (columns, rows) = (range(left, width, image.width()), range(top, height, image.height()));
    let factor = LEAST_SIDE.div_ceil(columns.len().max(rows.len()));
    let pixel = |x: usize, y: usize| {
        image.pixels()[(rows.start + y / factor) * image.width() + columns.start + x / factor]
    };
    Image::from_fn(columns.len() * factor, rows.len() * factor, pixel).expect("a crop has at least a pixel")
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
        let crop = enlarged(&image, [0.25, 0.5, 0.1, 0.1]);
        assert_eq!((crop.width(), crop.height()), (390, 195), "10 by 5 pixels, 39 times");
        assert_eq!(crop.pixels()[0][..2], [25.0, 25.0]);
        assert_eq!(crop.pixels()[390 * 195 - 1][..2], [34.0, 29.0]);
        assert_eq!((range(0.999, 0.001, 100), range(1.0, 0.0, 4), range(0.0, 1.0, 7)), (99..100, 3..4, 0..7));
    }
}
