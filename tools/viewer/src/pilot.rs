//! The user's camera and lights, which replace the scene's own.

use crate::camera::between;
use crate::engine::{Command, Engine};
use eframe::egui::{Event, InputState, Key};
use glam::Vec3;
use scene::{Camera, Light};
use std::time::{Duration, Instant};

/// The duration of a jump to a point.
const FLIGHT: Duration = Duration::from_millis(350);

/// The keys that fly: right and left, up and down, forward and back.
const AXES: [(Key, Key); 3] = [(Key::D, Key::A), (Key::E, Key::Q), (Key::W, Key::S)];

/// Who flies.
#[derive(Debug, Default)]
pub(crate) struct Pilot {
    camera: Option<Camera>,
    flight: Option<(Instant, Camera, Camera)>,
    /// The keys that are held, apart from those that were pressed as a part of a shortcut.
    held: Vec<Key>,
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

    /// Notes the keys that are held. It is called in every frame, since each event is seen in one. Ctrl-Q moves nothing,
    /// also where Ctrl is released before Q.
    pub(crate) fn hold(&mut self, input: &InputState) {
        for event in &input.events {
            let Event::Key { key, pressed, repeat: false, modifiers, .. } = event else { continue };
            self.held.retain(|held| held != key);
            if *pressed && !(modifiers.ctrl || modifiers.command) {
                self.held.push(*key);
            }
        }
        self.held.retain(|key| input.key_down(*key));
    }

    /// Returns the directions in which the held keys fly, along [`AXES`].
    pub(crate) fn directions(&self) -> Vec3 {
        let is_held = |key| f32::from(self.held.contains(&key));
        Vec3::from(AXES.map(|(up, down)| is_held(up) - is_held(down)))
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
            // `take` ends a flight.
            self.flight = Some((begun, from, to));
        }
        share < 1.0
    }

    /// Returns whether the camera is on its way, by itself or by keys.
    pub(crate) fn is_moving(&self) -> bool {
        self.flight.is_some() || self.directions() != Vec3::ZERO
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

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{Context, Modifiers, RawInput};

    /// Returns the directions after each of some frames, in which a key goes down or up with modifiers.
    fn flown(frames: &[(Key, bool, Modifiers)]) -> Vec<Vec3> {
        let (context, mut pilot) = (Context::default(), Pilot::default());
        let step = |&(key, pressed, modifiers)| {
            let event = Event::Key { key, physical_key: None, pressed, repeat: false, modifiers };
            let input = RawInput { events: vec![event], ..RawInput::default() };
            let mut output = context.run_ui(input, |ui| ui.input(|input| pilot.hold(input)));
            output.textures_delta.clear();
            pilot.directions()
        };
        frames.iter().map(step).collect()
    }

    #[test]
    fn held_keys_fly_but_those_of_shortcuts_do_not() {
        let (plain, ctrl) = (Modifiers::NONE, Modifiers::CTRL);
        let down = [(Key::Q, true, plain), (Key::D, true, plain), (Key::Q, false, plain)];
        assert_eq!(flown(&down), [Vec3::NEG_Y, Vec3::new(1.0, -1.0, 0.0), Vec3::X]);
        // Ctrl is released first: Q is still down in the frame in which another key goes up.
        let shortcut =
            [(Key::Q, true, ctrl), (Key::F1, false, plain), (Key::Q, false, plain), (Key::Q, true, plain)];
        assert_eq!(flown(&shortcut), [Vec3::ZERO, Vec3::ZERO, Vec3::ZERO, Vec3::NEG_Y]);
    }
}
