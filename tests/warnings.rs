//! What renders, and perhaps not as its user expects: values without effect, light that is left out, units; and names that
//! mean something else than is asked for. No GPU takes part.

use crate::program::{Done, Folder, command, lightloom, run_in};
use frame_graph::{LinkContext, Overrides, Value};
use renderer::{Assets, Catalog, Compiled};

#[test]
fn known_outputs_hold_what_their_names_say() {
    let outputs = |outputs: &str| format!("Pipeline(extends: \"ism.ron\", outputs: {{ {outputs} }})");
    let mine = Folder::new(&[
        ("bad.ron", &outputs(r#""image": "image.display", "indirect": "view", "irradiance": "image.image""#)),
        ("good.ron", &outputs(r#""image": "direct", "shown": "image.display""#)),
    ]);
    run_in(&mine, &["check", "bad.ron"]).failure(
        1,
        &[
            "error[E035]: the output `image` is a `Radiance`",
            "this is a `Display`",
            "error[E035]: the output `indirect` is a `Radiance`",
            "error[E035]: the output `irradiance` is an `Irradiance`",
        ],
    );
    run_in(&mine, &["check", "good.ron"]).success();
}

#[test]
fn a_difference_in_samples_is_shown() {
    let expected = "+ samples picture: another in each frame, for image/image, image/direct, image/indirect";
    let done = lightloom(&["diff", "ism-invtm", "ism-invtm-accumulated"]).success();
    assert_eq!(
        done.out.lines().filter(|line| line.contains("samples picture")).collect::<Vec<_>>(),
        [expected]
    );
    assert!(!lightloom(&["diff", "ism", "ism-invtm"]).out.contains("samples picture"));
}
