//! The table of extremes.

use crate::case::{Case, Expect};
use crate::room::{Lamp, Room, SPOT};
use crate::triangles::{Look, degenerate, gltf, not_a_number, open_box, sheets};

/// The name of the plain scene.
pub(crate) const PLAIN: &str = "plain";

/// Width and height of the room \[m\].
const SIZE: f64 = 0.55;

/// Returns all cases. The first is the plain scene, with which others are compared.
pub fn cases() -> Vec<Case> {
    let mut all = vec![plain()];
    all.extend(units());
    all.extend(lights());
    all.extend(cameras());
    all.extend(geometry());
    all.extend(frames());
    all
}

/// The plain scene.
pub(crate) fn plain() -> Case {
    Case::new("plain", PLAIN, "The Cornell box with a spot: nothing is extreme.", Expect::Truth)
}

/// A case of a changed room.
fn room(
    group: &'static str,
    name: impl Into<String>,
    about: &str,
    expect: Expect,
    change: impl FnOnce(&mut Room),
) -> Case {
    let mut room = Room { about: about.to_owned(), ..Room::default() };
    change(&mut room);
    Case::new(group, name, about, expect).scene(room.text())
}

/// Returns cases of other units and places: the picture must not change.
fn units() -> Vec<Case> {
    let mut all = Vec::new();
    for power in [-3, 3, 6] {
        let about = format!("All lengths times 10^{power}, and intensities so that irradiance stays.");
        all.push(room("scale", format!("scale-1e{power}"), &about, Expect::Plain(1.0), |room| {
            room.scale = 10f64.powi(power);
        }));
    }
    for (name, place) in
        [("far-x-1e3", [1e3, 0.0, 0.0]), ("far-x-1e5", [1e5, 0.0, 0.0]), ("far-1e6", [1e6, -1e6, 1e6])]
    {
        let about = "The whole scene far from the origin.";
        all.push(room("place", name, about, Expect::Plain(1.0), |room| room.place = place));
    }
    for power in [-30, -6, 6, 9] {
        let factor = 10f64.powi(power);
        let about = format!("The light times 10^{power}.");
        let name = format!("intensity-1e{power}");
        all.push(room("intensity", name, &about, Expect::Plain(factor), |room| {
            if let Some(Lamp::Spot(_, _, intensity, _)) = room.lights.first_mut() {
                *intensity *= factor;
            }
        }));
    }
    let ends = [
        (30, "The brightest light that is allowed.", Expect::Plain(1e30 / 0.8)),
        (37, "A light at the end of what 32 bits hold.", Expect::Refused),
    ];
    for (power, about, expect) in ends {
        all.push(room("intensity", format!("intensity-1e{power}"), about, expect, |room| {
            room.lights = vec![Lamp::Spot([0.13, 0.5, 0.1], [1.0, -0.75, 0.55], 10f64.powi(power), 30.0)];
        }));
    }
    all
}

fn lights() -> Vec<Case> {
    let lit = |name: &str, about: &str, expect, lights: Vec<Lamp>| {
        room("light", name, about, expect, |room| room.lights = lights)
    };
    let Lamp::Spot(at, to, intensity, _) = SPOT else { return Vec::new() };
    let mut all = vec![
        lit("no-light", "There is no light.", Expect::Black, Vec::new()),
        lit("zero-light", "The light has no intensity.", Expect::Black, vec![Lamp::Spot(at, to, 0.0, 30.0)]),
        lit(
            "light-away",
            "The spot shines out of the room, and sees nothing.",
            Expect::Black,
            vec![Lamp::Spot([0.278, 0.273, -0.1], [0.0, 0.0, -1.0], intensity, 30.0)],
        ),
        lit(
            "light-in-block",
            "The light is inside the short block.",
            Expect::Finite,
            vec![Lamp::Point([0.185, 0.08, 0.169], 0.1)],
        ),
        lit(
            "light-near-wall",
            "A point light a millionth of the room's size from the floor.",
            Expect::Finite,
            vec![Lamp::Point([0.4, SIZE * 1e-6, 0.15], 0.1)],
        ),
        lit(
            "light-far",
            "A spot a million times the room's size away, of as much irradiance.",
            Expect::Truth,
            vec![Lamp::Spot([0.278, 0.273, -SIZE * 1e6], [0.0, 0.0, 1.0], 3.0 * (SIZE * 1e6).powi(2), 30.0)],
        ),
        lit(
            "sun-grazing",
            "A sun that grazes the floor: its direction is a millionth off.",
            Expect::Finite,
            vec![Lamp::Sun([0.3, -1e-6, 1.0], 3.0)],
        ),
        lit(
            "lights-256",
            "The light of one spot from 256 of them.",
            Expect::Truth,
            (0..256).map(|_| Lamp::Spot(at, to, intensity / 256.0, 30.0)).collect(),
        ),
    ];
    for (name, outer) in [("cone-0.01", 0.01), ("cone-85", 85.0), ("cone-89.9", 89.9), ("cone-90", 90.0)] {
        let about = format!("Half the angle of the spot's cone is {outer}°.");
        // The narrow cone has as much flux as a wide one.
        let intensity = if outer < 1.0 { 1e6 } else { intensity * 0.2 };
        // Paths find a spot of light so small by chance alone.
        let expect = if outer < 1.0 { Expect::Finite } else { Expect::Truth };
        all.push(lit(name, &about, expect, vec![Lamp::Spot(at, to, intensity, outer)]));
    }
    all
}

fn cameras() -> Vec<Case> {
    let seen =
        |name: &str, about: &str, expect, change: fn(&mut Room)| room("camera", name, about, expect, change);
    vec![
        seen("camera-in-block", "The camera is inside the short block.", Expect::Finite, |room| {
            room.camera = [[0.185, 0.08, 0.169], [0.185, 0.08, 0.5]];
        }),
        seen(
            "camera-on-wall",
            "The camera looks along the back wall, a micrometre off.",
            Expect::Finite,
            |room| {
                room.camera = [[0.05, 0.3, 0.559199], [0.5, 0.3, 0.559199]];
            },
        ),
        seen(
            "near-1e-7",
            "The near plane is 10⁷ times nearer than the room is wide.",
            Expect::Plain(1.0),
            |room| {
                room.near = Some(SIZE * 1e-7);
            },
        ),
        seen("fov-0.01", "The field of view is a hundredth of a degree.", Expect::Truth, |room| {
            room.fov = 0.01;
            room.camera = [[0.278, 0.273, -0.8], [0.42, 0.35, 0.55]];
        }),
        seen("fov-150", "The field of view is 150 degrees.", Expect::Truth, |room| room.fov = 150.0),
        seen("fov-179.9", "The field of view is 179.9 degrees.", Expect::Finite, |room| room.fov = 179.9),
        seen(
            "camera-fast",
            "The camera comes at 10 km/s, and is in its place in the last frame.",
            Expect::Plain(1.0),
            |room| {
                room.keyframes = Some(
                    "Keyframes(frames_per_second: 30, camera: [
        Key(time: 0.0, position: (0.278, 0.273, -334.13333), target: (0.278, 0.273, 0.0)),
        Key(time: 0.033333335, position: (0.278, 0.273, -0.8), target: (0.278, 0.273, 0.0)),
    ])"
                    .to_owned(),
                );
            },
        )
        .frames(2),
        seen("step-0", "No time passes between frames, to 32 bits.", Expect::Plain(1.0), |room| {
            room.keyframes = Some(still(1e30));
        })
        .frames(3),
        seen("step-hour", "An hour passes between frames.", Expect::Plain(1.0), |room| {
            room.keyframes = Some(still(1.0 / 3600.0));
        })
        .frames(3),
    ]
}

/// Keyframes in which nothing moves, at a rate.
fn still(rate: f64) -> String {
    format!(
        "Keyframes(frames_per_second: {rate:?}, camera: [Key(time: 0.0, position: (0.278, 0.273, -0.8)), \
         Key(time: 1.0, position: (0.278, 0.273, -0.8))])"
    )
}

fn geometry() -> Vec<Case> {
    let changed = |name: &str, about: &str, expect, change: &dyn Fn(&mut Room)| {
        room("geometry", name, about, expect, change)
    };
    // The open box of triangles takes the place of the Cornell box.
    let of_triangles = |name: &str, about: &str, expect, triangles: &[[[f32; 3]; 3]], look: Look| {
        let file = format!("{name}.gltf");
        let case = changed(name, about, expect, &|room| {
            room.geometry = format!("File({file:?})");
            room.scale = SIZE;
            room.camera = [[0.5, 0.5, -1.4], [0.5, 0.5, 0.0]];
            room.lights = vec![Lamp::Spot([0.25, 0.9, 0.2], [1.0, -0.75, 0.55], 2.6, 30.0)];
        });
        case.file(&file, gltf(triangles, look))
    };
    let half = Look { albedo: 0.5, texel: false };
    vec![
        changed("no-triangle", "There is no geometry.", Expect::Black, &|room| {
            room.geometry = "BuiltIn(\"empty\")".to_owned();
        }),
        of_triangles(
            "one-triangle",
            "There is one triangle, which nothing reflects light at.",
            Expect::Black,
            &[[[0.0, 0.0, 1.0], [1.0, 0.0, 1.0], [0.5, 1.0, 1.0]]],
            half,
        ),
        of_triangles(
            "albedo-0",
            "Nothing reflects light.",
            Expect::Black,
            &open_box(),
            Look { albedo: 0.0, texel: false },
        ),
        of_triangles(
            "albedo-1",
            "All light is reflected.",
            Expect::Truth,
            &open_box(),
            Look { albedo: 1.0, texel: false },
        ),
        of_triangles(
            "texel",
            "The texture is of one texel.",
            Expect::Truth,
            &open_box(),
            Look { albedo: 0.5, texel: true },
        ),
        changed(
            "degenerate",
            "Triangles without area and slivers hang in the room.",
            Expect::Plain(1.0),
            &|room| {
                room.objects
                    .push("Object(name: \"slivers\", geometry: File(\"degenerate.gltf\"))".to_owned());
            },
        )
        .file("degenerate.gltf", gltf(&degenerate(), half)),
        changed(
            "triangles-1e7",
            "Ten million triangles: 41,400 instances of a sheet of 242 lie on the floor.",
            Expect::Finite,
            &|room| {
                room.objects
                    .push("Object(name: \"sheets\", geometry: File(\"triangles-1e7.gltf\"))".to_owned());
            },
        )
        .file("triangles-1e7.gltf", sheets(11, 41_400)),
        changed(
            "objects-1e5",
            "A hundred thousand objects, each a sheet of two triangles, lie on the floor.",
            Expect::Finite,
            &|room| {
                room.objects
                    .push("Object(name: \"sheets\", geometry: File(\"objects-1e5.gltf\"))".to_owned());
            },
        )
        .file("objects-1e5.gltf", sheets(1, 100_000)),
        changed(
            "nan-normals",
            "A sheet has normals and texture coordinates that are NaN, beneath a texture.",
            Expect::Finite,
            &|room| {
                room.objects.push("Object(name: \"sheet\", geometry: File(\"nan-normals.gltf\"))".to_owned());
            },
        )
        .file("nan-normals.gltf", not_a_number()),
        changed(
            "block-1e-6",
            "A cube a millionth of the room's size is in it.",
            Expect::Plain(1.0),
            &|room| {
                room.objects.push(
                "Object(name: \"cube\", geometry: BuiltIn(\"cube\"), transform: Transform(translate: (0.4, 0.3, 0.2), \
                 scale: (5.5e-7, 5.5e-7, 5.5e-7)))"
                    .to_owned(),
            );
            },
        ),
        changed(
            "far-block",
            "A block ten thousand times the room's size away makes the scene as large.",
            Expect::Truth,
            &|room| {
                room.objects.push(
                "Object(name: \"cube\", geometry: BuiltIn(\"cube\"), transform: Transform(translate: (0.0, 0.0, 5500.0)))"
                    .to_owned(),
            );
            },
        ),
    ]
}

fn frames() -> Vec<Case> {
    let frame = |name: &str, about: &str| Case::new("frame", name, about, Expect::Truth);
    vec![
        frame("frame-1x1", "The frame is of one pixel.").size(1, 1),
        frame("frame-2x2", "The frame is smaller than the blocks of interleaving.").size(2, 2),
        frame("frame-3x5", "The frame is of odd sides, smaller than the blocks.").size(3, 5),
        frame("frame-17x9", "The frame is of odd sides.").size(17, 9),
        frame("frame-1x65", "The frame is one pixel wide.").size(1, 65),
        Case::new("frame", "frame-257x1", "The frame is one pixel high.", Expect::Finite).size(257, 1),
        Case::new("frame", "lights-1", "There is one virtual light.", Expect::Finite).set("lights", 1),
        frame("map-1", "Shadow maps are of one texel.").set("map", 1),
        // One point of all that the light sees stands for it.
        Case::new("frame", "rsm-1", "The reflective shadow map is of one texel.", Expect::Finite)
            .set("rsm.size", 1),
        frame("still-100", "A hundred frames in which nothing moves.").frames(100),
    ]
}
