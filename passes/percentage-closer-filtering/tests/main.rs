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
