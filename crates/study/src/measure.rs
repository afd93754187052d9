//! The measures.

use crate::record::{Better, MeasureInfo};

/// Incremented when the definition of a measure changes: its cells are then measured again.
pub(crate) const DEFINITIONS: u32 = 1;

/// The requirements of a measure.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Needs {
    pub(crate) reference: bool,
    /// A reference for every frame, even if the scene stands still.
    pub(crate) every_frame: bool,
    /// The least number of frames.
    pub(crate) frames: u32,
    pub(crate) seeds: bool,
    pub(crate) jump: bool,
    pub(crate) timed: bool,
    /// Depth and camera.
    pub(crate) views: bool,
    pub(crate) lights: bool,
}

struct Row {
    measure: Measure,
    key: &'static str,
    label: &'static str,
    unit: &'static str,
    better: Better,
    is_error: bool,
    needs: Needs,
    doc: &'static str,
}

const NONE: Needs = Needs {
    reference: false,
    every_frame: false,
    frames: 1,
    seeds: false,
    jump: false,
    timed: false,
    views: false,
    lights: false,
};
const REFERENCE: Needs = Needs { reference: true, ..NONE };
const SEEDS: Needs = Needs { seeds: true, ..REFERENCE };
const SERIES: Needs = Needs { every_frame: true, frames: 2, views: true, ..REFERENCE };

const RADIANCE: &str = "W/(m² sr)";

macro_rules! measures {
    ($($name:ident $key:literal $label:literal $unit:tt $better:ident $is_error:literal $needs:tt $doc:literal)*) => {
        /// A measure.
        #[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
        pub enum Measure {
            $(
                #[doc = concat!($doc, ".")]
                $name,
            )*
        }

        /// The measures, in the order of the variants.
        static ROWS: &[Row] = &[$(Row {
            measure: Measure::$name,
            key: $key,
            label: $label,
            unit: $unit,
            better: Better::$better,
            is_error: $is_error,
            needs: $needs,
            doc: $doc,
        }),*];
    };
}

// Name, key, label, unit, direction that is better, whether it is an error, requirements, description.
measures! {
    Rmse "rmse" "RMSE" RADIANCE Lower true REFERENCE "Root mean squared error over pixels and RGB"
    NormalisedRmse "normalised-rmse" "nRMSE" "" Lower true REFERENCE
        "RMSE over the mean of the reference (ISM Fig. 4)"
    RelMse "rel-mse" "relMSE" "" Lower true REFERENCE
        "Mean of (I − R)² / (R² + ε), ε = 10⁻² of the squared mean of R (Rousselle et al. 2011)"
    TrimmedRelMse "trimmed-rel-mse" "trimmed relMSE" "" Lower true REFERENCE
        "relMSE without the worst 0.1 % of the pixels"
    Mape "mape" "MAPE" "" Lower true REFERENCE "Mean of |I − R| / (|R| + ε)"
    Ssim "ssim" "SSIM" "" Higher true REFERENCE
        "Structural similarity of the tone-mapped pictures (Wang et al. 2004)"
    Flip "flip" "ꟻLIP" "" Lower true REFERENCE
        "Mean perceived difference of the tone-mapped pictures (Andersson et al. 2020)"
    HdrFlip "hdr-flip" "HDR-ꟻLIP" "" Lower true REFERENCE
        "Mean perceived difference over all exposures (Andersson et al. 2021)"
    Energy "energy" "energy" "" One false REFERENCE "Mean of the picture over that of the reference"
    Excess "excess" "excess energy" "" Lower true REFERENCE
        "Energy of the picture above the reference where it is above, over the reference's: against rays of the same lights, what is falsely lit"
    Missing "missing" "missing energy" "" Lower true REFERENCE
        "Energy of the picture below the reference where it is below, over the reference's: against rays of the same lights, what is falsely hidden"
    Mean "mean" "mean intensity" RADIANCE Neither false NONE
        "Mean of the picture over pixels and RGB, as for `energy`; for a scene that moves, over the frames too (TCAS Fig. 6)"
    Bias2 "bias2" "bias²" "(W/(m² sr))²" Lower true SEEDS
        "The squared error that remains in the mean of any number of seeds; interval by leaving out one seed at a time (jackknife)"
    Variance "variance" "variance" "(W/(m² sr))²" Lower true SEEDS
        "The variance between seeds; interval as that of bias²"
    GpuMs "gpu-ms" "GPU time" "ms" Lower false { Needs { timed: true, ..NONE } }
        "GPU time of a frame in which every pass runs: the median over the measured frames. Where a budget of time is spent over frames, the sum of all of them"
    Memory "memory" "memory" "MiB" Lower false NONE
        "Memory of all objects that frames use, with history buffers, without the scene"
    Tid "tid" "TID" RADIANCE Lower true { Needs { frames: 2, views: true, ..NONE } }
        "Temporal image difference: RMS over the surfaces that two consecutive frames both see (TCAS §6.2)"
    TidOfReference "tid-of-reference" "TID of the reference" RADIANCE Neither true SERIES
        "The same of the reference over the same frames: what moving surfaces, shadows and samples of pixels give without any flicker"
    E "e" "|E|" "" Lower true SERIES
        "Mean absolute error of tone-mapped luminance at 8 tracked pixels (SMC-IR §5.2)"
    EPrime "e-prime" "|E′|" "1/s" Lower true SERIES
        "Mean absolute change of that error with time (SMC-IR Eq. 10)"
    ToneError "tone-error" "tone error" "" Lower true { Needs { every_frame: true, ..REFERENCE } }
        "Mean absolute error of tone-mapped luminance over all pixels, and over the frames: |E| without its choice of pixels"
    ToneChange "tone-change" "tone change" "1/s" Lower true { Needs { every_frame: true, frames: 2, ..REFERENCE } }
        "Mean absolute change of that error with time, over all pixels: |E′| without its choice of pixels"
    StaticDeviation "static-deviation" "static deviation" "" Lower true { Needs { frames: 2, ..NONE } }
        "Standard deviation of each pixel's luminance over the frames, its mean divided by the mean luminance; for a scene that stands still"
    Lag "lag" "lag" "frames" Lower false { Needs { frames: 3, jump: true, ..NONE } }
        "Frames from `jump` until the mean luminance stays within a tenth of the change around its final value"
    LightsMoved "lights-moved" "lights moved" "" Neither false { Needs { frames: 2, lights: true, ..NONE } }
        "Share of the virtual lights that move from one frame to the next, mean over the frames"
    LightsThatReach "lights-that-reach" "lights that reach" "" Higher false { Needs { views: true, lights: true, ..NONE } }
        "Share of the virtual lights that illuminate at least one of 256 pixels of the last frame"
    ClampedEnergy "clamped-energy" "clamped energy" "" Lower false NONE
        "Share of the indirect irradiance that clamping removed, in the last frame"
}

impl Measure {
    /// Returns every measure, in the order of the documentation.
    pub fn all() -> impl Iterator<Item = Measure> {
        ROWS.iter().map(|row| row.measure)
    }

    /// Returns the measure with this key.
    pub fn find(key: &str) -> Option<Measure> {
        ROWS.iter().find(|row| row.key == key).map(|row| row.measure)
    }

    fn row(self) -> &'static Row {
        // The rows are in the order of the variants.
        &ROWS[self as usize]
    }

    /// Returns its name in a study and in tables: `rel-mse`.
    pub fn key(self) -> &'static str {
        self.row().key
    }

    pub(crate) fn needs(self) -> Needs {
        self.row().needs
    }

    /// Returns whether the measure is computed from the pictures of all seeds together. The value of a cell is
    /// then its jackknife pseudo-value: see [`metrics::seeds::Decomposition`].
    pub fn is_over_seeds(self) -> bool {
        self.row().needs.seeds
    }

    /// Returns what a study must have for it, in words; empty if nothing.
    pub fn needed(self) -> Vec<String> {
        let Needs { reference, every_frame, frames, seeds, jump, timed: _, views, lights } = self.needs();
        let mut needed = Vec::new();
        if reference {
            needed.push(if every_frame { "a reference of every frame" } else { "a reference" }.to_owned());
        }
        if frames > 1 {
            needed.push(format!("at least {frames} frames"));
        }
        for (is_needed, what) in
            [(seeds, "at least 2 seeds"), (jump, "`jump`"), (views, "a G-buffer"), (lights, "virtual lights")]
        {
            needed.extend(is_needed.then(|| what.to_owned()));
        }
        needed
    }

    /// Returns its description for tables and charts.
    pub fn info(self) -> MeasureInfo {
        let row = self.row();
        MeasureInfo {
            key: row.key.to_owned(),
            label: row.label.to_owned(),
            unit: row.unit.to_owned(),
            better: row.better,
            doc: row.doc.to_owned(),
            is_error: row.is_error,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_a_measure_needs_is_told() {
        assert_eq!(Measure::GpuMs.needed(), Vec::<String>::new());
        assert_eq!(Measure::Bias2.needed(), ["a reference", "at least 2 seeds"]);
        assert_eq!(
            Measure::EPrime.needed(),
            ["a reference of every frame", "at least 2 frames", "a G-buffer"]
        );
        assert_eq!(Measure::Lag.needed(), ["at least 3 frames", "`jump`"]);
        assert_eq!(Measure::LightsThatReach.needed(), ["a G-buffer", "virtual lights"]);
    }

    #[test]
    fn each_measure_has_its_own_row() {
        for (index, row) in ROWS.iter().enumerate() {
            assert_eq!(row.measure as usize, index, "{}", row.key);
            assert_eq!(Measure::find(row.key), Some(row.measure));
        }
        assert!(Measure::all().all(|measure| !measure.info().doc.is_empty()));
        assert_eq!(ROWS.last().map(|row| row.measure), Some(Measure::ClampedEnergy));
    }
}
