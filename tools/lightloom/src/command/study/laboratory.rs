//! Cells on the GPU.

use super::registry::overrides;
use frame_graph::{CompileOptions, LinkContext, Plan};
use glam::Vec3;
use interfaces::virtual_lights;
use metrics::Image;
use metrics::temporal::Pinhole;
use ray_tracing::Bvh;
use renderer::{
    Catalog, Compiled, ExecutorError, FrameOptions, FrameReport, Gpu, Progress, Provenance, Renderer,
    load_scene,
};
use scene::{Camera, Scene};
use std::collections::HashMap;
use std::fmt::Write as _;
use std::ops::ControlFlow;
use std::sync::Arc;
use study::{CellRun, Failure, Laboratory, Memory, Observed, Occluded, RunRequest, Step};
use xxhash_rust::xxh3::xxh3_128;

/// Gap between a ray and the surfaces at its ends, as a share of its length.
const OFF_SURFACE: f32 = 1e-3;

/// The most triangles of a scene that is kept while others are rendered.
const MOST_KEPT: usize = 1 << 20;

/// Renders on a device, each run with a renderer of its own, so that cells are independent.
pub(crate) struct GpuLaboratory {
    catalog: Arc<Catalog>,
    gpu: Gpu,
    /// The adapter by index or name, to open it again; `None` for the best.
    adapter: Option<String>,
    scenes: HashMap<String, Scene>,
}

/// Names of the resources that a run reads back beside the picture.
#[derive(Default)]
struct Extras {
    depth: Option<String>,
    normal: Option<String>,
    lights: Option<String>,
}

impl GpuLaboratory {
    /// Opens an adapter by index or name; `None` for the best.
    pub(crate) fn open(catalog: Arc<Catalog>, adapter: Option<&str>) -> Result<GpuLaboratory, ExecutorError> {
        let gpu = open(adapter)?;
        Ok(GpuLaboratory { catalog, gpu, adapter: adapter.map(str::to_owned), scenes: HashMap::new() })
    }

    pub(super) fn scene(&mut self, name: &str) -> Result<&Scene, Failure> {
        if !self.scenes.contains_key(name) {
            // A scene of gigabytes is not kept beside others.
            self.scenes.retain(|_, scene| scene.triangles() < MOST_KEPT);
            let scene = load_scene(&self.catalog, name).map_err(Failure::render)?;
            self.scenes.insert(name.to_owned(), scene);
        }
        Ok(&self.scenes[name])
    }

    fn render(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        step: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        let scene = self.scene(&request.scene)?.clone();
        let mut renderer = Renderer::new(self.gpu.clone(), Arc::clone(&self.catalog), scene, request.size)
            .map_err(Failure::render)?;
        renderer.set_seed(request.seed);
        renderer.set_pipeline(&request.pipeline, &overrides(&request.set)).map_err(Failure::render)?;
        // Memory of resources that are kept for measures is not the pipeline's.
        let memory = memory(&renderer);
        let extras = keep_extras(&mut renderer, request)?;
        if !request.until_done && request.stop_after_ms.is_none() {
            converge(&mut renderer, request)?;
        }
        renderer.set_frame_options(FrameOptions { timed: request.timed, ..FrameOptions::default() });
        renderer.set_frame_index(request.first_frame);
        let noise = if request.until_done {
            accumulate(&mut renderer, request, &extras, observe, step)?
        } else {
            sequence(&mut renderer, request, &extras, observe)?;
            None
        };
        let provenance =
            Provenance::new(&renderer, &request.scene, (&request.output, 0), request.first_frame).to_json();
        Ok(CellRun { memory, provenance, noise, ..CellRun::default() })
    }
}

fn open(adapter: Option<&str>) -> Result<Gpu, ExecutorError> {
    // Cells differ in seeds and values far more often than in shaders.
    adapter.map_or_else(Gpu::open, Gpu::open_adapter).map(Gpu::with_shared_pipelines)
}

fn options(keep: Vec<String>) -> CompileOptions {
    CompileOptions { keep, ..renderer::compile_options() }
}

impl Laboratory for GpuLaboratory {
    fn adapter(&self) -> String {
        self.gpu.describe()
    }

    fn identity(&mut self, request: &RunRequest) -> Result<u128, Failure> {
        let scene = self.scene(&request.scene)?;
        let (context, scene) = (LinkContext { frame: request.size, traits: scene.traits() }, scene.hash);
        let values = overrides(&request.set);
        let compiled =
            Compiled::new(&self.catalog, &request.pipeline, &values, &context, &options(Vec::new()))
                .map_err(Failure::render)?;
        let mut text = format!("{} {scene:032x}", compiled.plan.id);
        for step in compiled.steps.iter().flatten() {
            let _ = write!(text, " {:032x}", step.shader.hash);
        }
        Ok(xxh3_128(text.as_bytes()))
    }

    fn run(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        step: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        let done = self.render(request, observe, step);
        // A device that was lost takes no other cell with it.
        if let (Err(_), Ok(gpu)) = (&done, open(self.adapter.as_deref())) {
            self.gpu = gpu;
        }
        done
    }

    fn occluded(&mut self, scene: &str, frame: u32) -> Result<Occluded, Failure> {
        let scene = self.scene(scene)?;
        let mut positions: Vec<[f32; 3]> = scene.vertices.iter().map(|vertex| vertex.position).collect();
        for moved in scene.at(scene.frame_time(frame)).moved {
            let first = moved.first_vertex as usize;
            for (position, vertex) in positions[first..].iter_mut().zip(&moved.vertices) {
                *position = vertex.position;
            }
        }
        let bvh = Bvh::build(&positions, &scene.indices);
        Ok(Box::new(move |from, to| {
            let (from, to) = (Vec3::from(from), Vec3::from(to));
            bvh.occluded(from, to - from, OFF_SURFACE, 1.0 - OFF_SURFACE)
        }))
    }
}

fn memory(renderer: &Renderer) -> Memory {
    renderer.plan().map_or_else(Memory::default, |plan| Memory {
        unshared: plan.memory.unshared,
        shared: plan.memory.shared,
        bound: plan.memory.bound,
        held: renderer.held_bytes(),
    })
}

/// Keeps the resources that measures read beside the picture.
fn keep_extras(renderer: &mut Renderer, request: &RunRequest) -> Result<Extras, Failure> {
    let Some(plan) = renderer.plan() else { return Ok(Extras::default()) };
    let of = |wanted: bool, interface: &str, member: &str| {
        wanted.then(|| resource(plan, interface, member)).flatten()
    };
    let extras = Extras {
        depth: of(request.views, "GBuffer", "depth"),
        normal: of(request.views, "GBuffer", "normal"),
        // A plan may have several sets of lights; the output `lights` comes first.
        lights: request
            .lights
            .then(|| plan.output("lights"))
            .flatten()
            .and_then(|output| output.members.first())
            .map(|(_, id)| plan.resources[id.0 as usize].name.to_string())
            .or_else(|| of(request.lights, "VirtualLights", "")),
    };
    let keep: Vec<String> =
        [&extras.depth, &extras.normal, &extras.lights].into_iter().flatten().cloned().collect();
    // The estimate of the error depends on the outputs that are read: only the measured picture is.
    let read = [request.output.as_str(), "progress"];
    let estimates = request.until_done && read.iter().all(|name| plan.output(name).is_some());
    let outputs = if estimates { read.map(str::to_owned).to_vec() } else { Vec::new() };
    if !keep.is_empty() || !outputs.is_empty() {
        renderer.set_compile_options(CompileOptions { outputs, ..options(keep) }).map_err(Failure::render)?;
    }
    renderer.keep(&request.output).map_err(Failure::render)?;
    Ok(extras)
}

/// Returns the name of the first resource of an interface in a plan.
fn resource(plan: &Plan, interface: &str, member: &str) -> Option<String> {
    let ports = plan.passes.iter().flat_map(|pass| &pass.outputs);
    let mut members =
        ports.filter(|port| port.interface.as_str() == interface).flat_map(|port| &port.members);
    let (_, id) = members.find(|(name, _)| name.as_str() == member)?;
    Some(plan.resources[id.0 as usize].name.to_string())
}

/// Repeats the first frame, untimed, until a pipeline with an output `progress` has converged. Other pipelines run
/// nothing here.
fn converge(renderer: &mut Renderer, request: &RunRequest) -> Result<(), Failure> {
    if renderer.plan().is_none_or(|plan| plan.output("progress").is_none()) {
        return Ok(());
    }
    renderer.set_frame_index(request.first_frame);
    renderer.frame_until_done(|_, _| ControlFlow::Continue(())).map_err(Failure::render)?;
    Ok(())
}

/// Renders a sequence, and passes each frame on after the warm-up. A budget of time that is spent over frames includes
/// everything that the first frame needs; accumulation begins again.
fn sequence(
    renderer: &mut Renderer,
    request: &RunRequest,
    extras: &Extras,
    observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
) -> Result<(), Failure> {
    let mut spent = 0.0;
    for offset in 0..request.warm_up.saturating_add(request.frames) {
        let first = offset == request.warm_up;
        if request.timed && (request.stop_after_ms.is_none() || first) {
            renderer.run_everything();
        }
        if request.stop_after_ms.is_some() && first {
            renderer.set_camera(None, true);
        }
        let times = renderer.frame().map_err(Failure::render)?.times.clone();
        if offset < request.warm_up {
            continue;
        }
        spent += times.iter().sum::<f64>();
        observe(observed(renderer, request, extras, request.first_frame + offset, &times)?)?;
        match request.stop_after_ms {
            Some(_) if times.is_empty() => {
                return Err(Failure::Untimed);
            }
            Some(most) if spent >= most => break,
            _ => {}
        }
    }
    Ok(())
}

/// Repeats one frame until the pipeline has converged. Returns its estimate of the remaining noise.
fn accumulate(
    renderer: &mut Renderer,
    request: &RunRequest,
    extras: &Extras,
    observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
    step: &mut dyn FnMut(Step),
) -> Result<Option<f64>, Failure> {
    let mut noise = None;
    renderer.set_frame_index(request.first_frame);
    let progressed = |_: &FrameReport, progress: Option<Progress>| {
        noise = progress
            .map(|progress| f64::from(progress.error))
            .filter(|error| error.is_finite() && *error > 0.0);
        if let Some(progress) = progress {
            step(Step { step: progress.step, steps: progress.steps, noise });
        }
        ControlFlow::Continue(())
    };
    renderer.frames_until_done(request.frames, progressed).map_err(Failure::render)?;
    observe(observed(renderer, request, extras, request.first_frame, &[])?)?;
    Ok(noise)
}

fn observed(
    renderer: &Renderer,
    request: &RunRequest,
    extras: &Extras,
    frame: u32,
    times: &[f64],
) -> Result<Observed, Failure> {
    let plan = renderer.plan().map(Arc::clone).ok_or_else(|| Failure::render("no plan is loaded"))?;
    let of_view = |name: &Option<String>| -> Result<Option<Image>, Failure> {
        let samples =
            name.as_ref().map(|name| renderer.picture(name, 0).map_err(Failure::render)).transpose()?;
        Ok(samples.map(|samples| sample_of_each_pixel(&samples, request.size)))
    };
    let lights = extras
        .lights
        .as_ref()
        .and_then(|name| plan.resources.iter().position(|resource| resource.name.as_str() == name));
    let lights = lights.map(|index| -> Result<_, Failure> {
        let bytes =
            renderer.resource_bytes(frame_graph::plan::ResourceId(index as u32)).map_err(Failure::render)?;
        virtual_lights::from_bytes(&bytes)
            .ok_or_else(|| Failure::render("the buffer holds fewer lights than it says"))
    });
    let scene = renderer.scene();
    Ok(Observed {
        frame,
        figures: figures(renderer, &request.figures)?,
        image: renderer.picture(&request.output, 0).map_err(Failure::render)?,
        passes: plan.passes.iter().map(|pass| pass.name.to_string()).zip(times.iter().copied()).collect(),
        depth: of_view(&extras.depth)?,
        normal: of_view(&extras.normal)?,
        camera: pinhole(&scene.at(scene.frame_time(frame)).camera, request.size),
        lights: lights.transpose()?.map(|lights| lights.iter().map(measured).collect()),
        irradiance: plan.output("irradiance").and_then(|_| renderer.output("irradiance").ok()),
    })
}

/// Returns the sample of a supersampled view that is nearest to the centre of each pixel; other views as they are.
fn sample_of_each_pixel(samples: &Image, frame: (u32, u32)) -> Image {
    let side = (samples.width() / frame.0.max(1) as usize).max(1);
    let at =
        |x: usize, y: usize| samples.pixels()[(y * side + side / 2) * samples.width() + x * side + side / 2];
    Image::from_fn(samples.width() / side, samples.height() / side, at).unwrap_or_else(|_| samples.clone())
}

/// Returns the requested figures of the last frame.
fn figures(renderer: &Renderer, wanted: &[String]) -> Result<Vec<(String, f64)>, Failure> {
    if wanted.is_empty() {
        return Ok(Vec::new());
    }
    let ports = renderer.figures().map_err(Failure::render)?;
    let named = ports.iter().flat_map(|port| {
        port.values.iter().map(|(figure, value)| (format!("{}.{}", port.port, figure.name), *value))
    });
    Ok(named.filter(|(name, _)| wanted.contains(name)).collect())
}

/// Returns the properties of a virtual light that measures use.
fn measured(light: &virtual_lights::VirtualLight) -> metrics::virtual_lights::VirtualLight {
    let virtual_lights::VirtualLight { position, normal, flux, area, .. } = *light;
    metrics::virtual_lights::VirtualLight { position, normal, flux, area }
}

pub(super) fn pinhole(camera: &Camera, size: (u32, u32)) -> Pinhole {
    let view = camera.view();
    let row = |index: usize| {
        let row = view.row(index);
        [f64::from(row.x), f64::from(row.y), f64::from(row.z)]
    };
    let half = (f64::from(camera.vertical_fov) * 0.5).tan();
    let aspect = f64::from(size.0) / f64::from(size.1);
    Pinhole {
        position: camera.position.to_array().map(f64::from),
        right: row(0),
        up: row(1),
        back: row(2),
        half_extent: [half * aspect, half],
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pinhole_sees_what_its_camera_sees() {
        let camera = Camera {
            position: Vec3::new(1.0, 2.0, 3.0),
            target: Vec3::new(-2.0, 1.5, 0.0),
            up: Vec3::Y,
            vertical_fov: 0.7,
            near: 0.01,
        };
        let size = (640, 360);
        let pinhole = pinhole(&camera, size);
        for point in [Vec3::ZERO, Vec3::new(-1.0, 2.5, 1.5), Vec3::new(-3.0, 0.0, 2.0)] {
            let seen = camera.project(point, [size.0, size.1]).unwrap();
            let position = point.to_array().map(f64::from);
            let (x, y, depth) = pinhole.project(position, (640, 360)).unwrap();
            assert!(
                (x - f64::from(seen.x)).abs() < 1e-2 && (y - f64::from(seen.y)).abs() < 1e-2,
                "{x} {y} {seen}"
            );
            let back = pinhole.world(x, y, depth, (640, 360));
            // The axes are rounded to f32: 6·10⁻⁸ of some metres.
            assert!(back.iter().zip(position).all(|(a, b)| (a - b).abs() < 1e-6), "{back:?}");
        }
    }
}
