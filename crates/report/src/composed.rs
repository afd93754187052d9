//! A figure as papers of this field have it: a picture, its crops by several methods side by side, and the error under each.

mod pdf;
mod tex;

use crate::Ink;

/// Width of a figure [pt]: that of the text of a page in two columns.
const WIDTH: f64 = 506.0;
/// Distance between pictures [pt].
const GAP: f64 = 3.0;
/// Size of text [pt], and the distance of its lines.
const TEXT: (f64, f64) = (7.0, 8.5);
/// Width of the frames of crops [pt].
const FRAME: f64 = 1.0;

/// A picture of 8 bits.
#[derive(Clone, Debug)]
pub struct Raster {
    /// Width \[px\].
    pub width: usize,
    /// Height \[px\].
    pub height: usize,
    /// Red, green and blue of each pixel, by rows from above.
    pub rgb: Vec<u8>,
    /// Name of the PNG file that holds it.
    pub file: String,
}

/// What one method makes of all crops.
#[derive(Clone, Debug)]
pub struct Column {
    /// The crops, as many as the figure has.
    pub crops: Vec<Raster>,
    /// Name of the method, and what else tells it from others; empty lines are left out.
    pub names: [String; 2],
    /// What stands below them: a number, as plain text and for LaTeX.
    pub value: (String, String),
}

/// A picture, beside it the crops of several methods, a column each.
#[derive(Clone, Debug)]
pub struct Composed {
    /// The whole picture.
    pub picture: Raster,
    /// What it shows.
    pub name: String,
    /// The crops, in shares of its sides: left, top, width, height.
    pub crops: Vec<[f64; 4]>,
    /// The methods.
    pub columns: Vec<Column>,
}

/// A rectangle [pt], from the upper left corner of the figure.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Area {
    left: f64,
    top: f64,
    width: f64,
    height: f64,
}

/// Where everything stands.
struct Layout {
    /// The whole figure's height [pt].
    height: f64,
    picture: Area,
    /// The frames of crops on the picture.
    frames: Vec<Area>,
    /// The crops of each column.
    columns: Vec<Vec<Area>>,
}

impl Composed {
    /// Places the pictures: the columns are as high as the picture, and all together as wide as the figure.
    fn layout(&self) -> Layout {
        let ratio = |raster: &Raster| raster.width as f64 / raster.height as f64;
        let columns = self.columns.len() as f64;
        let stack: f64 = self
            .columns
            .first()
            .map_or(0.0, |column| column.crops.iter().map(|crop| 1.0 / ratio(crop)).sum());
        let gaps = GAP * self.crops.len().saturating_sub(1) as f64;
        let shape = ratio(&self.picture);
        let side = ((WIDTH - columns * GAP - shape * gaps) / (shape * stack + columns)).max(1.0);
        let height = if self.columns.is_empty() { WIDTH / shape } else { side * stack + gaps };
        let picture = Area { left: 0.0, top: 0.0, width: shape * height, height };
        let frame = |&[left, top, width, height]: &[f64; 4]| Area {
            left: left * picture.width,
            top: top * picture.height,
            width: width * picture.width,
            height: height * picture.height,
        };
        let column = |(index, column): (usize, &Column)| {
            let left = picture.width + GAP + index as f64 * (side + GAP);
            let mut top = 0.0;
            let area = |crop: &Raster| {
                let area = Area { left, top, width: side, height: side / ratio(crop) };
                top += area.height + GAP;
                area
            };
            column.crops.iter().map(area).collect()
        };
        let most = self.columns.iter().map(|column| column.lines().count()).max().unwrap_or(0).max(1);
        Layout {
            height: height + TEXT.1 * (most as f64 + 0.3),
            picture,
            frames: self.crops.iter().map(frame).collect(),
            columns: self.columns.iter().enumerate().map(column).collect(),
        }
    }

    /// Returns every picture with its place, and the index of its crop.
    fn placed<'a, 'l>(
        &'a self,
        layout: &'l Layout,
    ) -> impl Iterator<Item = (&'a Raster, Area, Option<usize>)> + use<'a, 'l> {
        let crops = self.columns.iter().zip(&layout.columns).flat_map(|(column, areas)| {
            column.crops.iter().zip(areas).enumerate().map(|(index, (crop, area))| (crop, *area, Some(index)))
        });
        std::iter::once((&self.picture, layout.picture, None)).chain(crops)
    }
}

impl Column {
    /// Returns the lines below the crops, and whether each is the number.
    fn lines(&self) -> impl Iterator<Item = (&str, bool)> {
        let names = self.names.iter().map(|name| (name.as_str(), false));
        names.chain([(self.value.0.as_str(), true)]).filter(|(line, _)| !line.is_empty())
    }
}

/// Returns the color of the frames of a crop. The first is seen on most pictures.
fn color(crop: usize) -> [u8; 3] {
    Ink::Series(crop + 1).rgb()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A figure with crops of these sizes.
    pub(super) fn figure(columns: usize, crops: &[(usize, usize)]) -> Composed {
        let raster = |(width, height): (usize, usize), file: &str| Raster {
            width,
            height,
            rgb: (0..width * height * 3).map(|byte| byte as u8).collect(),
            file: file.to_owned(),
        };
        let column = |index| Column {
            crops: crops.iter().map(|size| raster(*size, "crop.png")).collect(),
            names: [format!("method_{index}"), String::new()],
            value: ("(1.2 ± 0.3)·10⁻⁵".to_owned(), "(1.2 \\pm 0.3) \\cdot 10^{-5}".to_owned()),
        };
        Composed {
            picture: raster((32, 24), "picture.png"),
            name: "Reference".to_owned(),
            crops: crops.iter().map(|_| [0.25, 0.5, 0.25, 0.25]).collect(),
            columns: (0..columns).map(column).collect(),
        }
    }

    #[test]
    fn pictures_keep_their_shapes_and_fill_the_width() {
        for (columns, crops) in [(1, vec![(8, 8)]), (4, vec![(8, 6), (5, 10)]), (6, vec![(8, 8); 3])] {
            let figure = figure(columns, &crops);
            let layout = figure.layout();
            let near = |a: f64, b: f64| assert!((a - b).abs() < 1e-9 * WIDTH, "{a} {b}");
            for (raster, area, _) in figure.placed(&layout) {
                near(area.width / area.height, raster.width as f64 / raster.height as f64);
            }
            for column in &layout.columns {
                let last = column.last().expect("crops");
                near(last.top + last.height, layout.picture.height);
            }
            let last = layout.columns.last().expect("columns")[0];
            near(last.left + last.width, WIDTH);
            near(layout.frames[0].left, layout.picture.width / 4.0);
            near(layout.frames[0].top, layout.picture.height / 2.0);
        }
        let alone = figure(0, &[]);
        assert_eq!(alone.layout().picture, Area { left: 0.0, top: 0.0, width: WIDTH, height: WIDTH * 0.75 });
    }

    #[test]
    fn every_crop_has_a_color_of_its_own() {
        assert_eq!(color(0), [0xd5, 0x5e, 0x00]);
        assert_ne!(color(0), color(1));
    }
}
