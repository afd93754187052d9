//! The report of `render`.

use super::Args;
use super::faults::Broken;
use crate::context::Context;
use crate::output::{self, stdout};
use anyhow::Result;
use frame_graph::{Figure, human_bytes};
use metrics::statistics::median;
use renderer::{PortFigures, Renderer};
use serde_json::json;
use std::path::PathBuf;
use std::time::Duration;

/// The result of a rendering.
#[derive(Default)]
pub(super) struct Rendered {
    /// The pictures that were written, in order.
    pub(super) written: Vec<PathBuf>,
    /// The GPU time of each pass in each frame \[ms\].
    pub(super) times: Vec<Vec<f64>>,
    /// The time that it took \[s\].
    pub(super) seconds: f64,
    /// The pixels that are not finite.
    pub(super) broken: Broken,
    /// The time of the first picture, from the start of the process.
    pub(super) first_picture: Option<Duration>,
}

/// Prints the result, and the figures that the pipeline reports.
pub(super) fn report(context: &Context, args: &Args, renderer: &Renderer, done: &Rendered) -> Result<()> {
    let Rendered { written, times, seconds, broken, first_picture } = done;
    let first_picture = first_picture.filter(|_| args.time);
    let Some(plan) = renderer.plan() else { return Ok(()) };
    let rows: Vec<(String, f64)> = plan
        .passes
        .iter()
        .enumerate()
        .map(|(i, pass)| (pass.name.to_string(), median_after_the_first(times, i)))
        .collect();
    let clamped = clamped_share(renderer);
    let progress = renderer.progress()?;
    let figures = renderer.figures()?;
    if context.json {
        output::json(&json!({
            "pictures": written,
            "plan": plan.id.to_string(),
            "adapter": renderer.gpu().describe(),
            "seconds": seconds,
            "passes": rows.iter().map(|(name, ms)| json!({ "pass": name, "gpu_ms": if args.time { Some(*ms) } else { None } })).collect::<Vec<_>>(),
            "memory": { "unshared": plan.memory.unshared, "shared": plan.memory.shared, "bound": plan.memory.bound },
            "start": first_picture.map(|whole| context.phases.to_json(whole)),
            "clamped_energy": clamped,
            "pixels_not_finite": broken.pixels,
            "figures": figures.iter().map(figures_to_json).collect::<Vec<_>>(),
            "progress": progress.map(|progress| json!({ "step": progress.step, "steps": progress.steps, "error": progress.error, "done": progress.is_done() })),
        }));
        return Ok(());
    }
    if args.time {
        // What the driver compiles at the first use of a shader is in the first frame.
        let frames = if times.len() > 1 {
            "GPU ms"
        } else {
            "GPU ms of the first frame, with what the driver compiles"
        };
        stdout!("{:<40} {:>10}", "pass", frames);
        for (name, ms) in &rows {
            stdout!("{name:<40} {ms:>10.3}");
        }
        stdout!("{:<40} {:>10.3}", "all", rows.iter().map(|(_, ms)| ms).sum::<f64>());
        stdout!(
            "on {}; transients {} (unshared {}, bound {})",
            renderer.gpu().describe(),
            human_bytes(plan.memory.shared),
            human_bytes(plan.memory.unshared),
            human_bytes(plan.memory.bound)
        );
    }
    if let Some(whole) = first_picture {
        context.phases.print(whole);
    }
    if let Some(share) = clamped.filter(|share| *share > 0.0) {
        stdout!("clamping removed {:.2} % of the indirect irradiance", share * 100.0);
    }
    for port in worth_printing(&figures) {
        let values =
            port.values.iter().map(|(figure, value)| format!("{} {value}{}", figure.name, unit(figure)));
        stdout!("{}: {}", port.port, values.collect::<Vec<_>>().join(", "));
    }
    if let Some(progress) = progress {
        let state = if progress.is_done() { "converged" } else { "not converged" };
        // Not every pass that takes several frames estimates its error.
        let error = match progress.error {
            error if error > 0.0 => format!("; estimated error {error:.2e}"),
            error if error < 0.0 => "; the error cannot be known yet".to_owned(),
            _ => String::new(),
        };
        stdout!("{state} after {} of at most {} steps{error}", progress.step, progress.steps);
    }
    if let Some(path) = written.last() {
        let shown = path.canonicalize().unwrap_or_else(|_| path.clone());
        match written.len() {
            1 => stdout!("{}", shown.display()),
            n => stdout!("{n} pictures, the last {}", shown.display()),
        }
    }
    Ok(())
}

/// Returns the figures that are worth printing: not those of counters that produced all that was requested, and of passes
/// of a sub-graph that hand on one interface those of the last.
fn worth_printing(all: &[PortFigures]) -> impl Iterator<Item = &PortFigures> {
    let complete = |port: &PortFigures| {
        port.value("requested").is_some_and(|requested| port.value("produced") == Some(requested))
    };
    let group =
        |port: &PortFigures| (port.interface, port.port.rsplit_once('/').map(|(group, _)| group.to_owned()));
    all.iter().enumerate().filter_map(move |(i, port)| {
        let last = all[i + 1..].iter().all(|later| group(later) != group(port));
        (last && !complete(port)).then_some(port)
    })
}

/// Returns a figure's unit, after a space.
fn unit(figure: &Figure) -> String {
    if figure.unit.is_empty() { String::new() } else { format!(" {}", figure.unit) }
}

/// Returns the figures of a port as an object: the port as `of`, then each figure by its name.
fn figures_to_json(port: &PortFigures) -> serde_json::Value {
    let mut object = serde_json::Map::new();
    object.insert("of".to_owned(), json!(port.port.as_str()));
    object.extend(port.values.iter().map(|(figure, value)| (figure.name.to_owned(), json!(value))));
    object.into()
}

/// Returns the median of a pass's times over the frames after the first, in which drivers compile shaders.
fn median_after_the_first(times: &[Vec<f64>], pass: usize) -> f64 {
    let skip = usize::from(times.len() > 1);
    let mut column: Vec<f64> = times.iter().skip(skip).filter_map(|row| row.get(pass).copied()).collect();
    median(&mut column).unwrap_or(0.0)
}

/// Returns the share of the irradiance that clamping removed, if the pipeline has an output `irradiance`.
fn clamped_share(renderer: &Renderer) -> Option<f64> {
    metrics::virtual_lights::clamped_share(&renderer.output("irradiance").ok()?)
}
