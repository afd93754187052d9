//! The scene that most cases change: the Cornell box with a spot, written as a scene file.

use serde::Deserialize;
use std::fmt::Write as _;

/// The Cornell box, scaled and moved, with a camera and lights.
#[derive(Clone, Debug, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(crate) struct Room {
    /// The description.
    #[serde(skip)]
    pub(crate) about: String,
    /// Geometry in place of the box: a value of the grammar.
    pub(crate) geometry: String,
    /// Objects beside it: `Object(…)`, in the space of the box.
    pub(crate) objects: Vec<String>,
    /// Factor of all lengths.
    pub(crate) scale: f64,
    /// Place of the box's corner \[m\].
    pub(crate) place: [f64; 3],
    /// Position and target of the camera in the space of the box.
    pub(crate) camera: [[f64; 3]; 2],
    /// Vertical field of view in degrees.
    pub(crate) fov: f64,
    /// The near plane \[m\]; left to the loader where `None`.
    pub(crate) near: Option<f64>,
    /// The lights.
    pub(crate) lights: Vec<Lamp>,
    /// Number of lights over which each of `lights` is split.
    pub(crate) light_count: u32,
    /// Keyframes, as a value of the grammar; in world space.
    pub(crate) keyframes: Option<String>,
}

/// A light in the space of the box.
#[derive(Clone, Debug, Deserialize)]
pub(crate) enum Lamp {
    /// Position, direction, intensity \[W/sr\] and half the angle of the cone in degrees.
    Spot([f64; 3], [f64; 3], f64, f64),
    /// Position and intensity \[W/sr\].
    Point([f64; 3], f64),
    /// Direction and irradiance \[W/m²\].
    Sun([f64; 3], f64),
}

/// The spot of `cornell-box`.
const SPOT: Lamp = Lamp::Spot([0.13, 0.5, 0.1], [1.0, -0.75, 0.55], 0.8, 30.0);

impl Default for Room {
    fn default() -> Room {
        Room {
            about: "The Cornell box, lit by a spot at the red wall".to_owned(),
            geometry: "BuiltIn(\"cornell-box\")".to_owned(),
            objects: Vec::new(),
            scale: 1.0,
            place: [0.0; 3],
            camera: [[0.278, 0.273, -0.8], [0.278, 0.273, 0.0]],
            fov: 39.3077,
            near: None,
            lights: vec![SPOT],
            light_count: 1,
            keyframes: None,
        }
    }
}

/// A vector of the grammar. `{:?}` of a float always has what reads back to the same number.
fn vector([x, y, z]: [f64; 3]) -> String {
    format!("({x:?}, {y:?}, {z:?})")
}

impl Room {
    /// Returns a room with a file in place of the Cornell box: a box from the origin to (1, 1, 1).
    pub(crate) fn of_file(file: &str, about: String) -> Room {
        Room {
            about,
            geometry: format!("File({file:?})"),
            scale: 0.55,
            camera: [[0.5, 0.5, -1.4], [0.5, 0.5, 0.0]],
            lights: vec![Lamp::Spot([0.25, 0.9, 0.2], [1.0, -0.75, 0.55], 2.6, 30.0)],
            ..Room::default()
        }
    }

    /// Returns a point of the box in world space.
    fn world(&self, at: [f64; 3]) -> [f64; 3] {
        std::array::from_fn(|i| at[i] * self.scale + self.place[i])
    }

    /// Returns the text of the scene file.
    pub(crate) fn text(&self) -> String {
        let mut out = format!("// Written by `lightloom stress`.\nScene(\n    about: {:?},\n", self.about);
        let plain = self.scale == 1.0 && self.place == [0.0; 3] && self.objects.is_empty();
        if plain {
            let _ = writeln!(out, "    geometry: {},", self.geometry);
        } else {
            let scale = vector([self.scale; 3]);
            let transform = format!("Transform(translate: {}, scale: {scale})", vector(self.place));
            let _ = writeln!(out, "    geometry: Objects([");
            let _ = writeln!(out, "        Object(");
            let _ = writeln!(out, "            name: \"all\", transform: {transform},");
            let _ = writeln!(out, "            geometry: Objects([");
            let _ = writeln!(out, "                Object(name: \"box\", geometry: {}),", self.geometry);
            for object in &self.objects {
                let _ = writeln!(out, "                {object},");
            }
            let _ = writeln!(out, "            ]),\n        ),\n    ]),");
        }
        let [position, target] = self.camera.map(|at| vector(self.world(at)));
        let near = self.near.map_or(String::new(), |near| format!(", near: {near:?}"));
        let _ = writeln!(
            out,
            "    camera: Camera(position: {position}, target: {target}, vertical_fov_deg: {:?}{near}),",
            self.fov
        );
        let _ = writeln!(out, "    lights: [");
        // Irradiance stays where lengths grow, if intensities grow with their square.
        let area = self.scale * self.scale;
        let count = f64::from(self.light_count);
        let lights =
            self.lights.iter().flat_map(|light| std::iter::repeat_n(light, self.light_count as usize));
        for (i, light) in lights.enumerate() {
            let grey = |value: f64| vector([value / count; 3]);
            let light = match light {
                Lamp::Spot(at, direction, intensity, outer) => format!(
                    "Spot(name: \"light {i}\", position: {}, direction: {}, intensity: {}, outer_deg: {outer:?})",
                    vector(self.world(*at)),
                    vector(*direction),
                    grey(intensity * area)
                ),
                Lamp::Point(at, intensity) => format!(
                    "Point(name: \"light {i}\", position: {}, intensity: {})",
                    vector(self.world(*at)),
                    grey(intensity * area)
                ),
                Lamp::Sun(direction, irradiance) => format!(
                    "Directional(name: \"light {i}\", direction: {}, irradiance: {})",
                    vector(*direction),
                    grey(*irradiance)
                ),
            };
            let _ = writeln!(out, "        {light},");
        }
        let _ = writeln!(out, "    ],");
        if let Some(keyframes) = &self.keyframes {
            let _ = writeln!(out, "    keyframes: {keyframes},");
        }
        out + ")\n"
    }
}
