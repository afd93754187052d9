//! Filtered lookups against the CPU reference, and against a bilinear lookup of four texels.

use frame_graph::port::InputDesc;
use interfaces::virtual_lights::VirtualLight;
use pass::{
    Compute, Info, OutputContext, OutputDesc, Pass, PassTypeError, Ports, RecordContext, Recording,
    ResourceDesc, SceneBindings, Setting, Settings, Threads, Use, UseContext, Value,
};
use pass_test::Harness;
use percentage_closer_filtering::cpu_reference::filtered;
use std::collections::BTreeMap;
use std::sync::Arc;

const MODULE: &str = "passes/percentage-closer-filtering/percentage-closer-filtering.wgsl";
const SHADER: &str = "passes/percentage-closer-filtering/tests/probe.wgsl";
const TILE: u32 = 8;
const RECEIVERS: u32 = 500;

/// Writes what the module of its input answers.
struct Probe;

impl Pass for Probe {
    fn info(&self) -> Info {
        Info { kind: "probe", about: "", paper: "", shaders: &[SHADER] }
    }

    fn settings(&self, _: &UseContext<'_>) -> Result<Vec<Setting>, PassTypeError> {
        Ok(Vec::new())
    }

    fn ports(&self, _: &UseContext<'_>, _: &Settings) -> Result<Ports, PassTypeError> {
        Ok(Ports {
            inputs: vec![
                pass::input("visibility", "Visibility", ""),
                pass::input("lights", "VirtualLights", ""),
                pass::input("receivers", "Buffer", ""),
            ],
            outputs: vec![pass::output("answers", "Buffer", "")],
            scene_bindings: SceneBindings::NONE,
        })
    }

    fn outputs(&self, _: &UseContext<'_>, _: &OutputContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        Ok(vec![OutputDesc::one("answers", ResourceDesc::buffer(16 * u64::from(RECEIVERS)))])
    }

    fn record(&self, cx: &RecordContext<'_>) -> Result<Recording, PassTypeError> {
        Ok(Recording::one(Compute::new(cx.shader(SHADER, &[]), "probe", Threads::Grid([RECEIVERS, 1, 1]))))
    }
}

/// Two maps, of which every texel is open or closed by a hash of its place.
fn maps() -> Vec<f32> {
    (0..2 * TILE * TILE)
        .map(|i: u32| if i.wrapping_mul(0x9e37_79b9) >> 31 == 0 { 3.0e38 } else { 0.01 })
        .collect()
}

/// Position, light and normal of receivers on spheres around two lights that look along z.
fn receivers() -> Vec<[f32; 8]> {
    (0..RECEIVERS)
        .map(|i| {
            let [u, v] = [0.754_877, 0.569_840].map(|step: f64| (f64::from(i) * step).fract());
            let (z, angle) = (0.02 + 0.97 * u, std::f64::consts::TAU * v);
            let radius = (1.0 - z * z).sqrt();
            let direction = [radius * angle.cos(), radius * angle.sin(), z].map(|x| x as f32);
            let at = direction.map(|x| 2.0 * x);
            let light = f32::from_bits(i % 2);
            [at[0], at[1], at[2], light, -direction[0], -direction[1], -direction[2], 0.0]
        })
        .collect()
}

/// For each receiver what the module answers, what a bilinear lookup does, and where in its map the receiver falls.
fn answers(taps: u32) -> Option<Vec<[f32; 4]>> {
    let light = VirtualLight { normal: [0.0, 0.0, 1.0], flux: [1.0; 3], ..VirtualLight::default() };
    let atlas = pass::ResourceDesc::texture_2d_array(pass::Format::R32Float, (TILE, TILE), 2);
    let outputs = Harness::new(&Probe)
        .input(
            "visibility",
            "Visibility",
            &[("tile", TILE), ("columns", 1), ("rows", 1), ("taps", taps)],
            vec![("atlas", atlas, bytemuck::cast_slice(&maps()).to_vec())],
        )
        .fact("depth_bias", 0.5)
        .fact("slope_bias", 0.0)
        .module(MODULE)
        .lights(&[light; 2])
        .input(
            "receivers",
            "Buffer",
            &[],
            vec![(
                "",
                pass_test::buffer(32 * u64::from(RECEIVERS)),
                bytemuck::cast_slice(&receivers()).to_vec(),
            )],
        )
        .run()?;
    Some(outputs.read("answers"))
}

#[test]
fn lookups_agree_with_the_cpu_reference() {
    let maps: Vec<f64> = maps().into_iter().map(f64::from).collect();
    let size = (TILE * TILE) as usize;
    for taps in [1, 2, 3, 7] {
        let Some(answers) = answers(taps) else { return };
        let mut between = 0;
        for (i, [got, _, x, y]) in answers.into_iter().enumerate() {
            let map = &maps[i % 2 * size..][..size];
            // At 2 m all that is closed is nearer and all that is open is not, whatever the bias.
            let wanted = filtered(map, TILE, [x, y].map(f64::from), 1.0, taps);
            assert!((f64::from(got) - wanted).abs() < 1e-5, "receiver {i}, {taps} taps: {got} for {wanted}");
            between += usize::from(got > 0.0 && got < 1.0);
        }
        assert!(between > 400, "{between} receivers are in penumbrae");
    }
}

#[test]
fn one_tap_is_bilinear_to_the_bit() {
    let Some(answers) = answers(1) else { return };
    for [got, bilinear, ..] in answers {
        assert_eq!(got.to_bits(), bilinear.to_bits());
    }
}

#[test]
fn a_window_over_an_open_map_sees_all_and_over_a_closed_one_nothing() {
    for taps in 1..=16 {
        for position in [[0.0, 0.0], [3.3, 7.9], [8.0, 4.5]] {
            let uniform = |distance| filtered(&[distance; 64], TILE, position, 1.0, taps);
            assert!((uniform(2.0) - 1.0).abs() < 1e-12 && uniform(0.5) == 0.0, "{taps} taps at {position:?}");
        }
    }
}

#[test]
fn it_filters_maps_and_nothing_else() {
    let (library, overrides, inputs) = (pass_test::shaders(), BTreeMap::new(), ["maps".to_owned()]);
    let kind = percentage_closer_filtering::PASS;
    let use_ = Use { kind: kind.info().kind, shader: None, inputs: &inputs, outputs: &overrides };
    let settings = Settings(BTreeMap::from([("taps".to_owned(), Value::U32(3))]));
    let outputs = |members: Vec<(String, ResourceDesc)>, facts: &[(&str, Value)]| {
        let maps = InputDesc {
            name: "maps".into(),
            interface: "Visibility".into(),
            members,
            facts: Arc::new(facts.iter().cloned().collect()),
        };
        let context = OutputContext {
            use_,
            settings: &settings,
            inputs: &[maps],
            frame: (8, 8),
            traits: &pass::Traits::default(),
        };
        kind.outputs(&UseContext { use_, shaders: &library, interfaces: interfaces::INTERFACES }, &context)
    };
    let atlas = || vec![("atlas".to_owned(), ResourceDesc::texture_2d(pass::Format::R32Float, (8, 8)))];
    let facts = [
        ("tile", Value::U32(8)),
        ("columns", Value::U32(1)),
        ("rows", Value::U32(1)),
        ("depth_bias", Value::F32(0.5)),
        ("slope_bias", Value::F32(0.25)),
    ];
    let made = outputs(atlas(), &facts).expect("an atlas with its facts");
    assert_eq!(made[0].facts.get("depth_bias"), Some(&Value::F32(1.0)), "the window is twice as wide");
    assert_eq!(made[0].facts.get("slope_bias"), Some(&Value::F32(0.5)));
    assert!(made[0].members.is_empty() && made[0].handed.len() == 1, "the atlas is handed on");
    let refused = outputs(Vec::new(), &facts).expect_err("rays have no maps");
    assert_eq!(refused.input.as_deref(), Some("maps"));
    let refused = outputs(atlas(), &facts[1..]).expect_err("no `tile`");
    assert!(refused.message.contains("`tile`"), "{}", refused.message);
}

/// A plane that fills the maps of a light, with what they store: at each texel the distance along the ray through its
/// centre. Receivers lie on the plane, or behind it by a part of their distance.
struct Plane {
    /// Unit, towards the light.
    normal: [f64; 3],
    /// The light's distance from it \[m\].
    height: f64,
}

impl Plane {
    /// The distance along a unit direction; `None` where it is not met.
    fn along(&self, direction: [f64; 3]) -> Option<f64> {
        let along: f64 = std::iter::zip(self.normal, direction).map(|(n, d)| n * d).sum();
        (along < -1e-3).then(|| -self.height / along)
    }

    fn answers(&self, module: &str, tile: u32, behind: f64) -> Option<Vec<[f32; 4]>> {
        let centre = |i: u32| (f64::from(i) + 0.5) * 2.0 / f64::from(tile) - 1.0;
        let stored = |i: u32| {
            let (x, y) = (centre(i % tile), centre(i / tile));
            let r2 = x * x + y * y;
            let direction = [2.0 * x, 2.0 * y, 1.0 - r2].map(|d| d / (1.0 + r2));
            self.along(direction).map_or(3.0e38, |distance| distance as f32)
        };
        let map: Vec<f32> = (0..tile * tile).map(stored).collect();
        let receivers: Vec<[f32; 8]> = receivers()
            .into_iter()
            .map(|receiver| {
                let direction = [receiver[0], receiver[1], receiver[2]].map(|x| f64::from(x) * 0.5);
                // What the plane does not meet lies behind the light, where nothing is tested.
                let distance = self.along(direction).unwrap_or(-1.0) * (1.0 + behind);
                let [x, y, z] = direction.map(|d| (d * distance) as f32);
                let [u, v, w] = self.normal.map(|n| n as f32);
                [x, y, z, 0.0, u, v, w, 0.0]
            })
            .collect();
        let light = VirtualLight { normal: [0.0, 0.0, 1.0], flux: [1.0; 3], ..VirtualLight::default() };
        let atlas = ResourceDesc::texture_2d_array(pass::Format::R32Float, (tile, tile), 1);
        let bytes = bytemuck::cast_slice(&receivers).to_vec();
        let outputs = Harness::new(&Probe)
            .input(
                "visibility",
                "Visibility",
                &[("tile", tile), ("columns", 1), ("rows", 1), ("taps", 1)],
                vec![("atlas", atlas, bytemuck::cast_slice(&map).to_vec())],
            )
            .fact("depth_bias", 0.02)
            .fact("slope_bias", 0.0)
            .module(module)
            .lights(&[light])
            .input(
                "receivers",
                "Buffer",
                &[],
                vec![("", pass_test::buffer(32 * u64::from(RECEIVERS)), bytes)],
            )
            .run()?;
        Some(outputs.read("answers"))
    }
}

/// Whatever its slope, a plane does not shadow itself with next to no bias, and hides what lies behind it by a tenth of
/// the distance: a bias for the slope would have to be as large as the slope's part of a texel, half of the distance in
/// maps of 8².
#[test]
fn a_plane_is_lit_and_hides_what_is_behind_it() {
    for module in ["shaders/visibility-atlas.wgsl", MODULE] {
        for (tile, degrees) in [(8, 0.0), (8, 30.0), (8, 55.0), (64, 0.0), (64, 30.0), (64, 55.0)] {
            let (sin, cos) = f64::to_radians(degrees).sin_cos();
            let plane = Plane { normal: [0.6 * sin, -0.8 * sin, -cos], height: 1.7 };
            let Some(on) = plane.answers(module, tile, 0.0) else { return };
            let Some(behind) = plane.answers(module, tile, 0.1) else { return };
            let (mut lit, mut leaks, mut all) = (0, 0.0, 0);
            for ((on, behind), receiver) in on.iter().zip(&behind).zip(receivers()) {
                let direction = [receiver[0], receiver[1], receiver[2]].map(|x| f64::from(x) * 0.5);
                // Slopes up to 60°, away from the rim, where texels are not met by the plane.
                let met = plane.along(direction).is_some_and(|distance| plane.height / distance > 0.5);
                if met && receiver[2] > 0.6 {
                    all += 1;
                    lit += usize::from(on[0] > 0.999);
                    leaks += behind[0];
                }
            }
            assert!(all > 60, "{all} receivers");
            assert_eq!(lit, all, "{module}, {tile}², {degrees}°: the plane shadows itself");
            // Some rays through centres meet the plane where it is farther than what lies behind it: the more, the wider
            // the texels.
            let (leaks, most) = (leaks / all as f32, if tile == 8 { 0.5 } else { 0.02 });
            assert!(leaks < most, "{module}, {tile}², {degrees}°: {leaks} of the light leaks");
        }
    }
}
