//! `lightloom bench`: the performance figures on this machine.

mod encode;
mod graph;
mod rays;
mod reload;
mod roofline;
mod running;
mod start;
mod table;
mod value;

use crate::context::Context;
use crate::output::{self, progress};
use anyhow::{Result, bail};
use renderer::{Catalog, Gpu};
use std::cell::OnceCell;
use std::path::Path;
use std::sync::Arc;
use table::{Section, Table};

/// Measure the costs of Lightloom on this machine, apart from those of pipelines, which `study` measures.
///
/// Each figure is the median of several runs after the first, in which drivers compile shaders, with the least and the
/// greatest. A goal that is not met is no failure.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom bench
  lightloom bench --only rays --scene sponza.glb
  lightloom bench --markdown
  lightloom bench --only roofline")]
pub(crate) struct Args {
    /// Measure this figure only. May be repeated
    #[arg(long, value_name = "NAME")]
    only: Vec<Figure>,
    /// A scene by name or file: rays are traced in it too, and frames of the roofline are of the first that is given in place
    /// of the atrium. May be repeated
    #[arg(long)]
    scene: Vec<String>,
    /// Number of measured runs
    #[arg(long, default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    runs: u32,
    /// A quick preview: small sizes, to which the goals do not apply
    #[arg(long)]
    quick: bool,
    /// Print the table as Markdown
    #[arg(long, conflicts_with = "json")]
    markdown: bool,
}

/// The figures that can be measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Figure {
    /// Rays per second: closest hit and any hit; camera rays, and rays that leave what the camera sees over the
    /// cosine; by the hierarchy, and by ray queries where the adapter has them
    Rays,
    /// CPU time from the text of a pipeline of 1,000 passes to a plan, without shaders
    Compile,
    /// CPU time of a frame of 1,000 dispatches, from the call until all is submitted, beside the same calls of wgpu
    /// made by hand
    Encode,
    /// Memory of shared transient resources of each pipeline, against the largest sum of bytes alive at once: of
    /// each sort that can share an object, and of all
    Memory,
    /// CPU time to take another value of a setting, as a slider sets it
    Value,
    /// Time from the save of a shader to the end of the next frame, where the driver has compiled the same before, and
    /// where it has not
    Reload,
    /// Time from the start of a process to its first picture: `lightloom render ism-invtm cornell-box --size 64x64`, with
    /// what the driver has compiled before in its cache, and without
    Start,
    /// The limits of the adapter (copies, loads, stores, atomics, threads, barriers, arithmetic, dispatches, fragments,
    /// triangles), and the passes of three frames, each beside what it must move and do: `ism` with 1,024 lights, and `ism`
    /// and `ism-classic` with 256 maps of 256²
    Roofline,
}

/// The device and the options of a measurement.
struct Bench<'a> {
    context: &'a Context,
    args: &'a Args,
    gpu: OnceCell<Gpu>,
}

impl Bench<'_> {
    fn catalog(&self) -> &Arc<Catalog> {
        &self.context.catalog
    }

    /// Returns the device, opened for the first figure that needs one.
    fn gpu(&self) -> Result<Gpu> {
        if let Some(gpu) = self.gpu.get() {
            return Ok(gpu.clone());
        }
        let gpu = Gpu::open()?;
        Ok(self.gpu.get_or_init(|| gpu).clone())
    }

    /// Returns the device, if it can time passes.
    fn timing_gpu(&self) -> Result<Gpu> {
        let gpu = self.gpu()?;
        if !gpu.has_timestamps() {
            bail!("{} has no timestamps, by which passes are timed", gpu.describe());
        }
        Ok(gpu)
    }

    /// Returns a size, or that of a quick preview.
    fn size(&self, whole: u32, quick: u32) -> u32 {
        if self.args.quick { quick } else { whole }
    }
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let bench = Bench { context, args, gpu: OnceCell::new() };
    let all: &[Figure] = clap::ValueEnum::value_variants();
    let wanted = all.iter().filter(|figure| args.only.is_empty() || args.only.contains(figure));
    let wanted: Vec<Figure> = wanted.copied().collect();
    let bar = progress(wanted.len() as u64, "measuring");
    let mut sections = Vec::new();
    for figure in wanted {
        sections.push(measure(&bench, figure)?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let table = Table::new(sections, bench.gpu.get(), args);
    if context.json {
        output::json(&table.to_json());
    } else {
        table.print();
    }
    Ok(())
}

fn measure(bench: &Bench<'_>, figure: Figure) -> Result<Section> {
    match figure {
        Figure::Rays => rays::measure(bench),
        Figure::Compile => graph::compiling(bench),
        Figure::Encode => encode::measure(bench),
        Figure::Memory => graph::memory(bench),
        Figure::Value => value::measure(bench),
        Figure::Reload => reload::measure(bench),
        Figure::Start => start::measure(bench),
        Figure::Roofline => roofline::measure(bench),
    }
}

/// Returns the name of a scene, or that of its file.
fn label(scene: &str) -> &str {
    Path::new(scene).file_stem().and_then(|stem| stem.to_str()).unwrap_or(scene)
}
