//! Inputs that the pass takes and refuses.

use convolution_soft_shadows::PASS;
use pass::{Format, Module, OutputDesc, PassTypeError, ResourceDesc, Value};

/// Returns the outputs for a number of maps with sides of `tile`, with these members.
fn outputs(size: (u32, u32, u32), members: &[&str]) -> Result<Vec<OutputDesc>, PassTypeError> {
    outputs_of(size, members, None)
}

/// The same of maps that have a module.
fn outputs_of(
    (maps, tile, order): (u32, u32, u32),
    members: &[&str],
    module: Option<Module>,
) -> Result<Vec<OutputDesc>, PassTypeError> {
    let atlas = ResourceDesc::texture_2d_array(Format::R32Float, (tile, tile), maps);
    let facts = [
        ("tile", tile.into()),
        ("columns", 1.into()),
        ("rows", 1.into()),
        ("depth_bias", 0.5.into()),
        ("slope_bias", 0.5.into()),
    ];
    let settings = [
        ("order", order.into()),
        ("levels", 13.into()),
        ("attenuation", 1.5.into()),
        ("offset", 0.6.into()),
        ("search", 2.into()),
        ("nearest", 0.5.into()),
    ];
    pass_test::outputs_of(PASS, &settings, &[pass_test::maps(members, &atlas, &facts, module)], &[])
}

#[test]
fn the_atlas_is_handed_on_with_its_images() {
    let made = &outputs((64, 256, 4), &["atlas"]).expect("an atlas with its facts")[0];
    assert!(made.members.len() == 1 && made.handed.len() == 1, "the atlas is handed on");
    // A header of a word; nine of them for each texel of levels 1 to 8.
    let texels = (0..8).map(|level| 4_u64.pow(level)).sum::<u64>();
    assert_eq!(made.members[0].1, ResourceDesc::buffer(64 * 4 * (1 + 9 * texels)));
    let module = |made: &OutputDesc| made.facts.module().expect("it has a module").clone();
    assert_eq!(module(made).facts.get("iterations"), Some(&Value::U32(2 * 4 * 3)));
    assert_eq!(module(made).facts.get("levels"), Some(&Value::U32(8)));
    assert_eq!(module(made).options.get("SHARED"), None);
    let shared = Module::new("shaders/visibility-atlas.wgsl").option("SHARED", Value::Bool(true));
    let shared = &outputs_of((64, 256, 4), &["atlas", "owners", "sources"], Some(shared))
        .expect("maps that lights share")[0];
    assert_eq!(module(shared).options.get("SHARED"), Some(&Value::Bool(true)));
}

#[test]
fn images_that_no_buffer_holds_are_refused() {
    let refused = |maps, tile, order| outputs((maps, tile, order), &["atlas"]).expect_err("too large");
    let error = refused(128, 256, 16);
    assert_eq!(error.input.as_deref(), Some("maps"));
    assert_eq!(
        error.message,
        "the basis images of 128 maps of 256² by 16 orders take 352 MiB, of which every adapter binds 128"
    );
    assert_eq!(error.help.as_deref(), Some("take at most 46 maps, maps of 128², or `order: 5`"));
    // What it advises is taken.
    for (maps, tile, order) in [(46, 256, 16), (128, 128, 16), (128, 256, 5)] {
        outputs((maps, tile, order), &["atlas"]).expect("as advised");
    }
    assert!(outputs((47, 256, 16), &["atlas"]).is_err(), "no more");
    // A dispatch has no more workgroups along a dimension.
    let error = refused(70_000, 2, 4);
    assert_eq!(error.help.as_deref(), Some("take at most 65535 maps"));
}

#[test]
fn what_has_no_maps_or_has_images_is_refused() {
    for (members, why) in
        [(&[][..], "lacks the member `atlas`"), (&["atlas", "basis"], "has the member `basis` already")]
    {
        let refused = outputs((4, 64, 4), members).expect_err(why);
        assert_eq!(refused.input.as_deref(), Some("maps"));
        assert!(refused.message.contains(why), "{}", refused.message);
    }
}
