#![doc = include_str!("../README.md")]

use gpu_algorithms::{reduce, scan, segmented_scan, select};
use interfaces::surface_points;
use pass::{
    Compute, OutputDesc, Outputs, PassTypeError, ReadSettings, RecordContext, Recording, Settings, Struct,
    Threads,
};

pass::from_wgsl!(outputs, record);

const SCALED: Struct = Struct::new("shaders/algorithms/scaled.wgsl", "Scaled");
const REDUCED: Struct = Struct::new("passes/resample-points/threshold.wgsl", "Reduced");

/// Steps towards the threshold of systematic sampling. Densities of nearest neighbours take two to five; weights that span 10³⁰
/// evenly take seven.
const STEPS: u32 = 16;

/// The method of the choice.
#[derive(Clone, Copy, PartialEq)]
enum Method {
    Systematic,
    Race,
    Retries,
}

impl Method {
    fn of(settings: &Settings) -> Result<Method, PassTypeError> {
        Ok(match settings.text("method")? {
            "race" => Method::Race,
            "retries" => Method::Retries,
            _ => Method::Systematic,
        })
    }

    /// Returns how many candidates there are for the places of the output: of a race, points that arrive together come behind
    /// those that arrive before.
    fn candidates(self, points: u32) -> u32 {
        if self == Method::Race { 2 * points } else { points }
    }
}

fn outputs(cx: &Outputs<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let mut outputs = cx.declared()?;
    let (points, method) = (cx.fact("points", surface_points::COUNT)?, Method::of(cx.settings)?);
    outputs.push(OutputDesc::scratch_u32("taken", points));
    outputs.extend(scan::scratch(&cx.use_cx, "places", method.candidates(points))?);
    match method {
        Method::Systematic => {
            let bytes = cx.use_cx.size_of(REDUCED)?;
            outputs.extend([
                cx.scratch("threshold", SCALED, 1)?,
                reduce::scratch(&cx.use_cx, "threshold_blocks", points, bytes)?,
                OutputDesc::scratch_u32("sums", 2 * points),
                OutputDesc::scratch_u32("total", 1),
            ]);
            outputs.extend(scan::scratch(&cx.use_cx, "sums_of_blocks", points)?);
        }
        Method::Race => outputs.extend([
            OutputDesc::scratch_u32("keys", points),
            OutputDesc::scratch_u32("last_key", 1),
            select::scratch(&cx.use_cx, "selection")?,
        ]),
        Method::Retries => outputs.extend([
            OutputDesc::scratch_u32("cumulated", points),
            cx.scratch("total", SCALED, 1)?,
            OutputDesc::scratch_u32("claims", points),
            OutputDesc::scratch_u32("found", cx.settings.u32("count")?),
        ]),
    }
    Ok(outputs)
}

fn record(cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
    let (points, method) = (cx.fact("points", surface_points::COUNT)?, Method::of(cx.settings)?);
    let count = cx.settings.u32("count")?;
    let main = cx.file("resample-points.wgsl");
    let step = |entry, threads| Compute::new(main.clone(), entry, Threads::Row(threads));
    let has_density = method == Method::Systematic && cx.connected("density");
    Ok(Recording::one(step("weigh", points))
        .then_all(take(cx, method, points)?)
        .then(step("clear_points", count))
        .then_all(scan::steps(&cx.use_context(), &main, method.candidates(points), "places")?)
        .then_all(has_density.then(|| step("weigh_chosen", count))))
}

/// Returns the steps that decide which points are taken.
fn take(cx: &RecordContext<'_>, method: Method, points: u32) -> Result<Vec<Compute>, PassTypeError> {
    let use_cx = cx.use_context();
    let row = |file, entry, count| Compute::new(cx.file(file), entry, Threads::Row(count));
    let mut steps = Vec::new();
    match method {
        Method::Systematic => {
            for step in 0..STEPS {
                let reduce = reduce::steps(&use_cx, &cx.file("threshold.wgsl"), points, "threshold_blocks")?;
                steps.extend(reduce.into_iter().map(|reduce| reduce.value("first", u32::from(step == 0))));
            }
            let sums = cx.file("systematic.wgsl");
            steps.extend(scan::steps(&use_cx, &sums, points, "sums_of_blocks")?);
            steps.push(row("systematic.wgsl", "take", points));
        }
        Method::Race => {
            steps.push(row("race.wgsl", "arrive", points));
            steps.extend(select::steps(&use_cx, &cx.file("race.wgsl"), points, "selection")?);
            steps.push(row("race.wgsl", "take", points));
        }
        Method::Retries => {
            let (count, retries) = (cx.settings.u32("count")?, cx.settings.u32("retries")?);
            steps.push(segmented_scan(&cx.file("cumulate.wgsl"), 1, 1));
            let claim = |entry, count, round: u32| row("claim.wgsl", entry, count).value("round", round);
            steps.push(claim("clear_claims", points, 0));
            steps.extend((0..=retries).map(|round| claim("claim", count, round)));
            steps.push(claim("take", points, retries));
        }
    }
    Ok(steps)
}
