//! Environments: their tables, and what is refused of their files.

use std::f64::consts::PI;
use std::fs;

use scene::Environment;

use crate::common::{scene_of, states, try_load};

#[test]
fn a_table_samples_by_luminance_and_solid_angle() {
    let mut environment = Environment { width: 6, height: 5, texels: vec![[1.0; 3]; 30], rotation: 0.0 };
    let whole: f64 = (0..5).map(|row| 6.0 * environment.solid_angle(row)).sum();
    assert!((whole - 4.0 * PI).abs() < 1e-12, "{whole}");
    let share = |environment: &Environment, texel: usize| {
        let table = environment.table();
        f64::from(table[texel + 1] - table[texel]) / 4_294_967_296.0
    };
    let of_row = environment.solid_angle(1) / (4.0 * PI);
    assert!((share(&environment, 7) - of_row).abs() < 1e-9);
    // A sun among dim texels has what it gives, whatever is beside it.
    environment.texels[7] = [1e5; 3];
    let of_sun = 1e5 * of_row / (1e5 * of_row + 1.0 - of_row);
    assert!((share(&environment, 7) - of_sun).abs() < 1e-9);
    assert_eq!(environment.table().last(), Some(&u32::MAX));
    environment.texels.fill([0.0; 3]);
    assert!(environment.is_black() && environment.table() == [0; 31], "nothing is sampled of a black one");
}

#[test]
fn a_description_sets_the_environment() {
    let scene = |environment: &str| {
        scene_of(&format!("Scene(geometry: BuiltIn(\"cube\"), environment: Environment({environment}))"))
    };
    let uniform = scene("radiance: (1, 2, 3)");
    assert_eq!(uniform.environment, Some(Environment::uniform([1.0, 2.0, 3.0])));
    assert!(!states(&uniform, "no lights"), "{:?}", uniform.repairs);
    let sky = scene("map: BuiltIn(\"sky\"), rotation_deg: 90, radiance: (2, 2, 2)");
    let map = sky.environment.clone().expect("there is one");
    assert_eq!((map.width, map.height, map.texels.len()), (128, 64, 128 * 64));
    assert!((f64::from(map.rotation) - 0.5 * PI).abs() < 1e-6);
    assert!(map.texels.iter().any(|texel| texel[0] == 800.0), "a sun");
    assert_ne!(uniform.hash, sky.hash);
    assert_ne!(sky.hash, scene("map: BuiltIn(\"sky\"), rotation_deg: 91, radiance: (2, 2, 2)").hash);
    let black = scene("radiance: (0, 0, 0)");
    assert!(states(&black, "no lights, and nothing emits"), "{:?}", black.repairs);
    assert_eq!(black.traits().values["environment"], data_file::Value::Bool(false));
}

/// A portable float map of 2 × 1 pixels, whose second has these values.
fn float_map(values: [f32; 3]) -> Vec<u8> {
    let floats = [[0.25_f32, 0.5, 1.0], values].concat();
    [b"PF\n2 1\n-1.0\n".to_vec(), floats.iter().flat_map(|x| x.to_le_bytes()).collect()].concat()
}

/// Each error says which file, which pixel, and where in the scene file its name stands.
#[test]
fn maps_that_are_no_light_are_refused_with_their_place() {
    let folder = tempfile::tempdir().unwrap();
    let path = folder.path().join("test.ron");
    let text = |map: &str, radiance: &str| {
        format!(
            "Scene(geometry: BuiltIn(\"cube\"),\n    environment: Environment(map: {map}, radiance: {radiance}))"
        )
    };
    let huge = b"#?RADIANCE\nFORMAT=32-bit_rle_rgbe\n\n-Y 400000 +X 400000\n".to_vec();
    let files = [
        ("nan.pfm", float_map([0.0, f32::NAN, 0.0]), "the pixel (1, 0) is [0.0, NaN, 0.0]"),
        ("infinite.pfm", float_map([f32::INFINITY, 0.0, 0.0]), "the pixel (1, 0) is [inf, 0.0, 0.0]"),
        ("negative.pfm", float_map([0.0, 0.0, -1.0]), "the pixel (1, 0) is [0.0, 0.0, -1.0]"),
        ("broken.hdr", b"#?RADIANCE\n".to_vec(), "a Radiance HDR picture"),
        ("huge.hdr", huge, "a Radiance HDR picture"),
        ("broken.exr", b"no picture".to_vec(), "an EXR picture"),
        ("picture.png", b"no light".to_vec(), "expected a map of radiance: .hdr, .exr or .pfm"),
    ];
    for (name, bytes, expected) in files {
        fs::write(folder.path().join(name), bytes).unwrap();
        fs::write(&path, text(&format!("File(\"{name}\")"), "(1, 1, 1)")).unwrap();
        let error = try_load(&path).expect_err(name).to_string();
        assert!(error.contains(expected) && error.contains(name), "{name}: {error}");
        assert!(error.contains("error[C004]") && error.contains("test.ron:2:40"), "{name}: {error}");
    }
    fs::write(folder.path().join("good.pfm"), float_map([1e20, 0.0, 0.0])).unwrap();
    fs::write(&path, text("File(\"good.pfm\")", "(2, 2, 2)")).unwrap();
    let read = try_load(&path).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(read.environment.unwrap().texels, [[0.5, 1.0, 2.0], [2e20, 0.0, 0.0]]);
    // A factor may not make more of a pixel than counts.
    for (map, radiance, expected) in [
        ("File(\"good.pfm\")", "(1e20, 1, 1)", "the pixel (1, 0) is [1e20, 0.0, 0.0]"),
        ("File(\"god.pfm\")", "(1, 1, 1)", "did you mean `good.pfm`?"),
        ("BuiltIn(\"skye\")", "(1, 1, 1)", "did you mean `sky`?"),
        ("BuiltIn(\"sky\")", "(1, -1, 1)", "a number from 0 to 10³⁰"),
    ] {
        fs::write(&path, text(map, radiance)).unwrap();
        let error = try_load(&path).expect_err(map).to_string();
        assert!(error.contains(expected), "{map}: {error}");
    }
}

/// A map that is too large for some adapters is halved, and keeps its light.
#[test]
fn large_maps_are_halved() {
    let folder = tempfile::tempdir().unwrap();
    let (width, height) = (2049, 1025);
    let texels = (0..width * height).flat_map(|i| [(i % 7) as f32, 1.0, (i / width) as f32]);
    let bytes = [
        format!("PF\n{width} {height}\n-1.0\n").into_bytes(),
        texels.flat_map(f32::to_le_bytes).collect::<Vec<u8>>(),
    ];
    fs::write(folder.path().join("large.pfm"), bytes.concat()).unwrap();
    let path = folder.path().join("test.ron");
    let map = "Environment(map: File(\"large.pfm\"))";
    fs::write(&path, format!("Scene(geometry: BuiltIn(\"cube\"), environment: {map})")).unwrap();
    let scene = try_load(&path).unwrap_or_else(|error| panic!("{error}"));
    assert!(states(&scene, "reduced from 2049 x 1025 to 1025 x 513"), "{:?}", scene.repairs);
    let read = scene.environment.unwrap();
    let mean: f64 = (0..513)
        .map(|row| {
            let texels = &read.texels[row * 1025..][..1025];
            read.solid_angle(row as u32) * texels.iter().map(|texel| f64::from(texel[0])).sum::<f64>()
        })
        .sum::<f64>()
        / (4.0 * PI);
    assert!((mean - 3.0).abs() < 0.01 && read.texels.iter().all(|texel| texel[1] == 1.0), "{mean}");
}
