//! The session: one scene on the device, and the pipelines that render it.

mod frames;
mod lost;
mod reload;
mod report;

use super::jobs;
use super::measure::Measuring;
use super::model::{Command, Look, SceneView, SideId};
use super::side::Side;
use super::watch::Files;
use super::{Publisher, Start};
use frame_graph::{LinkContext, Overrides};
use interfaces::virtual_lights::VirtualLight;
use renderer::wgpu;
use renderer::{Catalog, Compiled, Gpu, RenderError, Renderer, SharedScene, compile_options, load_scene};
use report::report;
use scene::{Camera, Light};
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError};
use std::time::{Duration, Instant};

pub(super) use lost::Lost;

/// The time after which a session that has nothing to do asks about files.
const IDLE: Duration = Duration::from_millis(5);

/// Frames follow each other no faster than screens show them.
const FRAME: Duration = Duration::from_micros(16_000);

/// The time without movement after which the reference goes on.
const STILL: Duration = Duration::from_millis(250);

/// A file that is older was not written just now, but moved to its place.
const RECENT: Duration = Duration::from_secs(10);

/// The scene of a session until there is one.
const NOTHING: &str = "empty";

/// The time for which the message about a refused value stays visible.
const REFUSED: Duration = Duration::from_secs(8);

pub(super) struct Session {
    opened: Instant,
    catalog: Arc<Catalog>,
    scene: SharedScene,
    /// The scene that was asked for, where it could not be loaded: whenever a file changes it is tried again.
    wanted_scene: Option<String>,
    /// Whether there has been no scene yet that could be loaded: pipelines wait for one.
    waits_for_scene: bool,
    sides: Vec<(SideId, Side)>,
    files: Files,
    size: (u32, u32),
    seed: u32,
    camera: Option<Camera>,
    lights: Option<Vec<Light>>,
    time: f32,
    playing: bool,
    ticked: Instant,
    moved: Instant,
    look: Option<Look>,
    wants_lights: bool,
    lights_before: Vec<VirtualLight>,
    timed: bool,
    runs_everything: bool,
    measuring: Measuring,
    /// The times of the frames of A within the last second; the last two in any case.
    made: Vec<Instant>,
    /// The next frame is not before.
    due: Instant,
}

/// Decides whether the loop goes on.
enum Next {
    GoOn,
    Quit,
}

impl Session {
    /// Opens the adapter, loads the scene and the pipeline.
    ///
    /// # Errors
    /// There is no adapter. An invalid scene or pipeline is reported, and waited for.
    pub(super) fn open(start: Start, publisher: &Publisher) -> Result<Session, RenderError> {
        publisher.stage(Some(format!("Opening the adapter and loading {}", start.scene)));
        let Start { catalog, pipeline, scene, overrides, size, seed } = start;
        let files = Files::new();
        let (gpu, loaded) = std::thread::scope(|scope| {
            let gpu = scope.spawn(Gpu::open);
            let loaded = load_scene(&catalog, &scene);
            if let Ok(loaded) = &loaded {
                let context = LinkContext { frame: size, traits: loaded.traits() };
                // The catalog keeps the shaders; errors are reported when the pipeline is set.
                let _ = Compiled::new(&catalog, &pipeline, &overrides, &context, &compile_options());
            }
            (gpu.join(), loaded)
        });
        let gpu = gpu.unwrap_or_else(|panic| std::panic::resume_unwind(panic))?;
        let loaded = loaded.map_err(RenderError::from).and_then(|loaded| SharedScene::new(&gpu, loaded));
        let (shared, wrong) = match loaded {
            Ok(shared) => (shared, None),
            Err(error) => (SharedScene::new(&gpu, load_scene(&catalog, NOTHING)?)?, Some(error)),
        };
        let now = Instant::now();
        let mut session = Session {
            opened: now,
            catalog,
            scene: shared,
            waits_for_scene: wrong.is_some(),
            wanted_scene: wrong.is_some().then_some(scene),
            sides: Vec::new(),
            files,
            size,
            seed,
            camera: None,
            lights: None,
            time: 0.0,
            playing: false,
            ticked: now,
            moved: now,
            look: None,
            wants_lights: false,
            lights_before: Vec::new(),
            timed: true,
            runs_everything: false,
            measuring: Measuring::start(),
            made: Vec::new(),
            due: now,
        };
        publisher.with(|published| {
            published.adapter = gpu.describe();
            published.on_cpu = gpu.info.device_type == wgpu::DeviceType::Cpu;
        });
        match wrong {
            None => {
                session.publish_scene(publisher);
                session.set_pipeline(SideId::A, &pipeline, &overrides, publisher);
            }
            Some(error) => {
                session.add_side(SideId::A).wanted = Some((pipeline, overrides));
                session.trouble("scene", &error, publisher);
                session.watch(publisher);
            }
        }
        publisher.stage(None);
        Ok(session)
    }

    /// Renders until the interface ends, or the device is gone: then it returns how to go on with another. `batch` is carried
    /// out first.
    ///
    /// `waits` is set while a command waits: sides that only compare give way to it. `quits` is set once the window is
    /// closed: what writes many frames ends then.
    pub(super) fn run(
        mut self,
        mut batch: Vec<Command>,
        commands: &Receiver<Command>,
        (waits, quits): (&AtomicBool, &AtomicBool),
        publisher: &Publisher,
    ) -> Option<Lost> {
        loop {
            let idle = !self.busy() && batch.is_empty();
            let wait = if idle { IDLE } else { self.due.saturating_duration_since(Instant::now()) };
            let first = match commands.recv_timeout(wait) {
                Ok(command) => Some(command),
                Err(RecvTimeoutError::Timeout) => None,
                Err(RecvTimeoutError::Disconnected) => return None,
            };
            waits.store(false, Ordering::Release);
            let resumed = batch.len();
            batch.extend(first.into_iter().chain(commands.try_iter()));
            let received = (batch.len() - resumed) as u64;
            while !batch.is_empty() {
                let command = batch.remove(0);
                if batch.iter().any(|later| later.supersedes(&command)) {
                    continue;
                }
                if let Next::Quit = self.execute(command, quits, publisher) {
                    return None;
                }
            }
            if received > 0 {
                let settings = self.settings();
                publisher.with(|published| {
                    published.executed += received;
                    published.settings = settings;
                });
            }
            if let Some(saved) = self.files.saved() {
                self.reload(&saved, waits, publisher);
            }
            self.tick();
            if Instant::now() >= self.due {
                self.frames(publisher, None, waits);
            }
            if self.is_lost() {
                return self.lose(publisher);
            }
        }
    }

    fn busy(&self) -> bool {
        self.playing || self.measuring.waits() || self.sides.iter().any(|(_, side)| side.wants_a_frame())
    }

    /// Returns the pipelines and their values, also of those that could not be loaded.
    fn settings(&self) -> Vec<(SideId, String, Overrides)> {
        let of_side = |(id, side): &(SideId, Side)| {
            let loaded = || (side.renderer.pipeline_name().to_owned(), side.overrides());
            let (name, overrides) = side.wanted.clone().unwrap_or_else(loaded);
            (*id, name, overrides)
        };
        self.sides.iter().map(of_side).collect()
    }

    fn side(&mut self, id: SideId) -> Option<&mut Side> {
        self.sides.iter_mut().find(|(known, _)| *known == id).map(|(_, side)| side)
    }

    fn each(&mut self, mut f: impl FnMut(&mut Renderer)) {
        self.sides.iter_mut().for_each(|(_, side)| f(&mut side.renderer));
    }

    /// Something moved or changed that all sides see.
    fn move_on(&mut self) {
        self.moved = Instant::now();
        self.sides.iter_mut().for_each(|(_, side)| side.wake());
    }

    fn execute(&mut self, command: Command, quits: &AtomicBool, publisher: &Publisher) -> Next {
        match command {
            Command::Quit => return Next::Quit,
            Command::Pipeline(side, name, overrides) => self.set_pipeline(side, &name, &overrides, publisher),
            Command::Close(side) => {
                self.sides.retain(|(id, _)| *id != side || *id == SideId::A);
                self.clear(side.name(), publisher);
                publisher.with(|published| published.sides.retain(|(id, _)| *id != side));
            }
            Command::Scene(spec) => self.set_scene(&spec, publisher),
            Command::Value(side, path, value) => self.set_values(side, publisher, |overrides| {
                overrides.0.retain(|(known, _)| *known != path);
                overrides.0.push((path, value));
            }),
            Command::Reset(side, path) => {
                self.set_values(side, publisher, |overrides| overrides.0.retain(|(known, _)| *known != path));
            }
            Command::Camera(camera, cut) => {
                self.camera = camera;
                self.each(|renderer| renderer.set_camera(camera, cut));
                self.move_on();
            }
            Command::Lights(lights) => {
                self.lights.clone_from(&lights);
                for (_, side) in &mut self.sides {
                    if let Err(error) = side.renderer.set_lights(lights.clone()) {
                        report(publisher, &error.to_string(), true);
                    }
                    side.loaded(&self.catalog);
                }
                self.move_on();
            }
            Command::Play(playing) => {
                (self.playing, self.ticked) = (playing, Instant::now());
                self.move_on();
            }
            Command::Time(time) => {
                self.time = time.max(0.0);
                self.move_on();
            }
            Command::Size(size) => self.set_size(size, publisher),
            Command::Look(look) => {
                self.look = look;
                self.keep(publisher);
                self.move_on();
            }
            Command::VirtualLights(wanted) => {
                self.wants_lights = wanted;
                self.keep(publisher);
                self.move_on();
            }
            Command::Measure(measures) => self.measuring.set(measures),
            Command::Timing(timed) => {
                self.timed = timed;
                self.sides.iter_mut().for_each(|(_, side)| side.time(timed));
            }
            Command::RunEverything(all) => {
                self.runs_everything = all;
                for (id, side) in &mut self.sides {
                    side.run_everything(all && *id != SideId::Reference);
                }
            }
            Command::ForgetTimes => self.sides.iter_mut().for_each(|(_, side)| side.forget_times()),
            Command::Job(job) => self.run_job(&job, quits, publisher),
        }
        Next::GoOn
    }

    /// Returns a side, which is made where there is none.
    fn add_side(&mut self, id: SideId) -> &mut Side {
        let at = match self.sides.iter().position(|(known, _)| *known == id) {
            Some(at) => at,
            None => {
                let mut renderer = Renderer::with_scene(Arc::clone(&self.catalog), &self.scene, self.size);
                renderer.set_seed(self.seed);
                renderer.set_camera(self.camera, false);
                renderer.set_time(Some(self.time));
                if let Some(lights) = &self.lights {
                    // Nothing is linked yet that could refuse them.
                    let _ = renderer.set_lights(Some(lights.clone()));
                }
                let mut side = Side::new(renderer);
                side.time(self.timed);
                side.run_everything(self.runs_everything && id != SideId::Reference);
                let at = self.sides.partition_point(|(known, _)| *known < id);
                self.sides.insert(at, (id, side));
                at
            }
        };
        &mut self.sides[at].1
    }

    /// Loads the pipelines that could not be loaded.
    fn try_wanted(&mut self, publisher: &Publisher) {
        let wanted: Vec<_> =
            self.sides.iter_mut().filter_map(|(id, side)| Some((*id, side.wanted.take()?))).collect();
        for (id, (name, overrides)) in wanted {
            self.set_pipeline(id, &name, &overrides, publisher);
        }
    }

    fn set_pipeline(&mut self, id: SideId, name: &str, overrides: &Overrides, publisher: &Publisher) {
        publisher.stage(Some(format!("Loading {name}")));
        if self.waits_for_scene {
            // It is loaded as soon as there is a scene.
            self.add_side(id).wanted = Some((name.to_owned(), overrides.clone()));
            publisher.stage(None);
            return;
        }
        self.add_side(id);
        let catalog = Arc::clone(&self.catalog);
        let Some(side) = self.side(id) else { return };
        let before = side.renderer.keep_only([]);
        match before.and_then(|()| side.renderer.set_pipeline(name, overrides)) {
            Ok(load) => {
                side.begin();
                side.wanted = None;
                side.loaded(&catalog);
                let passes = side.renderer.plan().map_or(0, |plan| plan.passes.len());
                let line = format!(
                    "{}: {name} loaded: {passes} passes; {} GPU pipelines compiled",
                    id.name(),
                    load.pipelines
                );
                self.clear(id.name(), publisher);
                report(publisher, &line, false);
                // Its settings and its graph are there before its first picture, which may take long.
                publisher.with(|published| self.publish_side(published, id));
            }
            Err(error) => {
                side.wanted = Some((name.to_owned(), overrides.clone()));
                self.trouble(id.name(), &error, publisher);
            }
        }
        self.keep(publisher);
        self.watch(publisher);
        self.move_on();
        publisher.stage(None);
    }

    fn set_values(&mut self, id: SideId, publisher: &Publisher, change: impl FnOnce(&mut Overrides)) {
        let catalog = Arc::clone(&self.catalog);
        let Some(side) = self.side(id) else { return };
        let mut overrides = side.overrides();
        change(&mut overrides);
        match side.renderer.set_values(overrides) {
            Ok(load) => {
                let structure = !load.kept;
                let line = format!("{}: {}", id.name(), side.describe(&load));
                side.loaded(&catalog);
                self.clear(id.name(), publisher);
                if structure {
                    report(publisher, &line, false);
                }
            }
            Err(error) => {
                // The value before stays: there is nothing to mend.
                let until = Instant::now() + REFUSED;
                self.trouble_until(id.name(), &error, Some(until), publisher);
            }
        }
        self.moved = Instant::now();
    }

    fn set_scene(&mut self, spec: &str, publisher: &Publisher) {
        publisher.stage(Some(format!("Loading {spec}")));
        let loaded = load_scene(&self.catalog, spec).map_err(RenderError::from);
        let gpu = self.gpu();
        match loaded.and_then(|scene| SharedScene::new(&gpu, scene)) {
            Ok(scene) => {
                (self.camera, self.lights, self.time) = (None, None, 0.0);
                for (id, side) in &mut self.sides {
                    side.renderer.set_camera(None, true);
                    // With the new scene all is linked again, and errors are reported there.
                    let _ = side.renderer.set_lights(None);
                    match side.renderer.set_shared_scene(&scene) {
                        Ok(_) => side.loaded(&self.catalog),
                        Err(error) => report(publisher, &format!("{}: {error}", id.name()), true),
                    }
                }
                (self.scene, self.wanted_scene, self.waits_for_scene) = (scene, None, false);
                self.clear("scene", publisher);
                self.publish_scene(publisher);
                self.try_wanted(publisher);
            }
            Err(error) => {
                self.wanted_scene = Some(spec.to_owned());
                self.trouble("scene", &error, publisher);
            }
        }
        self.watch(publisher);
        self.move_on();
        publisher.stage(None);
    }

    fn set_size(&mut self, size: (u32, u32), publisher: &Publisher) {
        self.size = size;
        for (id, side) in &mut self.sides {
            if let Err(error) = side.renderer.set_size(size) {
                report(publisher, &format!("{}: {error}", id.name()), true);
            }
            side.loaded(&self.catalog);
            side.forget_times();
        }
        self.move_on();
    }

    /// Keeps what is looked at, in the side that it is of.
    fn keep(&mut self, publisher: &Publisher) {
        let (look, wants_lights) = (self.look.clone(), self.wants_lights);
        let mut wrong = None;
        for (id, side) in &mut self.sides {
            let looked = look.iter().filter(|look| look.side == *id).map(|look| look.name.clone());
            let mut names: Vec<String> = looked.collect();
            if wants_lights && *id == SideId::A {
                names.extend(side.virtual_lights_name());
            }
            if let Err(error) = side.renderer.keep_only(names.iter().map(String::as_str)) {
                wrong = Some(error.to_string());
            }
            side.loaded(&self.catalog);
        }
        publisher.with(|published| published.look_error = wrong);
    }

    /// Lets the time of animations run on.
    fn tick(&mut self) {
        let now = Instant::now();
        if self.playing {
            self.time += now.duration_since(self.ticked).as_secs_f32();
            let duration = self.scene.scene().duration;
            if duration > 0.0 && self.time > duration {
                self.time %= duration;
            }
            self.move_on();
        }
        self.ticked = now;
        let time = self.time;
        self.each(|renderer| renderer.set_time(Some(time)));
    }

    fn run_job(&mut self, job: &jobs::Job, quits: &AtomicBool, publisher: &Publisher) {
        publisher.stage(Some(job.describe()));
        let Some((_, side)) = self.sides.iter_mut().find(|(id, _)| *id == job.side()) else { return };
        let done = jobs::run(job, side, quits, |stage| publisher.stage(Some(stage)));
        // A picture may have been written in another size.
        let back = side.renderer.set_size(self.size);
        side.loaded(&self.catalog);
        if let Err(error) = back {
            report(publisher, &error.to_string(), true);
        }
        match done {
            Ok(line) => report(publisher, &line, false),
            Err(error) => report(publisher, &format!("{error:#}"), true),
        }
        let time = self.time;
        self.each(|renderer| renderer.set_time(Some(time)));
        self.keep(publisher);
        self.move_on();
        publisher.stage(None);
    }

    fn publish_scene(&self, publisher: &Publisher) {
        let scene = self.scene.scene();
        for repair in &scene.repairs {
            report(publisher, &format!("note: {repair}"), false);
        }
        let file = scene.files.iter().find(|file| file.extension().is_some_and(|ending| ending == "ron"));
        let view = SceneView { scene: Arc::clone(scene), file: file.cloned() };
        publisher.with(|published| published.scene = Some(view));
    }

    fn gpu(&self) -> Gpu {
        self.scene.gpu().clone()
    }
}
