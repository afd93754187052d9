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

use super::cases::CaseArgs;
use super::study::{fail_if_any, summary};
use crate::context::Context;
use crate::output::{self, progress, stdout};
use anyhow::{Result, bail};
use renderer::{Catalog, Gpu};
use std::cell::OnceCell;
use std::path::Path;
use std::sync::Arc;
use study::{Failure, StudyRecord};
use table::Section;

/// Measure the costs of Lightloom on this machine, apart from those of pipelines, which `study` measures.
///
/// Each row is the median of several runs after the first, in which drivers compile shaders, with the least and the
/// greatest. A goal that is not met is no failure.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom bench
  lightloom bench rays --scene sponza.glb
  lightloom bench roofline -o out/roofline")]
pub(crate) struct Args {
    #[command(flatten)]
    cases: CaseArgs,
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
}

/// A figure that can be measured.
struct Figure {
    name: &'static str,
    about: &'static str,
    measure: fn(&Bench<'_>) -> Result<Section>,
}

const FIGURES: [Figure; 8] = [
    Figure {
        name: "rays",
        about: "Rays per second: closest hit and any hit; camera rays, and rays that leave what the camera sees over the cosine; by \
                the hierarchy, and by ray queries where the adapter has them",
        measure: rays::measure,
    },
    Figure {
        name: "compile",
        about: "CPU time from the text of a pipeline of 1,000 passes to a plan, without shaders",
        measure: graph::compiling,
    },
    Figure {
        name: "encode",
        about: "CPU time of a frame of 1,000 dispatches, from the call until all is submitted, beside the same calls of wgpu made by \
                hand",
        measure: encode::measure,
    },
    Figure {
        name: "memory",
        about: "Memory of shared transient resources of each pipeline, against the largest sum of bytes alive at once: of each sort \
                that can share an object, and of all",
        measure: graph::memory,
    },
    Figure {
        name: "value",
        about: "CPU time to take another value of a setting, as a slider sets it",
        measure: value::measure,
    },
    Figure {
        name: "reload",
        about: "Time from the save of a shader to the end of the next frame, where the driver has compiled the same before, and where \
                it has not",
        measure: reload::measure,
    },
    Figure {
        name: "start",
        about: "Time from the start of a process to its first picture: `lightloom render ism-invtm cornell-box --size 64x64`, with \
                what the driver has compiled before in its cache, and without",
        measure: start::measure,
    },
    Figure {
        name: ROOFLINE,
        about: "The limits of the adapter (copies, loads, stores, atomics, threads, barriers, arithmetic, dispatches, fragments, \
                triangles), and the passes of three frames, each beside what it must move and do: `ism` with 1,024 lights, and `ism` \
                and `ism-classic` with 256 maps of 256²",
        measure: roofline::measure,
    },
];

/// The figure whose goals follow from sizes, and so apply to a quick preview too.
const ROOFLINE: &str = "roofline";

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
    let all: Vec<(String, String)> =
        FIGURES.iter().map(|figure| (figure.name.to_owned(), figure.about.to_owned())).collect();
    let Some(chosen) = args.cases.chosen(context, "bench", &all)? else { return Ok(()) };
    let figures: Vec<&Figure> = chosen.into_iter().map(|index| &FIGURES[index]).collect();
    let bench = Bench { context, args, gpu: OnceCell::new() };
    let folder = args.cases.folder("bench");
    let bar = progress(figures.len() as u64, "measuring");
    let mut sections = Vec::new();
    let ran =
        study::measure_cases(table::blank(&figures, args.runs, args.quick), &folder, &mut |study, case| {
            let Figure { name, measure, .. } = figures[case];
            let mut section = measure(&bench).map_err(|error| Failure::render(format!("{error:#}")))?;
            if args.quick && *name != ROOFLINE {
                section.rows.iter_mut().for_each(|row| (row.goal, row.from) = (None, ""));
            }
            if let Some(gpu) = bench.gpu.get() {
                study.adapter = gpu.describe();
            }
            let cells = section.cells(study, case);
            sections.push(section);
            bar.inc(1);
            Ok(cells)
        })?;
    bar.finish_and_clear();
    let table = table::of_rows(&sections);
    let page = study::report_with(&ran.results, &folder, std::slice::from_ref(&table))?.swap_remove(0);
    if context.json {
        output::json(&summary(&ran.results, &page, Some(ran.run)));
    } else {
        stdout!("{}", table.text().trim_start());
        for case in &ran.results.study.scenes {
            stdout!("- `{}`: {}", case.name, case.about);
        }
        let StudyRecord { version, adapter, budget, .. } = &ran.results.study;
        let adapter = if adapter.is_empty() { "no adapter was requested" } else { adapter };
        stdout!("\nLightloom {version}; {adapter}; {budget}\n{}", page.display());
    }
    fail_if_any(&ran.results, context.json)
}

/// Returns the name of a scene, or that of its file.
fn label(scene: &str) -> &str {
    Path::new(scene).file_stem().and_then(|stem| stem.to_str()).unwrap_or(scene)
}
