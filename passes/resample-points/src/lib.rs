//! Some of many surface points, chosen by weight without replacement.

pub mod cpu_reference;

use gpu_algorithms::{reduce, scan, segmented_scan, select};
use interfaces::{counters, density, radiosity, surface_points};
use pass::{
    Compute, Define, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, Setting, Settings, Struct, Threads, UseContext, Value, input, optional, output,
};

/// The pass, for the catalog.
pub const PASS: &dyn Pass = &ResamplePoints;

/// See the crate.
#[derive(Debug)]
pub struct ResamplePoints;

const WEIGH: &str = "passes/resample-points/weigh.wgsl";
const THRESHOLD: &str = "passes/resample-points/threshold.wgsl";
const SYSTEMATIC: &str = "passes/resample-points/systematic.wgsl";
const RACE: &str = "passes/resample-points/race.wgsl";
const CUMULATE: &str = "passes/resample-points/cumulate.wgsl";
const CLAIM: &str = "passes/resample-points/claim.wgsl";
const TELL: &str = "passes/resample-points/tell-density.wgsl";
const MOVE: &str = "passes/resample-points/move.wgsl";

const SCALED: Struct = Struct::new("shaders/algorithms/scaled.wgsl", "Scaled");
const REDUCED: Struct = Struct::new(THRESHOLD, "Reduced");

/// Steps towards the threshold of systematic sampling. Densities of nearest neighbours take two to five; weights that span 10³⁰
/// evenly take seven.
const STEPS: u32 = 16;

pass::choice! {
    /// How points are chosen.
    pub enum Method {
        /// By one random number: in proportion to the weights, as far as a probability of 1 allows.
        Systematic = "systematic",
        /// One after the other, each in proportion to the weights that are left.
        Race = "race",
        /// By independent draws, of which those that find a point that is taken try again.
        Retries = "retries",
    }
}

pass::settings! {
    /// The settings of the pass type `resample-points`.
    pub struct ResamplePointsSettings {
        /// Number I of points to choose.
        count: u32 = 2048, min: 1, max: 2_097_152;
        /// How points are chosen. systematic: the probability of a point is exactly in proportion to its weight, up to 1, and the
        /// number that falls on each run of points varies least. race: as by one draw after the other. retries: as the paper
        /// does; some of the points may stay empty.
        method: Method = Method::Systematic;
        /// Whether weights are divided by the density of the points, where that is linked. true: what is chosen is uniform by
        /// area, or in proportion to radiosity. false: it keeps the density of the points, times radiosity.
        by_area: bool = true;
        /// How often draws that find a point which is taken try again (method `retries`). More: fewer points stay empty.
        retries: u32 = 8, min: 0, max: 64;
    }
}

impl Pass for ResamplePoints {
    fn info(&self) -> Info {
        Info {
            kind: "resample-points",
            about: "Chooses some of many surface points by weight, none of them twice.",
            paper: "SMC-IR §3.2.1",
            shaders: &[WEIGH, THRESHOLD, SYSTEMATIC, RACE, CUMULATE, CLAIM, MOVE, TELL],
        }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(ResamplePointsSettings::schema())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                input("points", "SurfacePoints", "The points to choose from. Empty ones are not chosen."),
                input("origins", "SurfacePoints", "Where each of them was traced from."),
                optional("density", "Density", "Density of each: its weight is divided by that."),
                optional(
                    "radiosity",
                    "Radiosity",
                    "Radiosity of each: its weight is multiplied by the luminance.",
                ),
            ],
            outputs: vec![
                output("resampled", "SurfacePoints", "Those chosen, in their order; the rest is empty."),
                output("resampled_origins", "SurfacePoints", "Where each of those was traced from."),
                output(
                    "resampled_density",
                    "Density",
                    "Density of those chosen, for the method `systematic`; it wants `density`.",
                ),
                output("counters", "Counters", "How many were wanted, and how many were chosen."),
            ],
            ..Ports::default()
        })
    }

    fn outputs(
        &self,
        use_cx: &UseContext<'_>,
        cx: &OutputContext<'_>,
    ) -> Result<Vec<OutputDesc>, PassTypeError> {
        let points = cx.fact("points", surface_points::COUNT)?;
        for (input, fact) in
            [("origins", surface_points::COUNT), ("density", density::COUNT), ("radiosity", radiosity::COUNT)]
        {
            if cx.input(input).is_some() && cx.fact(input, fact)? != points {
                let found = cx.fact(input, fact)?;
                let message = format!("expected as many as `points`, which are {points}; found {found}");
                return Err(PassTypeError::input(input, message));
            }
        }
        let settings = ResamplePointsSettings::read(cx.settings);
        let words = |name: &str, count: u32| {
            OutputDesc::scratch(name, ResourceDesc::buffer(4 * u64::from(count.max(1))))
        };
        let scaled = |name: &str, count: u32| -> Result<OutputDesc, PassTypeError> {
            Ok(OutputDesc::scratch(name, use_cx.buffer(SCALED, u64::from(count.max(1)))?))
        };
        let tells = tells(cx.input("density").is_some(), settings.method);
        let density = density::output("resampled_density", settings.count);
        let mut outputs = vec![
            surface_points::output(use_cx, "resampled", settings.count)?,
            surface_points::output(use_cx, "resampled_origins", settings.count)?,
            if tells { density } else { density.cleared() },
            counters::output(use_cx, "counters")?,
            scaled("weights", points)?,
            words("taken", points),
        ];
        if tells {
            outputs.extend([words("present", 1).cleared(), words("indices", settings.count)]);
        }
        outputs.extend(scan::scratch(use_cx, "places", candidates(points, settings.method))?);
        match settings.method {
            Method::Systematic => {
                outputs.push(scaled("threshold", 1)?);
                let bytes = use_cx.size_of(REDUCED)?;
                outputs.push(reduce::scratch(use_cx, "threshold_blocks", points, bytes)?);
                outputs.extend([words("sums", 2 * points), words("total", 1)]);
                outputs.extend(scan::scratch(use_cx, "sums_of_blocks", points)?);
            }
            Method::Race => {
                outputs.extend([words("keys", points), words("last_key", 1)]);
                outputs.push(select::scratch(use_cx, "selection")?);
            }
            Method::Retries => outputs.extend([
                words("cumulated", points),
                scaled("total", 1)?,
                words("claims", points),
                words("found", settings.count),
            ]),
        }
        Ok(outputs)
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        let settings = ResamplePointsSettings::read(cx.settings);
        let points = cx.fact("points", surface_points::COUNT)?;
        let tells = tells(cx.connected("density"), settings.method);
        let defines = [
            ("DENSITY", Define::Bool(cx.connected("density"))),
            ("RADIOSITY", Define::Bool(cx.connected("radiosity"))),
            ("BY_AREA", Define::Bool(settings.by_area)),
            ("TELL", Define::Bool(tells)),
        ];
        let weigh = Compute::new(cx.shader(WEIGH, &defines), "weigh", Threads::Row(points));
        let moves = cx.shader(
            MOVE,
            &[("TIES", Define::Bool(settings.method == Method::Race)), ("TELL", Define::Bool(tells))],
        );
        let clear = Compute::new(moves.clone(), "clear_points", Threads::Row(settings.count));
        let length = candidates(points, settings.method);
        let place = scan::steps(&cx.use_context(), &moves, length, "places")?;
        let tell = Compute::new(cx.shader(TELL, &[]), "tell", Threads::Row(settings.count));
        Ok(Recording::one(weigh)
            .then_all(take(cx, &settings, points)?)
            .then(clear)
            .then_all(place)
            .then_all(tells.then_some(tell)))
    }
}

/// Returns whether the density of what is chosen can be told: the race and its retries have no probabilities to tell it by.
fn tells(has_density: bool, method: Method) -> bool {
    has_density && method == Method::Systematic
}

/// Returns how many candidates there are for the places of the output: of a race, points that arrive together come behind those
/// that arrive before.
fn candidates(points: u32, method: Method) -> u32 {
    if method == Method::Race { 2 * points } else { points }
}

/// Returns the steps that decide which points are taken.
fn take(
    cx: &RecordContext<'_>,
    settings: &ResamplePointsSettings,
    points: u32,
) -> Result<Vec<Compute>, PassTypeError> {
    let use_cx = cx.use_context();
    let row = |path, entry, count| Compute::new(cx.shader(path, &[]), entry, Threads::Row(count));
    let mut steps = Vec::new();
    match settings.method {
        Method::Systematic => {
            for step in 0..STEPS {
                let reduce = reduce::steps(&use_cx, &cx.shader(THRESHOLD, &[]), points, "threshold_blocks")?;
                let first = Value::U32(u32::from(step == 0));
                steps.extend(reduce.into_iter().map(|step| step.value("first", first.clone())));
            }
            steps.extend(scan::steps(&use_cx, &cx.shader(SYSTEMATIC, &[]), points, "sums_of_blocks")?);
            steps.push(row(SYSTEMATIC, "take", points));
        }
        Method::Race => {
            steps.push(row(RACE, "arrive", points));
            steps.extend(select::steps(&use_cx, &cx.shader(RACE, &[]), points, "selection")?);
            steps.push(row(RACE, "take", points));
        }
        Method::Retries => {
            steps.push(segmented_scan(&cx.shader(CUMULATE, &[]), 1, 1));
            let claim = |entry, count, round| row(CLAIM, entry, count).value("round", Value::U32(round));
            steps.push(claim("clear_claims", points, 0));
            steps.extend((0..=settings.retries).map(|round| claim("claim", settings.count, round)));
            steps.push(claim("take", points, settings.retries));
        }
    }
    Ok(steps)
}
