//! A device that is gone: the session begins again on another, where it was.

use super::Session;
use crate::engine::model::{Command, SideId};
use crate::engine::{Publisher, Start};
use std::time::Duration;

/// A session whose device is lost sooner than this after it was opened does not begin again: it would be lost without end.
const WORTH: Duration = Duration::from_secs(10);

/// A session that has ended, and how to go on with it.
pub(in crate::engine) struct Lost {
    /// The state in which the next session begins.
    pub(in crate::engine) start: Start,
    /// The commands that it carries out first.
    pub(in crate::engine) commands: Vec<Command>,
}

impl Session {
    /// Returns whether the device is gone, as far as is known without a wait.
    pub(super) fn is_lost(&self) -> bool {
        self.gpu().check().is_err()
    }

    /// Ends a session whose device is gone. Returns `None`, and reports it, where the session was opened just now.
    pub(super) fn lose(self, publisher: &Publisher) -> Option<Lost> {
        if self.opened.elapsed() < WORTH {
            let text = "the graphics device was lost again at once: Lightloom must be started again";
            crate::terminal::complain(format_args!("error: {text}"));
            publisher.with(|published| published.fatal = Some(text.to_owned()));
            return None;
        }
        super::report(publisher, "the graphics device was lost: it is opened again", true);
        publisher.with(|published| published.troubles.clear());
        Some(self.resumed())
    }

    /// Returns the start and the commands that make a new session the same as this one.
    pub(super) fn resumed(mut self) -> Lost {
        let mut pipelines: Vec<_> = self
            .sides
            .iter_mut()
            .map(|(id, side)| {
                let loaded = (side.renderer.pipeline_name().to_owned(), side.overrides());
                (*id, side.wanted.take().unwrap_or(loaded))
            })
            .collect();
        let first = pipelines.iter().position(|(id, _)| *id == SideId::A).map(|at| pipelines.remove(at).1);
        let (pipeline, overrides) = first.unwrap_or_default();
        let mut commands = vec![
            Command::Timing(self.timed),
            Command::RunEverything(self.runs_everything),
            Command::Camera(self.camera, true),
            Command::Lights(self.lights),
            Command::Time(self.time),
        ];
        let others = pipelines.into_iter();
        commands.extend(others.map(|(id, (name, overrides))| Command::Pipeline(id, name, overrides)));
        commands.extend([
            Command::Look(self.look),
            Command::VirtualLights(self.wants_lights),
            Command::Measure(self.measuring.measures()),
            Command::Play(self.playing),
        ]);
        let scene = self.wanted_scene.unwrap_or_else(|| self.scene.scene().spec.clone());
        let start =
            Start { catalog: self.catalog, pipeline, scene, overrides, size: self.size, seed: self.seed };
        Lost { start, commands }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::engine::model::Published;
    use frame_graph::{Overrides, Value};
    use renderer::{Assets, Catalog, Gpu};
    use std::path::Path;
    use std::sync::atomic::AtomicBool;
    use std::sync::mpsc::channel;
    use std::sync::{Arc, Mutex};

    fn few() -> Overrides {
        let values = [("lights", 16), ("map", 16), ("rsm.size", 32)];
        Overrides(values.map(|(path, value)| (path.to_owned(), Value::U32(value))).to_vec())
    }

    #[test]
    fn a_lost_device_is_opened_again_and_all_is_as_before() {
        if Gpu::adapters().is_empty() {
            eprintln!("skipped: no graphics adapter");
            return;
        }
        let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
        let start = Start {
            catalog: Arc::new(Catalog::new(Assets::new(Some(root)))),
            pipeline: "ism-invtm".to_owned(),
            scene: "cornell-box-moving".to_owned(),
            overrides: few(),
            size: (32, 24),
            seed: 3,
        };
        let published = Arc::new(Mutex::new(Published::default()));
        let publisher = Publisher { published: Arc::clone(&published), repaint: Box::new(|| {}) };
        let mut session = Session::open(start, &publisher).unwrap();
        let camera = session.scene.scene().camera;
        let never = AtomicBool::new(false);
        for command in [
            Command::Pipeline(SideId::B, "ism-uniform".to_owned(), few()),
            Command::Value(SideId::B, "lights".to_owned(), Value::U32(8)),
            Command::Camera(Some(crate::camera::orbit(&camera, 0.2, 0.0)), false),
            Command::Time(0.5),
        ] {
            let _ = session.execute(command, &never, &publisher);
        }
        // As if it had run for a while.
        session.opened -= WORTH;
        session.gpu().device.destroy();
        let (send, commands) = channel();
        let lost = session.run(Vec::new(), &commands, (&never, &never), &publisher).expect("it is lost");
        assert_eq!(
            (lost.start.pipeline.as_str(), lost.start.scene.as_str()),
            ("ism-invtm", "cornell-box-moving")
        );

        // Until there is a picture of each.
        let now = Arc::clone(&published);
        let repaint = move || {
            let side =
                |published: &Published, id| published.side(id).is_some_and(|side| side.picture.is_some());
            let published = now.lock().unwrap();
            if side(&published, SideId::A) && side(&published, SideId::B) {
                let _ = send.send(Command::Quit);
            }
        };
        published.lock().unwrap().sides.clear();
        let publisher = Publisher { published: Arc::clone(&published), repaint: Box::new(repaint) };
        let session = Session::open(lost.start, &publisher).unwrap();
        assert!(session.run(lost.commands, &commands, (&never, &never), &publisher).is_none());
        let published = published.lock().unwrap();
        assert_eq!(published.troubles.len(), 0, "{:?}", published.troubles);
        let side = published.side(SideId::B).expect("both sides are there");
        assert_eq!(side.name, "ism-uniform");
        let lights = side.settable.iter().find(|settable| settable.path == "lights").unwrap();
        assert_eq!(lights.value, Value::U32(8));
        assert_ne!(published.camera, Some(camera));
        assert_eq!(published.time, 0.5);
    }
}
