//! `lightloom precision`: the error of single precision in shader functions.

use super::cases::CaseArgs;
use super::study::{fail_if_any, summary};
use crate::context::Context;
use crate::output::{self, progress, stdout};
use anyhow::{Result, bail};
use executor::wgpu::{self, BufferUsages};
use executor::{ExecutorError, Gpu};
use precision::{Evaluator, Fault, GROUP, Interpreted, Kernel, Options, Probe, Value};
use std::borrow::Cow;

/// Compare shader functions in f32 with the same functions in f64, over ranges of magnitudes.
///
/// A case is a probe: a WGSL file, also one of your own, that calls functions of shaders with inputs of one magnitude. Its error is
/// compared with the unavoidable one, that of rounded inputs and a rounded result. Exits with 1 if an error exceeds its bound.
#[derive(clap::Args)]
#[command(after_help = "Examples:
  lightloom precision
  lightloom precision ggx-peak spot-caps --interpret
  lightloom precision own.wgsl --samples 1000 -o out/own")]
pub(crate) struct Args {
    #[command(flatten)]
    cases: CaseArgs,
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
    let all = probes(context, &args.cases.names)?;
    let names: Vec<(String, String)> =
        all.iter().map(|probe| (probe.name.clone(), probe.about.clone())).collect();
    let Some(chosen) = args.cases.chosen(context, "precision", &names)? else { return Ok(()) };
    let probes: Vec<Probe> = chosen.into_iter().map(|index| all[index].clone()).collect();
    let evaluator = evaluator(args.interpret)?;
    let options =
        Options { magnitudes: args.magnitudes as usize, samples: args.samples as usize, seed: args.seed };
    let folder = args.cases.folder("precision");
    let bar = progress(probes.len() as u64, "precision");
    let (ran, measured) = precision::run(&probes, &*evaluator, &options, &folder, &mut |probe| {
        bar.set_message(probe.to_owned());
        bar.inc(1);
    })?;
    bar.finish_and_clear();
    let table = precision::table(&measured);
    let page = study::report_with(&ran.results, &folder, std::slice::from_ref(&table))?.swap_remove(0);
    if context.json {
        output::json(&summary(&ran.results, &page, Some(ran.run)));
    } else {
        stdout!("{}", table.text());
        stdout!("{}", page.display());
    }
    fail_if_any(&ran.results, context.json)?;
    let exceeding = measured.iter().filter(|measured| !measured.holds()).count();
    if exceeding > 0 {
        bail!("{exceeding} of {} probes exceed their bound; {} shows where", probes.len(), page.display());
    }
    Ok(())
}

/// Returns the probes of the tree and, of the names that are given, those of files.
fn probes(context: &Context, names: &[String]) -> Result<Vec<Probe>> {
    let library = context.catalog.shaders();
    let files = names.iter().filter(|name| name.ends_with(".wgsl")).cloned();
    let load = |path: String| -> Result<Probe> {
        let mut probe = Probe::load(library, &path)?;
        // A file is chosen by its path.
        if !path.starts_with(precision::FOLDER) {
            probe.name = path;
        }
        Ok(probe)
    };
    precision::paths(library).into_iter().chain(files).map(load).collect()
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
