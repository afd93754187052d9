//! The camera of pbrt.

use super::Scene;
use crate::codes;
use crate::error::SceneError;
use crate::offline::collector::Camera;
use crate::offline::report::{error, shortened};

impl Scene<'_> {
    /// Adds the camera, once the film is known.
    pub(super) fn finish_camera(&mut self) -> Result<(), SceneError> {
        let Some((parameters, kind, transform)) = self.camera.take() else { return Ok(()) };
        let span = parameters.span.clone();
        if kind != "perspective" {
            let note =
                format!("the camera of type `{}` is left out: it is no pinhole camera", shortened(&kind));
            self.collector.report.note(&span, note);
            return Ok(());
        }
        parameters.ignore(&["shutteropen", "shutterclose", "focaldistance"]);
        if parameters.number_or("lensradius", 0.0)? > 0.0 {
            self.collector
                .report
                .note(parameters.place("lensradius"), "the lens is left out: all is in focus");
        }
        let aspect = parameters.number_or("frameaspectratio", self.film[0] / self.film[1])?;
        let fov = parameters.number_or("fov", 90.0)?;
        if !(fov > 0.0 && fov < 180.0 && aspect > 0.0) {
            let place = parameters.place("fov");
            return Err(error(
                &codes::RANGE,
                place,
                "`fov` must be between 0° and 180°",
                "this field of view",
            ));
        }
        parameters.note_unused(&mut self.collector.report);
        let camera = Camera {
            name: "camera".to_owned(),
            transform,
            x_is_right: true,
            vertical_fov: of_shorter_axis(fov.to_radians(), aspect),
            near: 0.0,
        };
        self.collector.camera(camera, &span)
    }
}

/// Returns the vertical field of view \[rad\] for that along the shorter axis of a picture with `width / height = aspect`.
fn of_shorter_axis(fov: f64, aspect: f64) -> f64 {
    match aspect >= 1.0 {
        true => fov,
        false => 2.0 * ((0.5 * fov).tan() / aspect).atan(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_field_of_view_is_that_of_the_shorter_axis() {
        let fov = 60_f64.to_radians();
        assert_eq!(of_shorter_axis(fov, 2.0), fov);
        assert_eq!(of_shorter_axis(fov, 1.0), fov);
        let tall = of_shorter_axis(fov, 0.5);
        assert!(((0.5 * tall).tan() - 2.0 * (0.5 * fov).tan()).abs() < 1e-12);
    }
}
