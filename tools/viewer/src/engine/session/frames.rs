//! Frames of all sides, and what is published of them.

use super::{FRAME, STILL, Session};
use crate::engine::Publisher;
use crate::engine::measure::Measured;
use crate::engine::model::{Published, SideId};
use interfaces::virtual_lights::VirtualLight;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::{Duration, Instant};

/// A frame that takes longer than this is announced: what is shown meanwhile is old \[ms\].
const SLOW: f32 = 400.0;

impl Session {
    /// Runs a frame of each side that has something to do, or of one alone, and publishes the results.
    pub(super) fn frames(&mut self, publisher: &Publisher, only: Option<SideId>, waits: &AtomicBool) {
        self.due = Instant::now() + FRAME;
        let still = self.moved.elapsed() > STILL && !self.playing;
        let mut made = false;
        for at in 0..self.sides.len() {
            let (id, side) = &mut self.sides[at];
            let id = *id;
            let gives_way = id != SideId::A && made && waits.load(Ordering::Acquire);
            let rests =
                gives_way || (id == SideId::Reference && !still) || only.is_some_and(|only| only != id);
            if rests || !side.wants_a_frame() {
                continue;
            }
            let first = side.is_new().then(|| side.renderer.pipeline_name().to_owned());
            let slow = side.whole().last().is_some_and(|ms| ms > SLOW);
            if let Some(name) = &first {
                publisher.stage(Some(format!("Rendering the first frame of {name}")));
            } else if slow {
                publisher.stage(Some(format!("Rendering a frame of {}", id.name())));
            }
            let done = side.frame();
            if first.is_some() || slow {
                publisher.stage(None);
            }
            match done {
                Ok(()) => {
                    if id == SideId::A {
                        self.count();
                    }
                    self.publish(publisher, Some(id), None);
                    made = true;
                }
                Err(error) => {
                    side.renderer.run_everything();
                    self.trouble(id.name(), &error, publisher);
                    // Not again at once: the error would be reported without end.
                    self.due = Instant::now() + Duration::from_millis(500);
                }
            }
        }
        if self.sides.iter().any(|(_, side)| side.converges()) && still {
            self.due = Instant::now();
        }
        self.measuring.offer(&self.sides);
        let measured = self.measuring.newest();
        if measured.is_some() {
            self.publish(publisher, None, measured);
        }
    }

    /// Publishes a side as it is now.
    pub(super) fn publish_side(&self, published: &mut Published, id: SideId) {
        let side = self.sides.iter().find(|(known, _)| *known == id);
        let Some(view) = side.and_then(|(_, side)| side.view()) else { return };
        match published.sides.iter_mut().find(|(known, _)| *known == id) {
            Some((_, known)) => *known = view,
            None => published.sides.push((id, view)),
        }
        published.sides.sort_by_key(|(id, _)| *id);
    }

    /// Takes note of a frame that was made now.
    fn count(&mut self) {
        let now = Instant::now();
        self.made.push(now);
        let old = |at: &Instant| now.duration_since(*at) > Duration::from_secs(1);
        let gone = self.made.iter().take_while(|at| old(at)).count();
        self.made.drain(..gone.min(self.made.len().saturating_sub(2)));
    }

    /// Returns the frames a second; 0 before there are two.
    fn rate(&self) -> f32 {
        let (Some(first), Some(last)) = (self.made.first(), self.made.last()) else { return 0.0 };
        let seconds = last.duration_since(*first).as_secs_f32();
        if seconds > 0.0 { (self.made.len() - 1) as f32 / seconds } else { 0.0 }
    }

    fn publish(&mut self, publisher: &Publisher, made: Option<SideId>, measured: Option<Arc<Measured>>) {
        let looked = self.look.as_ref().filter(|look| made == Some(look.side)).and_then(|look| {
            let (_, side) = self.sides.iter().find(|(id, _)| *id == look.side)?;
            Some(side.look(look))
        });
        let lights = (self.wants_lights && made == Some(SideId::A))
            .then(|| self.sides.first()?.1.virtual_lights())
            .flatten();
        let lights = lights.map(|lights| {
            let before = std::mem::replace(&mut self.lights_before, lights.clone());
            let differs = |i: usize, light: &VirtualLight| {
                before.get(i).is_none_or(|old| old.position != light.position)
            };
            Arc::new(lights.into_iter().enumerate().map(|(i, l)| (l, differs(i, &l))).collect::<Vec<_>>())
        });
        let pose = self.sides.first().map(|(_, side)| side.renderer.pose());
        let pose = pose.map(|pose| (pose.camera, pose.lights.clone()));
        publisher.with(|published| {
            if let Some(id) = made {
                self.publish_side(published, id);
            }
            if let Some((camera, lights)) = pose {
                (published.camera, published.lights) = (Some(camera), lights);
            }
            (published.time, published.playing) = (self.time, self.playing);
            match looked {
                Some(Ok(looked)) => (published.looked, published.look_error) = (Some(looked), None),
                Some(Err(error)) => published.look_error = Some(error.to_string()),
                None if self.look.is_none() => (published.looked, published.look_error) = (None, None),
                None => {}
            }
            if let Some(lights) = lights {
                published.virtual_lights = lights;
            } else if !self.wants_lights {
                published.virtual_lights = Arc::default();
            }
            if let Some(measured) = measured {
                published.measured = Some(measured);
            }
            published.frames_per_second = self.rate();
        });
    }
}
