//! Lookups in the maps of owners, against those of the owners themselves.

use frame_graph::port::HandedOn;
use interfaces::virtual_lights::{VirtualLight, to_bytes};
use pass::{Module, OutputDesc, PassTypeError, Value};
use pass_test::visibility::{Receiver, atlas, lookups};

const MODULE: &str = "shaders/visibility-atlas.wgsl";
const TILE: u32 = 8;
const LIGHTS: u32 = 400;
const CLUSTERS: u32 = 5;

/// The cluster of a light.
fn owner(light: u32) -> u32 {
    (light.wrapping_mul(0x9e37_79b9) >> 16) % CLUSTERS
}

/// Lights that look along z, each at a place of its own.
fn looking_along_z(count: u32, spread: f32) -> Vec<VirtualLight> {
    let place = |i: u32| [0.754_88, 0.569_84].map(|step: f32| spread * (i as f32 * step).fract());
    let light = |i| VirtualLight {
        position: [place(i)[0], place(i)[1], 0.0],
        normal: [0.0, 0.0, 1.0],
        flux: [1.0; 3],
        ..VirtualLight::default()
    };
    (0..count).map(light).collect()
}

/// Maps of which every texel is open or closed by a hash of its place.
fn maps() -> Vec<f32> {
    (0..CLUSTERS * TILE * TILE)
        .map(|i: u32| if i.wrapping_mul(0x9e37_79b9) >> 31 == 0 { 3.0e38 } else { 0.01 })
        .collect()
}

/// A receiver of each light over the light that `of` names.
fn receivers(of: impl Fn(u32) -> u32) -> Vec<Receiver> {
    let receiver = |i: u32| {
        let [u, v] = [0.618_03, 0.414_21].map(|step: f64| 2.0 * (f64::from(i) * step).fract() - 1.0);
        Receiver { position: [u, v, 0.7], normal: [0.0, 0.0, -1.0], light: of(i) }
    };
    (0..LIGHTS).map(receiver).collect()
}

#[test]
fn a_light_is_looked_up_in_the_map_of_its_owner() {
    let clusters = looking_along_z(CLUSTERS, 0.5);
    let with = |shared: bool| {
        let mut members = vec![atlas(TILE, &maps())];
        if shared {
            let owners: Vec<u32> = (0..LIGHTS).map(owner).collect();
            let owners = bytemuck::cast_slice(&owners).to_vec();
            let sources = to_bytes(&clusters);
            members.push(("owners", pass_test::buffer(owners.len() as u64), owners));
            members.push(("sources", pass_test::buffer(sources.len() as u64), sources));
        }
        let receivers = receivers(|i| if shared { i } else { owner(i) });
        // The lights of their own are elsewhere, where each sees something else.
        let lights = if shared { looking_along_z(LIGHTS, 3.0) } else { clusters.clone() };
        let outputs = lookups(&lights, &receivers)
            .input("visibility", "Visibility", &[("tile", TILE), ("columns", 1), ("rows", 1)], members)
            .fact("depth_bias", 0.02)
            .fact("slope_bias", 0.0)
            .module(MODULE)
            .module_option("SHARED", shared)
            .run()?;
        Some(outputs.read::<f32>("answers"))
    };
    let (Some(shared), Some(direct)) = (with(true), with(false)) else { return };
    assert_eq!(shared, direct);
    let seen = direct.iter().filter(|seen| **seen > 0.0).count();
    assert!((100..300).contains(&seen), "{seen} of 400 are lit");
    assert!((0..CLUSTERS).all(|cluster| (0..LIGHTS).any(|light| owner(light) == cluster)));
}

/// Describes the outputs of the pass for maps with such members and such a module.
fn outputs(members: &[&str], module: Option<Module>) -> Result<Vec<OutputDesc>, PassTypeError> {
    let facts = [("tile", 8.into()), ("depth_bias", 0.5.into())];
    let maps = pass_test::maps(members, &pass_test::buffer(16), &facts, module);
    pass_test::outputs_of(share_visibility::PASS, &[], &[maps], &[])
}

#[test]
fn maps_are_handed_on_with_their_facts_and_their_module() {
    let module = Module::new(MODULE);
    let made = &outputs(&["atlas"], Some(module.clone())).expect("maps with a lookup")[0];
    assert!(made.members.is_empty(), "nothing is written");
    let all = HandedOn::All { input: "maps".into() };
    assert!(made.handed.len() == 3 && made.handed[0] == all, "{:?}", made.handed);
    assert_eq!(made.facts.get("tile"), Some(&Value::U32(8)));
    assert_eq!(made.facts.get("depth_bias"), Some(&Value::F32(0.5)));
    assert_eq!(made.facts.module(), Some(&module.option("SHARED", Value::Bool(true))));
}

#[test]
fn what_cannot_be_shared_is_refused() {
    for (members, module, why) in [
        (&["atlas"][..], None, "has no module"),
        (&[], Some("shaders/visibility-none.wgsl"), "cannot be shared"),
        (&["atlas", "owners", "sources"], Some(MODULE), "shared already"),
    ] {
        let refused = outputs(members, module.map(Module::new)).expect_err(why);
        assert_eq!(refused.input.as_deref(), Some("maps"));
        assert!(refused.message.contains(why), "{}", refused.message);
    }
}
