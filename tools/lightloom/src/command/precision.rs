//! `lightloom precision`: the error of single precision in shader functions.

use super::lists::print;
use crate::context::{Context, unknown};
use crate::output::{self, progress, stdout, write};
use anyhow::{Context as _, Result, bail};
use executor::wgpu::{self, BufferUsages};
use executor::{ExecutorError, Gpu};
use precision::{Evaluator, Fault, GROUP, Interpreted, Kernel, Options, Probe, Value};
use serde_json::json;
use std::borrow::Cow;
use std::path::PathBuf;

/// Compare shader functions in f32 with the same functions in f64, over ranges of magnitudes.
///
/// A probe is a WGSL file that calls functions of shaders with inputs of one magnitude. Its error is compared with the
/// unavoidable one, that of rounded inputs and a rounded result. Exits with 1 if an error exceeds its bound.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom precision
  lightloom precision ggx-peak spot-caps --interpret
  lightloom precision own.wgsl --samples 1000 -o out/own")]
pub(crate) struct Args {
    /// Probes, by name or .wgsl file; all by default
    #[arg(value_name = "PROBE|FILE.wgsl")]
    probes: Vec<String>,
    /// The folder for the report
    #[arg(short, long = "out", value_name = "DIR", default_value = "out/precision")]
    out: PathBuf,
    /// List the probes
    #[arg(long)]
    list: bool,
    /// Compute f32 by the interpreter instead of the GPU: each operation is rounded once
    #[arg(long)]
    interpret: bool,
    /// Magnitudes of each probe
    #[arg(long, default_value_t = 33, value_parser = clap::value_parser!(u32).range(2..=1000))]
    magnitudes: u32,
    /// Samples of each magnitude
    #[arg(long, default_value_t = 128, value_parser = clap::value_parser!(u32).range(1..=100_000))]
    samples: u32,
    /// Seed of the samples
    #[arg(long, default_value_t = 0)]
    seed: u64,
}

pub(crate) fn run(context: &Context, args: &Args) -> Result<()> {
    let probes = chosen(context, &args.probes)?;
    if args.list {
        print(context, &probes.into_iter().map(|probe| (probe.name, probe.about)).collect::<Vec<_>>());
        return Ok(());
    }
    let evaluator = evaluator(args.interpret)?;
    let options =
        Options { magnitudes: args.magnitudes as usize, samples: args.samples as usize, seed: args.seed };
    let bar = progress(probes.len() as u64, "precision");
    let mut all = Vec::with_capacity(probes.len());
    for probe in &probes {
        bar.set_message(probe.name.clone());
        let measured = precision::measure(probe, &*evaluator, &options);
        all.push(measured.with_context(|| format!("`{}` cannot be measured", probe.name))?);
        bar.inc(1);
    }
    bar.finish_and_clear();
    let about = format!(
        "Lightloom {}; f32 by {}; {} samples of each of {} magnitudes.",
        env!("CARGO_PKG_VERSION"),
        evaluator.name(),
        args.samples,
        args.magnitudes
    );
    let record = precision::json(&all);
    std::fs::create_dir_all(&args.out)
        .with_context(|| format!("the folder {} cannot be made", args.out.display()))?;
    let page = args.out.join("report.html");
    write(&args.out.join("probes.json"), &format!("{record:#}\n"))?;
    write(&page, &precision::html(&all, &about))?;
    if context.json {
        output::json(&json!({ "report": page, "by": evaluator.name(), "probes": record }));
    } else {
        stdout!("{}", precision::table(&all).text());
        stdout!("{}", page.display());
    }
    let exceeding = all.iter().filter(|measured| !measured.holds()).count();
    if exceeding > 0 {
        bail!("{exceeding} of {} probes exceed their bound; {} shows where", all.len(), page.display());
    }
    Ok(())
}

/// Returns the probes of these names and files; all if there are none.
fn chosen(context: &Context, names: &[String]) -> Result<Vec<Probe>> {
    let library = context.catalog.shaders();
    let all = precision::paths(library);
    let stem = |path: &str| path.trim_start_matches(precision::FOLDER).trim_end_matches(".wgsl").to_owned();
    let mut paths = Vec::new();
    for name in names {
        if name.ends_with(".wgsl") {
            paths.push(name.clone());
        } else if let Some(path) = all.iter().find(|path| stem(path) == *name) {
            paths.push(path.clone());
        } else {
            let stems: Vec<String> = all.iter().map(|path| stem(path)).collect();
            return Err(unknown("probe", name, &stems, "precision --list"));
        }
    }
    let paths = if names.is_empty() { all } else { paths };
    paths.iter().map(|path| Ok(Probe::load(library, path)?)).collect()
}

/// Returns the GPU, if there is one and it is requested.
fn evaluator(interpret: bool) -> Result<Box<dyn Evaluator>> {
    if interpret {
        return Ok(Box::new(Interpreted));
    }
    match Gpu::open() {
        Ok(gpu) => Ok(Box::new(OnGpu(gpu))),
        Err(ExecutorError::NoAdapter) => Ok(Box::new(Interpreted)),
        Err(error) => Err(error.into()),
    }
}

/// Greatest number of inputs of a dispatch, which bounds its time.
const MOST_AT_ONCE: usize = 4096;

/// Computes in `f32` by a compute shader.
struct OnGpu(Gpu);

impl Evaluator for OnGpu {
    fn name(&self) -> String {
        self.0.describe()
    }

    fn evaluate(&self, probe: &Probe, given: &[Value<f32>]) -> Result<Vec<[f32; 4]>, Fault> {
        let kernel = Kernel::new(probe)?;
        let failed = |error: anyhow::Error| Fault { message: format!("{error:#}"), place: None };
        let pipeline = self.pipeline(&kernel);
        let mut results = Vec::with_capacity(given.len());
        for given in given.chunks(MOST_AT_ONCE) {
            let bytes = kernel.bytes(given)?;
            results.extend(self.dispatch(&pipeline, &bytes, given.len()).map_err(failed)?);
        }
        Ok(results)
    }
}

/// Bytes of a result.
const RESULT: usize = 16;

impl OnGpu {
    fn pipeline(&self, kernel: &Kernel) -> wgpu::ComputePipeline {
        let device = &self.0.device;
        let module = device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(Kernel::ENTRY),
            source: wgpu::ShaderSource::Naga(Cow::Owned(kernel.module.clone())),
        });
        device.create_compute_pipeline(&wgpu::ComputePipelineDescriptor {
            label: Some(Kernel::ENTRY),
            layout: None,
            module: &module,
            entry_point: Some(Kernel::ENTRY),
            compilation_options: wgpu::PipelineCompilationOptions::default(),
            cache: None,
        })
    }

    fn dispatch(
        &self,
        pipeline: &wgpu::ComputePipeline,
        given: &[u8],
        count: usize,
    ) -> Result<Vec<[f32; 4]>> {
        let device = &self.0.device;
        let size = (count * RESULT) as u64;
        let buffer = |size: u64, usage: BufferUsages| {
            let label = Some(Kernel::ENTRY);
            device.create_buffer(&wgpu::BufferDescriptor { label, size, usage, mapped_at_creation: false })
        };
        let inputs = buffer(given.len() as u64, BufferUsages::STORAGE | BufferUsages::COPY_DST);
        let results = buffer(size, BufferUsages::STORAGE | BufferUsages::COPY_SRC);
        let readable = buffer(size, BufferUsages::COPY_DST | BufferUsages::MAP_READ);
        self.0.queue.write_buffer(&inputs, 0, given);
        let group = device.create_bind_group(&wgpu::BindGroupDescriptor {
            label: Some(Kernel::ENTRY),
            layout: &pipeline.get_bind_group_layout(0),
            entries: &[
                wgpu::BindGroupEntry { binding: 0, resource: inputs.as_entire_binding() },
                wgpu::BindGroupEntry { binding: 1, resource: results.as_entire_binding() },
            ],
        });
        let mut encoder = device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
        {
            let mut pass = encoder.begin_compute_pass(&wgpu::ComputePassDescriptor::default());
            pass.set_pipeline(pipeline);
            pass.set_bind_group(0, &group, &[]);
            pass.dispatch_workgroups((count as u32).div_ceil(GROUP), 1, 1);
        }
        encoder.copy_buffer_to_buffer(&results, 0, &readable, 0, size);
        self.0.submit(Some(encoder.finish()));
        if let Some(fault) = self.0.take_fault() {
            bail!("the GPU did not compute it: {fault}");
        }
        let bytes = executor::map_buffer(&self.0, &readable, Kernel::ENTRY)?;
        let number = |bytes: &[u8]| f32::from_le_bytes(bytes.try_into().unwrap_or_default());
        let result = |bytes: &[u8]| std::array::from_fn(|i| number(&bytes[4 * i..4 * i + 4]));
        Ok(bytes.chunks_exact(RESULT).map(result).collect())
    }
}
