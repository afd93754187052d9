//! Cells that external programs render: they get a scene, a camera and a time, and write EXR files.

use super::apart::Apart;
use super::laboratory::{GpuLaboratory, pinhole};
use crate::context::Context;
use anyhow::{Result, bail};
use metrics::{Display, Image, read_attributes};
use scene::{Pose, Scene};
use serde_json::{Value, json};
use std::fmt::Write as _;
use std::ops::Range;
use std::path::{Path, PathBuf};
use std::sync::Once;
use study::{
    CellRun, External, ExternalRun, Failure, Laboratory, Observed, Occluded, Plan, RunRequest, Step,
};
use xxhash_rust::xxh3::xxh3_128;

/// Renders pipelines on the GPU, and runs external programs.
pub(crate) struct WithExternals {
    own: GpuLaboratory,
    /// The folder of the study, in which commands run.
    folder: PathBuf,
    /// Runs cells in processes of their own; `None` where they run in this one.
    apart: Option<Apart>,
}

impl WithExternals {
    /// Takes the laboratory of pipelines, and the name of the study's file.
    pub(crate) fn new(own: GpuLaboratory, context: &Context, file: &str) -> WithExternals {
        WithExternals { own, folder: folder_of(context, file), apart: None }
    }

    /// Runs cells in processes of their own.
    pub(super) fn apart(self, apart: Option<Apart>) -> WithExternals {
        WithExternals { apart, ..self }
    }

    fn run_external(
        &mut self,
        request: &RunRequest,
        external: &External,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
    ) -> Result<CellRun, Failure> {
        end_with_this_program();
        let scene = self.own.scene(&request.scene)?;
        let measured = request.first_frame + request.warm_up;
        let measured = measured..measured + request.frames;
        let exchange = Exchange::new(scene, request, external)?;
        let mut calls = Vec::new();
        if external.takes("frames") {
            // A program that writes a sequence may use what it knows from the frames before.
            calls.push(exchange.call(&self.folder, request.first_frame..measured.end)?);
        } else {
            for frame in measured.clone() {
                calls.push(exchange.call(&self.folder, frame..frame + 1)?);
            }
        }
        let times = calls.iter().flat_map(|call| &call.ms);
        let offset = if external.takes("frames") { request.warm_up as usize } else { 0 };
        let mut attributes = json!({});
        for (frame, ms) in measured.zip(times.skip(offset)) {
            let call = calls.iter().find(|call| call.frames.contains(&frame)).unwrap_or(&calls[0]);
            let path = exchange.path("out", frame, "exr");
            let image = exchange.picture(&path, call)?;
            attributes = read_attributes(&path).map(|found| json!(found)).unwrap_or_default();
            let pose = scene.at(scene.frame_time(frame));
            observe(Observed {
                passes: vec![(call.clock().to_owned(), *ms)],
                camera: pinhole(&pose.camera, request.size),
                ..Observed::picture(frame, image)
            })?;
        }
        let last = &calls[calls.len() - 1];
        let provenance = json!({
            "external": external.command,
            "exit status": 0,
            "time": last.clock(),
            "last lines": last.run.log,
            "file says": attributes,
            "scene": { "name": request.scene, "hash": format!("{:032x}", scene.hash) },
            "output": request.output,
            "size": request.size,
            "seed": request.seed,
            "version": env!("CARGO_PKG_VERSION"),
        });
        Ok(CellRun { provenance: provenance.to_string(), ..CellRun::default() })
    }
}

/// Returns the folder on disk of a study, from which its commands run. A built-in study has none, and names no program.
fn folder_of(context: &Context, name: &str) -> PathBuf {
    let root = context.catalog.assets().root().map(|root| root.join(name));
    let file = root.filter(|file| file.is_file()).unwrap_or_else(|| PathBuf::from(name));
    let folder = file.parent().filter(|folder| !folder.as_os_str().is_empty());
    std::path::absolute(folder.unwrap_or(Path::new("."))).unwrap_or_default()
}

/// Checks that the user lets a study run the programs that it names.
pub(super) fn consent(plan: &Plan, is_allowed: bool) -> Result<()> {
    match plan.externals().first() {
        Some(external) if !is_allowed => bail!(
            "the study runs a program, which may do anything that you may do: `{}`; `--allow-external` allows it",
            external.command
        ),
        _ => Ok(()),
    }
}

/// Kills the program that runs when this one is interrupted: it is in a group of its own, which the terminal does not
/// interrupt.
pub(super) fn end_with_this_program() {
    static ONCE: Once = Once::new();
    ONCE.call_once(|| {
        // Without a handler the program goes on until its time is over.
        let _ = ctrlc::set_handler(|| {
            study::kill_running();
            std::process::exit(130);
        });
    });
}

impl Laboratory for WithExternals {
    fn adapter(&self) -> String {
        self.own.adapter()
    }

    fn identity(&mut self, request: &RunRequest) -> Result<u128, Failure> {
        let Some(external) = &request.external else { return self.own.identity(request) };
        let scene = self.own.scene(&request.scene)?.hash;
        let mut text = format!("{scene:032x}");
        for file in external.files(&self.folder) {
            let _ = write!(text, " {:032x}", xxh3_128(&file));
        }
        Ok(xxh3_128(text.as_bytes()))
    }

    fn run(
        &mut self,
        request: &RunRequest,
        observe: &mut dyn FnMut(Observed) -> Result<(), Failure>,
        step: &mut dyn FnMut(Step),
    ) -> Result<CellRun, Failure> {
        match &request.external {
            Some(external) => self.run_external(request, external, observe),
            None => self.own.run(request, observe, step),
        }
    }

    fn apart(&mut self, cell: usize) -> Option<Result<(), Failure>> {
        self.apart.as_ref().map(|apart| apart.run(cell))
    }

    fn occluded(&mut self, scene: &str, frame: u32) -> Result<Occluded, Failure> {
        self.own.occluded(scene, frame)
    }
}

/// The files that are exchanged with a program: `scene-0004.glb`, `camera-0004.json` and `out-0004.exr` are those of frame 4.
struct Exchange<'a> {
    folder: tempfile::TempDir,
    scene: &'a Scene,
    request: &'a RunRequest,
    external: &'a External,
}

/// A finished call of a program.
struct Call {
    frames: Range<u32>,
    run: ExternalRun,
    /// The time of each frame.
    ms: Vec<f64>,
}

impl Call {
    /// Returns what measured the time.
    fn clock(&self) -> &'static str {
        if self.run.stated_ms.is_empty() { "wall time" } else { "stated time" }
    }
}

impl<'a> Exchange<'a> {
    fn new(
        scene: &'a Scene,
        request: &'a RunRequest,
        external: &'a External,
    ) -> Result<Exchange<'a>, Failure> {
        let folder = tempfile::Builder::new().prefix("lightloom-").tempdir().map_err(Failure::render)?;
        Ok(Exchange { folder, scene, request, external })
    }

    fn path(&self, name: &str, frame: u32, ending: &str) -> PathBuf {
        self.folder.path().join(format!("{name}-{frame:04}.{ending}"))
    }

    /// Runs the program for some frames.
    fn call(&self, folder: &Path, frames: Range<u32>) -> Result<Call, Failure> {
        let (request, first) = (self.request, frames.start);
        for frame in frames.clone() {
            let pose = self.scene.at(self.scene.frame_time(frame));
            // Where nothing has changed, the files of the frame before hold.
            let changes = self.scene.changes(self.scene.frame_time(frame.saturating_sub(1)), pose.time);
            let is_first = frame == first;
            if self.external.takes("scene") && (is_first || changes.lights || changes.geometry) {
                let path = self.path("scene", frame, "glb");
                std::fs::write(path, self.scene.to_glb(&pose)).map_err(Failure::render)?;
            }
            if self.external.takes("camera") && (is_first || changes.camera) {
                let text = self.camera(&pose)?.to_string();
                std::fs::write(self.path("camera", frame, "json"), text).map_err(Failure::render)?;
            }
        }
        let run = self.external.run(folder, &mut |name| {
            Some(match name {
                "scene" => self.path("scene", first, "glb").display().to_string(),
                "camera" => self.path("camera", first, "json").display().to_string(),
                "out" => self.path("out", first, "exr").display().to_string(),
                "width" => request.size.0.to_string(),
                "height" => request.size.1.to_string(),
                "output" => request.output.clone(),
                "seed" => request.seed.to_string(),
                "frame" => first.to_string(),
                "frames" => frames.len().to_string(),
                "time" => self.scene.frame_time(first).to_string(),
                "seconds" => (request.stop_after_ms? / 1e3).to_string(),
                _ => return None,
            })
        })?;
        let count = frames.len();
        let ms = match run.stated_ms[..] {
            [] => vec![run.wall_ms / count as f64; count],
            [ms] => vec![ms; count],
            _ if run.stated_ms.len() == count => run.stated_ms.clone(),
            _ => {
                let found = run.stated_ms.len();
                let message =
                    format!("the command states {found} times for {count} frames; expected one for each");
                return Err(Failure::render(message));
            }
        };
        Ok(Call { frames, run, ms })
    }

    /// Returns the camera of a pose, and the environment, for which glTF has no standard: a map by longitude and latitude.
    fn camera(&self, pose: &Pose) -> Result<Value, Failure> {
        let mut camera = serde_json::to_value(pose.camera).map_err(Failure::render)?;
        (camera["width"], camera["height"]) = (json!(self.request.size.0), json!(self.request.size.1));
        if let Some(environment) = &self.scene.environment {
            let path = self.folder.path().join("environment.exr");
            let texels = environment.texels.iter().map(|[r, g, b]| [*r, *g, *b, 1.0]).collect();
            let map = Image::new(environment.width as usize, environment.height as usize, texels)?;
            map.write(&path, Display::AS_IS, None)?;
            camera["environment"] = json!({ "file": path, "rotation": environment.rotation });
        }
        Ok(camera)
    }

    /// Reads the picture that the program has written.
    fn picture(&self, path: &Path, call: &Call) -> Result<Image, Failure> {
        if !path.is_file() {
            let message = format!("the command ended without `{}`, which it was to write", file_name(path));
            let log = &call.run.log;
            return Err(Failure::render(if log.is_empty() { message } else { format!("{message}\n{log}") }));
        }
        let image = Image::read(path)?;
        let (width, height) = self.request.size;
        if (image.width(), image.height()) != (width as usize, height as usize) {
            let found = format!("{}x{}", image.width(), image.height());
            let message = format!("the command wrote a picture of {found} pixels; expected {width}x{height}");
            return Err(Failure::render(message));
        }
        Ok(image)
    }
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().to_string_lossy().into_owned()
}
