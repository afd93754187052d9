//! The renderer.

use crate::arrays::{described, pixels};
use crate::error::raise;
use crate::files::{Drawn, drawn};
use crate::pictures::{Shown, shown};
use crate::session::{catalog, check_process, device, is_forked};
use crate::value::{Given, overrides, to_python};
use anyhow::{Context as _, Result, anyhow, bail, ensure};
use frame_graph::nearest_of_few;
use metrics::Display;
use numpy::{PyArray1, PyArray3};
use pyo3::prelude::*;
use renderer::{FrameOptions, Provenance, RecordedLight, Reload};
use scene::{BRIGHTEST, Camera, Light, LightKind};
use std::collections::BTreeSet;
use std::f32::consts::PI;
use std::ops::ControlFlow;
use std::path::PathBuf;
use std::sync::{Mutex, TryLockError};

/// A renderer of a scene by a pipeline.
#[pyclass(frozen, module = "lightloom._lightloom")]
pub(crate) struct Renderer {
    /// `None` only while it is dropped.
    inner: Mutex<Option<Inner>>,
}

struct Inner {
    renderer: renderer::Renderer,
    /// The scene as it was named.
    scene: String,
    /// The number of the next frame.
    next: u32,
    /// The number of the first frame that ran since history buffers were empty, for records.
    first_frame: u32,
}

impl Inner {
    /// Notes that history buffers are empty.
    fn begin(&mut self) {
        self.first_frame = self.next;
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        // Its device is not this process's.
        if is_forked() {
            std::mem::forget(self.inner.get_mut().map(Option::take));
        }
    }
}

impl Renderer {
    /// Runs `f` without the interpreter's lock. One thread at a time may use a renderer.
    fn with<T: Send>(&self, py: Python<'_>, f: impl FnOnce(&mut Inner) -> Result<T> + Send) -> PyResult<T> {
        let run = || {
            check_process()?;
            let mut inner = match self.inner.try_lock() {
                Ok(inner) => inner,
                Err(TryLockError::WouldBlock) => {
                    bail!("another thread uses this renderer now; give each thread a renderer of its own")
                }
                Err(TryLockError::Poisoned(_)) => bail!("this renderer has failed before; make another"),
            };
            f(inner.as_mut().context("this renderer is gone")?)
        };
        py.detach(run).map_err(|error| raise(py, &error))
    }
}

#[pymethods]
impl Renderer {
    /// Opens the device and loads the scene and the pipeline.
    #[new]
    fn new(
        py: Python<'_>,
        scene: String,
        pipeline: &str,
        size: (u32, u32),
        settings: Vec<(String, Given)>,
        adapter: Option<String>,
        seed: u32,
    ) -> PyResult<Renderer> {
        let settings = overrides(settings);
        let made = py.detach(|| -> Result<Inner> {
            let catalog = catalog();
            // Errors of files need no device.
            let loaded = renderer::load_scene(&catalog, &scene)?;
            let gpu = device(adapter)?;
            let mut renderer = renderer::Renderer::new(gpu, catalog, loaded, size)?;
            renderer.set_seed(seed);
            renderer.set_frame_options(FrameOptions { monitored: true, ..FrameOptions::default() });
            renderer.set_pipeline(pipeline, &settings)?;
            Ok(Inner { renderer, scene, next: 0, first_frame: 0 })
        });
        let inner = made.map_err(|error| raise(py, &error))?;
        Ok(Renderer { inner: Mutex::new(Some(inner)) })
    }

    /// Runs a number of frames, or as many as the pipeline's output `progress` asks for in each of them.
    fn frames(&self, py: Python<'_>, count: u32, until_done: bool) -> PyResult<()> {
        for _ in 0..count {
            let mut interrupted = None;
            self.with(py, |inner| {
                if until_done {
                    inner.renderer.frame_until_done(|_, _| {
                        interrupted = Python::attach(|py| py.check_signals()).err();
                        if interrupted.is_some() { ControlFlow::Break(()) } else { ControlFlow::Continue(()) }
                    })?;
                } else {
                    inner.renderer.frame()?;
                }
                inner.next = inner.next.wrapping_add(1);
                Ok(())
            })?;
            interrupted.map_or_else(|| py.check_signals(), Err)?;
        }
        Ok(())
    }

    /// Returns an output or a layer of a texture, `[height, width, 4]`.
    fn picture<'py>(&self, py: Python<'py>, name: &str, layer: u32) -> PyResult<Bound<'py, PyArray3<f32>>> {
        pixels(py, self.with(py, |inner| Ok(inner.renderer.picture(name, layer)?))?)
    }

    /// Returns the bytes of a resource, and what they are, as JSON: see [`described`].
    fn resource<'py>(&self, py: Python<'py>, name: &str) -> PyResult<(Bound<'py, PyArray1<u8>>, String)> {
        let (bytes, what) = self.with(py, |Inner { renderer, .. }| {
            let id = renderer.find_output(name).or_else(|_| renderer.find(name))?;
            let compiled = renderer.compiled().context("no pipeline is set")?;
            let layout = pass::layout_of(&compiled.steps, id);
            let what = described(&compiled.plan.resources[id.0 as usize], layout.as_ref());
            Ok((renderer.resource_bytes(id)?, what.to_string()))
        })?;
        Ok((PyArray1::from_vec(py, bytes), what))
    }

    /// Keeps a resource for reading back after each frame.
    fn keep(&self, py: Python<'_>, name: &str) -> PyResult<()> {
        self.with(py, |inner| Ok(inner.renderer.keep(name)?))
    }

    /// Writes an output with the record by which `lightloom rerun` renders it again.
    fn save(&self, py: Python<'_>, path: PathBuf, output: &str) -> PyResult<()> {
        self.with(py, |Inner { renderer, scene, first_frame, .. }| {
            let display = renderer.display().map_or_else(Display::default, |(_, display)| display);
            let display = Display::of_output(output, display);
            let record = Provenance::new(renderer, scene, (output, 0), *first_frame);
            let record = record.written_to(&path, display).to_json();
            Ok(renderer.picture(output, 0)?.write(path, display, Some(&record))?)
        })
    }

    /// Returns how the pipeline shows an output on a screen.
    fn shown(&self, py: Python<'_>, output: &str) -> PyResult<Shown> {
        self.with(py, |Inner { renderer, .. }| {
            let own = renderer.display().map_or_else(Display::default, |(_, display)| display);
            Ok(shown(Display::of_output(output, own)))
        })
    }

    /// Returns the value of a parameter or a setting.
    fn value<'py>(&self, py: Python<'py>, path: &str) -> PyResult<Bound<'py, PyAny>> {
        let value = self.with(py, |Inner { renderer, .. }| {
            let compiled = renderer.compiled().context("no pipeline is set")?;
            let all = compiled.resolved.settable(&*catalog());
            if let Some(found) = all.iter().find(|settable| settable.path == path) {
                return Ok(found.value.clone());
            }
            let near = nearest_of_few(path, all.iter().map(|settable| &*settable.path));
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            Err(anyhow!("the pipeline `{}` has no value `{path}`{near}", renderer.pipeline_name()))
        })?;
        to_python(py, &value)
    }

    /// Sets the value of a parameter or a setting.
    fn set_value(&self, py: Python<'_>, path: &str, value: Given) -> PyResult<()> {
        let value = value.value();
        self.with(py, |inner| inner.renderer.set_value(path, value).map(|_| ()).map_err(Into::into))
    }

    /// Returns all parameters and settings with their values: path, value, unit and documentation.
    #[allow(clippy::type_complexity, reason = "the rows of a table")]
    fn values<'py>(&self, py: Python<'py>) -> PyResult<Vec<(String, Bound<'py, PyAny>, String, String)>> {
        let all = self.with(py, |Inner { renderer, .. }| {
            let compiled = renderer.compiled().context("no pipeline is set")?;
            Ok(compiled.resolved.settable(&*catalog()))
        })?;
        let row = |one: frame_graph::Settable| {
            Ok((one.path, to_python(py, &one.value)?, one.setting.unit, one.setting.doc))
        };
        all.into_iter().map(row).collect()
    }

    /// Sets the pipeline, and values for it.
    fn set_pipeline(&self, py: Python<'_>, name: &str, settings: Vec<(String, Given)>) -> PyResult<()> {
        let settings = overrides(settings);
        self.with(py, |inner| {
            inner.renderer.set_pipeline(name, &settings)?;
            inner.begin();
            Ok(())
        })
    }

    /// Replaces the scene.
    fn set_scene(&self, py: Python<'_>, scene: String) -> PyResult<()> {
        self.with(py, |inner| {
            inner.renderer.set_scene(renderer::load_scene(&catalog(), &scene)?)?;
            inner.scene = scene;
            inner.begin();
            Ok(())
        })
    }

    /// Sets the size of frames in pixels.
    fn set_size(&self, py: Python<'_>, size: (u32, u32)) -> PyResult<()> {
        self.with(py, |inner| Ok(inner.renderer.set_size(size)?))
    }

    /// Sets the seed of all random numbers.
    fn set_seed(&self, py: Python<'_>, seed: u32) -> PyResult<()> {
        self.with(py, |inner| {
            inner.renderer.set_seed(seed);
            Ok(())
        })
    }

    /// Sets the number of the next frame.
    fn set_frame_index(&self, py: Python<'_>, index: u32) -> PyResult<()> {
        self.with(py, |inner| {
            inner.renderer.set_frame_index(index);
            inner.next = index;
            inner.begin();
            Ok(())
        })
    }

    /// Sets the time of the next frames \[s\]; `None` lets it follow their numbers.
    fn set_time(&self, py: Python<'_>, time: Option<f32>) -> PyResult<()> {
        self.with(py, |inner| {
            inner.renderer.set_time(time);
            Ok(())
        })
    }

    /// Returns the time of the last frame \[s\].
    fn time(&self, py: Python<'_>) -> PyResult<f32> {
        self.with(py, |inner| Ok(inner.renderer.pose().time))
    }

    /// Returns the camera of the last frame, as JSON.
    fn camera(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |Inner { renderer, .. }| {
            let (origin, mut camera) = (renderer.scene().origin.as_vec3(), renderer.pose().camera);
            camera.position += origin;
            camera.target += origin;
            Ok(serde_json::to_string(&camera)?)
        })
    }

    /// Replaces the scene's own camera, given as JSON; `None` restores it.
    fn set_camera(&self, py: Python<'_>, camera: Option<&str>, cut: bool) -> PyResult<()> {
        self.with(py, |Inner { renderer, .. }| {
            let mut camera: Option<Camera> =
                camera.map(serde_json::from_str).transpose().context("not a camera")?;
            if let Some(camera) = &mut camera {
                check_camera(camera)?;
                let origin = renderer.scene().origin.as_vec3();
                camera.position -= origin;
                camera.target -= origin;
            }
            renderer.set_camera(camera, cut);
            Ok(())
        })
    }

    /// Returns the lights of the last frame, as JSON.
    fn lights(&self, py: Python<'_>) -> PyResult<String> {
        self.with(py, |Inner { renderer, .. }| {
            let origin = renderer.scene().origin.as_vec3();
            let lights = renderer.pose().lights.iter();
            let placed = lights.map(|light| Light { position: light.position + origin, ..light.clone() });
            let lights: Vec<RecordedLight> = placed.map(|light| RecordedLight::from(&light)).collect();
            Ok(serde_json::to_string(&lights)?)
        })
    }

    /// Replaces the scene's own lights, given as JSON; `None` restores them.
    fn set_lights(&self, py: Python<'_>, lights: Option<&str>) -> PyResult<()> {
        self.with(py, |Inner { renderer, .. }| {
            let lights: Option<Vec<RecordedLight>> =
                lights.map(serde_json::from_str).transpose().context("not lights")?;
            let origin = renderer.scene().origin.as_vec3();
            let placed = |light: &RecordedLight| -> Result<Light> {
                let mut light = Light::from(light);
                check_light(&light)?;
                light.position -= origin;
                light.direction = light.direction.normalize_or_zero();
                Ok(light)
            };
            let lights: Option<Vec<Light>> =
                lights.map(|lights| lights.iter().map(placed).collect::<Result<_>>()).transpose()?;
            Ok(renderer.set_lights(lights)?)
        })
    }

    /// Returns the name of each pass that ran in the newest frame whose times are known, and its time on the device \[ms\]; `None`
    /// where the adapter has no timestamps.
    fn timings(&self, py: Python<'_>) -> PyResult<Option<Vec<(String, f64)>>> {
        self.with(py, |Inner { renderer, .. }| {
            renderer.gpu().wait()?;
            let Some(times) = renderer.timings().map(|timings| timings.times.clone()) else {
                return Ok(None);
            };
            let plan = renderer.plan().context("no pipeline is set")?;
            let passes = plan.passes.iter().map(|pass| pass.name.to_string());
            Ok(Some(passes.zip(times).collect()))
        })
    }

    /// Reads files again, where they are those of the pipeline, its shaders or the scene; all of these where none are given. Returns
    /// whether anything was loaded.
    fn reload(&self, py: Python<'_>, files: Option<Vec<PathBuf>>) -> PyResult<bool> {
        self.with(py, |Inner { renderer, .. }| {
            let files = match files {
                Some(files) => files.into_iter().collect(),
                None => all_files(renderer)?,
            };
            match renderer.reload(&files) {
                Reload::Nothing => Ok(false),
                Reload::Done(_) => Ok(true),
                Reload::Failed(error) => Err(error.into()),
            }
        })
    }

    /// Returns the plan that runs, as text, JSON, SVG and DOT, and the warnings as JSON.
    fn plan(&self, py: Python<'_>) -> PyResult<Drawn> {
        self.with(py, |Inner { renderer, .. }| {
            let plan = renderer.plan().context("no pipeline is set")?;
            Ok(drawn(plan, &renderer.warnings()))
        })
    }

    /// Returns how many steps of a result that takes several frames are done, of how many at most, and whether it has converged;
    /// `None` where it is complete after each frame.
    fn progress(&self, py: Python<'_>) -> PyResult<Option<(u32, u32, bool)>> {
        self.with(py, |inner| {
            let progress = inner.renderer.progress()?;
            Ok(progress.map(|progress| (progress.step, progress.steps, progress.is_done())))
        })
    }

    /// Returns the size of frames in pixels.
    fn size(&self, py: Python<'_>) -> PyResult<(u32, u32)> {
        self.with(py, |inner| Ok(inner.renderer.size()))
    }

    /// Returns the names of scene, pipeline and adapter.
    fn names(&self, py: Python<'_>) -> PyResult<(String, String, String)> {
        self.with(py, |Inner { renderer, scene, .. }| {
            Ok((scene.clone(), renderer.pipeline_name().to_owned(), renderer.gpu().describe()))
        })
    }
}

/// The files of the pipeline, its shaders and the scene.
fn all_files(renderer: &renderer::Renderer) -> Result<BTreeSet<PathBuf>> {
    let compiled = renderer.compiled().context("no pipeline is set")?;
    let sources = compiled.resolved.sources().iter().map(|source| source.name.clone());
    let root = catalog().assets().root().map(PathBuf::from).unwrap_or_default();
    let named = sources.chain(compiled.shader_files()).map(|name| root.join(name));
    Ok(named.chain(renderer.scene().files.iter().cloned()).collect())
}

/// Refuses a camera that shows nothing.
fn check_camera(camera: &Camera) -> Result<()> {
    let Camera { position, target, up, vertical_fov, near } = *camera;
    let is_finite = [position, target, up].iter().all(|vector| vector.is_finite());
    ensure!(is_finite, "the camera's position, target and up must be finite numbers");
    ensure!(position != target, "the camera's target must not be its position");
    ensure!(up.length_squared() > 0.0, "the camera's up must not be zero");
    ensure!(
        vertical_fov > 0.0 && vertical_fov < PI,
        "the camera's vertical_fov is {vertical_fov}; it must be above 0 and below π [rad]"
    );
    ensure!(near > 0.0 && near.is_finite(), "the camera's near is {near}; it must be above 0 [m]");
    Ok(())
}

/// Refuses a light that cannot be.
fn check_light(light: &Light) -> Result<()> {
    let Light { name, kind, position, direction, intensity } = light;
    let is_finite = [position, direction, intensity].iter().all(|vector| vector.is_finite());
    ensure!(
        is_finite,
        "the light `{name}` has a position, a direction or an intensity that is no finite number"
    );
    ensure!(
        intensity.min_element() >= 0.0 && intensity.max_element() <= BRIGHTEST,
        "the intensity of the light `{name}` must be from 0 to {BRIGHTEST:e} in each channel"
    );
    ensure!(
        *kind == LightKind::Point || direction.length_squared() > 0.0,
        "the direction of the light `{name}` must not be zero"
    );
    if let LightKind::Spot { inner, outer } = *kind {
        ensure!(
            (0.0..=outer).contains(&inner) && outer > 0.0 && outer <= PI / 2.0,
            "the cone of the light `{name}` must have 0 ≤ inner ≤ outer ≤ π/2 and outer > 0 [rad]"
        );
    }
    Ok(())
}
