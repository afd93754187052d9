//! Notes about values that look as if they were in another unit.

use crate::{LightKind, Scene};
use std::f32::consts::{FRAC_PI_2, PI};

/// The extent beyond which lengths are likely no metres \[m\].
const MOST_EXTENT: f32 = 1000.0;

/// Returns a note for each angle that is as small as a number of radians taken as degrees, and for an extent as large as one
/// in millimetres.
pub(crate) fn suspects(scene: &Scene) -> Vec<String> {
    let mut notes = Vec::new();
    let mut angle = |what: String, radians: f32, most: f32| {
        // No angle in radians is above `most`.
        if radians.to_degrees() <= most {
            let degrees = radians.to_degrees();
            notes.push(format!("{what} is {degrees:.2}°: in scene files angles are in degrees"));
        }
    };
    for light in &scene.lights {
        if let LightKind::Spot { outer, .. } = light.kind {
            angle(format!("half the cone of the light `{}`", light.name), outer, FRAC_PI_2);
        }
    }
    angle("what the camera sees from top to bottom".to_owned(), scene.camera.vertical_fov, PI);
    let extent = scene.extent();
    if extent > MOST_EXTENT {
        notes.push(format!("the scene is {extent:.0} m wide: lengths are in metres"));
    }
    notes
}
