//! The user's camera and lights, which replace the scene's own.

use crate::camera::between;
use crate::engine::{Command, Engine};
use glam::Vec3;
use scene::{Camera, Light};
use std::time::{Duration, Instant};

/// The duration of a jump to a point.
const FLIGHT: Duration = Duration::from_millis(350);

/// Who flies.
#[derive(Debug, Default)]
pub(crate) struct Pilot {
    camera: Option<Camera>,
    flight: Option<(Instant, Camera, Camera)>,
    /// The time that the user asked for and the engine does not show yet \[s\].
    pub(crate) time: Option<f32>,
    /// The lights as the user moved them.
    pub(crate) lights: Option<Vec<Light>>,
}

impl Pilot {
    /// Returns the user's camera; `None` where the scene's own is shown.
    pub(crate) fn camera(&self) -> Option<Camera> {
        self.camera
    }

    /// Shows the scene from here.
    pub(crate) fn take(&mut self, engine: &Engine, camera: Camera, cut: bool) {
        self.flight = None;
        if self.camera != Some(camera) {
            self.camera = Some(camera);
            engine.send(Command::Camera(Some(camera), cut));
        }
    }

    /// Flies to a camera.
    pub(crate) fn fly_to(&mut self, from: Camera, to: Camera) {
        self.flight = Some((Instant::now(), from, to));
    }

    /// Goes on with a flight; returns whether there is one.
    pub(crate) fn go_on(&mut self, engine: &Engine) -> bool {
        let Some((begun, from, to)) = self.flight else { return false };
        let share = begun.elapsed().as_secs_f32() / FLIGHT.as_secs_f32();
        self.take(engine, between(&from, &to, share.min(1.0)), false);
        if share < 1.0 {
            self.flight = Some((begun, from, to));
        }
        share < 1.0
    }

    /// Gives the camera back to the scene.
    pub(crate) fn release(&mut self, engine: &Engine) {
        (self.camera, self.flight) = (None, None);
        engine.send(Command::Camera(None, true));
    }

    /// Gives the lights back to the scene.
    pub(crate) fn release_lights(&mut self, engine: &Engine) {
        self.lights = None;
        engine.send(Command::Lights(None));
    }

    /// Moves camera and lights, where the user has any, by as much.
    pub(crate) fn shift(&mut self, engine: &Engine, by: Vec3) {
        if let Some(mut camera) = self.camera {
            (camera.position, camera.target) = (camera.position + by, camera.target + by);
            self.take(engine, camera, false);
        }
        if let Some(mut lights) = self.lights.take() {
            lights.iter_mut().for_each(|light| light.position += by);
            self.set_lights(engine, lights);
        }
    }

    /// Moves the lights.
    pub(crate) fn set_lights(&mut self, engine: &Engine, lights: Vec<Light>) {
        engine.send(Command::Lights(Some(lights.clone())));
        self.lights = Some(lights);
    }
}
