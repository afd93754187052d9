use std::fmt;

use serde::Serialize;

use crate::{
    DEFAULT_TRIM, Display, Epsilon, FlipMap, Image, ImageError, NonFinite, PIXELS_PER_DEGREE, Pair, flip,
    hdr_flip,
};

/// Options of a comparison.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct ComparisonOptions {
    /// ε of relMSE; its square root is that of MAPE.
    pub epsilon: Epsilon,
    /// The share of pixels that trimmed relMSE leaves out; see [`DEFAULT_TRIM`].
    pub trim: f64,
    /// How radiance is mapped to display values for ꟻLIP and SSIM; `None` if both pictures are display values
    /// already, as PNG files are. HDR-ꟻLIP is computed only for radiance.
    pub display: Option<Display>,
    /// The viewing condition of ꟻLIP; see [`PIXELS_PER_DEGREE`].
    pub pixels_per_degree: f32,
}

impl Default for ComparisonOptions {
    fn default() -> Self {
        Self {
            epsilon: Epsilon::default(),
            trim: DEFAULT_TRIM,
            display: Some(Display::default()),
            pixels_per_degree: PIXELS_PER_DEGREE,
        }
    }
}

/// All measures between an image and its reference. Its [`Display`](fmt::Display) is a table; in JSON, a
/// measure that does not exist is `null`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Comparison {
    /// Width of both (pixels).
    pub width: usize,
    /// Height of both (pixels).
    pub height: usize,
    /// The options with which the measures were computed.
    pub options: ComparisonOptions,
    /// NaN and infinite pixels.
    pub non_finite: NonFinite,
    /// Mean of each RGB channel of the image (radiance).
    pub mean: [f64; 3],
    /// Mean of each RGB channel of the reference (radiance).
    pub reference_mean: [f64; 3],
    /// [`Pair::energy_ratio`].
    pub energy_ratio: Option<f64>,
    /// The first of [`Pair::excess_and_missing`].
    pub excess: Option<f64>,
    /// The second.
    pub missing: Option<f64>,
    /// [`Pair::rmse`] (radiance).
    pub rmse: f64,
    /// [`Pair::normalised_rmse`].
    pub normalised_rmse: Option<f64>,
    /// [`Pair::rel_mse`].
    pub rel_mse: Option<f64>,
    /// [`Pair::trimmed_rel_mse`].
    pub trimmed_rel_mse: Option<f64>,
    /// [`Pair::mape`].
    pub mape: Option<f64>,
    /// [`Pair::max_abs_difference`] (radiance).
    pub max_abs_difference: f64,
    /// [`Pair::ssim`].
    pub ssim: f64,
    /// [`flip`](fn@flip).
    pub flip: FlipStatistics,
    /// [`hdr_flip`]; only for radiance.
    pub hdr_flip: Option<FlipStatistics>,
}

/// Statistics of a [`FlipMap`], 0..=1.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct FlipStatistics {
    /// Mean over the pixels.
    pub mean: f64,
    /// 95 % of the pixels have at most this error.
    pub p95: f32,
    /// The greatest error of a pixel.
    pub max: f32,
}

impl From<&FlipMap> for FlipStatistics {
    fn from(map: &FlipMap) -> Self {
        Self { mean: map.mean(), p95: map.quantile(0.95), max: map.quantile(1.0) }
    }
}

impl Comparison {
    /// Computes every measure.
    ///
    /// # Errors
    /// Those of [`Pair::new`].
    pub fn new(image: &Image, reference: &Image, options: ComparisonOptions) -> Result<Self, ImageError> {
        let pair = Pair::new(image, reference)?;
        let [mean, reference_mean] = pair.means();
        let parts = pair.excess_and_missing();
        let ppd = options.pixels_per_degree;
        let display = options.display.unwrap_or(Display::AS_IS);
        Ok(Self {
            width: image.width(),
            height: image.height(),
            options,
            non_finite: pair.non_finite(),
            mean,
            reference_mean,
            energy_ratio: pair.energy_ratio(),
            excess: parts.map(|[excess, _]| excess),
            missing: parts.map(|[_, missing]| missing),
            rmse: pair.rmse(),
            normalised_rmse: pair.normalised_rmse(),
            rel_mse: pair.rel_mse(options.epsilon),
            trimmed_rel_mse: pair.trimmed_rel_mse(options.epsilon, options.trim),
            mape: pair.mape(options.epsilon),
            max_abs_difference: pair.max_abs_difference(),
            ssim: pair.ssim(display),
            flip: (&flip(&pair, display, ppd)).into(),
            hdr_flip: options.display.map(|_| (&hdr_flip(&pair, ppd)).into()),
        })
    }
}

impl fmt::Display for Comparison {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut line = |name: &str, value: String, note: &str| {
            writeln!(f, "{}", format!("{name:<17} {value:<30} {note}").trim_end())
        };
        // Dim scenes have small errors, so numbers have significant digits rather than decimals.
        let number = |value: f64| match value.abs() {
            tiny if tiny > 0.0 && tiny < 1e-2 => format!("{value:.4e}"),
            _ => format!("{value:.5}"),
        };
        let optional = |value: Option<f64>| value.map_or("undefined".into(), number);
        let rgb = |channels: [f64; 3]| channels.map(number).join("  ");
        let flip = |s: &FlipStatistics| format!("{:.5}", s.mean);
        let spread = |s: &FlipStatistics, how: &str| {
            format!(
                "95 % at most {:.4}, greatest {:.4}; {how}, {:.1} pixels/degree",
                s.p95, s.max, self.options.pixels_per_degree
            )
        };

        line("size", format!("{} x {}", self.width, self.height), "")?;
        line("RMSE", number(self.rmse), "")?;
        line("RMSE / mean", optional(self.normalised_rmse), "by the reference's mean")?;
        let [epsilon, root] = match self.options.epsilon {
            Epsilon::Relative(share) => [
                format!("epsilon {share} of the reference's squared mean"),
                format!("epsilon {} of the reference's mean", share.sqrt()),
            ],
            Epsilon::Absolute(epsilon) => {
                [format!("epsilon {epsilon}"), format!("epsilon {}", epsilon.sqrt())]
            }
        };
        line("relMSE", optional(self.rel_mse), &epsilon)?;
        let trim = format!("the worst {} % of the pixels left out", self.options.trim * 100.0);
        line("relMSE trimmed", optional(self.trimmed_rel_mse), &trim)?;
        line("MAPE", optional(self.mape), &root)?;
        line("max |difference|", number(self.max_abs_difference), "")?;
        line("mean RGB", rgb(self.mean), "image")?;
        line("", rgb(self.reference_mean), "reference")?;
        line("energy", optional(self.energy_ratio), "image / reference")?;
        line(
            "excess energy",
            optional(self.excess),
            "where the image is above the reference, by its energy",
        )?;
        line("missing energy", optional(self.missing), "where it is below")?;
        let how = match self.options.display {
            Some(display) => format!("{} at {:+} EV", display.tonemap, display.exposure),
            None => "display light".into(),
        };
        line("SSIM", format!("{:.5}", self.ssim), &how)?;
        line("FLIP", flip(&self.flip), &spread(&self.flip, &how))?;
        if let Some(hdr) = &self.hdr_flip {
            line("HDR-FLIP", flip(hdr), &spread(hdr, "all exposures"))?;
        }
        let NonFinite { image, reference, excluded } = self.non_finite;
        if excluded > 0 {
            let note = format!(
                "pixels: {image} in the image, {reference} in the reference; left out, FLIP 1, SSIM 0"
            );
            line("NaN or infinite", excluded.to_string(), &note)?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn table_and_json_tell_what_is_broken() {
        let image = Image::new(2, 1, vec![[1.0, 1.0, 1.0, 1.0], [f32::NAN, 0.0, 0.0, 1.0]]).unwrap();
        let reference = Image::new(2, 1, vec![[0.0, 0.0, 0.0, 1.0]; 2]).unwrap();
        let comparison = Comparison::new(&image, &reference, ComparisonOptions::default()).unwrap();
        let table = comparison.to_string();
        assert!(table.contains("pixels: 1 in the image, 0 in") && table.contains("undefined"), "{table}");
        let json = serde_json::to_value(&comparison).unwrap();
        assert_eq!(json["energy_ratio"], serde_json::Value::Null);
        assert_eq!(json["rmse"], 1.0);
        assert_eq!(json["non_finite"]["excluded"], 1);
        assert_eq!(json["flip"]["max"], 1.0);
    }

    #[test]
    fn each_measure_is_under_its_name() {
        let grey = |values: [f32; 4]| Image::new(2, 2, values.map(|v| [v, v, v, 1.0]).to_vec()).unwrap();
        let (image, reference) = (grey([0.5, 2.0, 3.0, 9.0]), grey([1.0, 2.0, 2.0, 1.0]));
        let options = ComparisonOptions { trim: 0.25, ..Default::default() };
        let comparison = Comparison::new(&image, &reference, options).unwrap();
        let pair = Pair::new(&image, &reference).unwrap();
        assert_eq!(comparison.rel_mse, pair.rel_mse(options.epsilon));
        assert_eq!(comparison.trimmed_rel_mse, pair.trimmed_rel_mse(options.epsilon, 0.25));
        assert_eq!(comparison.mape, pair.mape(options.epsilon));
        assert_eq!(comparison.ssim, pair.ssim(Display::default()));
        let table = comparison.to_string();
        let row = |name: &str| table.lines().find(|line| line.starts_with(name)).unwrap().to_owned();
        assert!(row("relMSE trimmed").ends_with("the worst 25 % of the pixels left out"), "{table}");
        assert!(row("MAPE").ends_with("epsilon 0.1 of the reference's mean"), "{table}");
        assert!(row("SSIM").ends_with("reinhard-simple at +0 EV"), "{table}");
    }

    #[test]
    fn display_light_has_no_hdr_flip() {
        let image = Image::new(1, 1, vec![[0.5, 0.5, 0.5, 1.0]]).unwrap();
        let options = ComparisonOptions { display: None, ..Default::default() };
        let comparison = Comparison::new(&image, &image, options).unwrap();
        assert_eq!(comparison.hdr_flip, None);
        assert_eq!((comparison.flip.mean, comparison.rmse, comparison.energy_ratio), (0.0, 0.0, Some(1.0)));
    }
}
