//! Importance by reflectance against the CPU reference, where one light sends the same into each texel: a directional one.

use crate::cpu_reference::{ViewSample, by_reflectance, reflected, seen};
use glam::{DVec3, Vec3};
use importance_map::PASS;
use pass::{Format, ResourceDesc};
use pass_test::random::{halton3, hash2, unit_float};
use pass_test::{Harness, member};
use scene::{Camera, Scene};

const SIZE: u32 = 24;
const FRAME: (u32, u32) = (16, 12);
const SAMPLES: u32 = 90;

fn vector(element: u32, dimension: u32) -> Vec3 {
    Vec3::from([0, 1, 2].map(|c| unit_float(hash2(element, dimension + c)) as f32))
}

/// A cube of 1 m in the sunlight: its extent is √3 m.
fn scene() -> Scene {
    pass_test::scene_from(
        "Scene(geometry: Objects([Object(name: \"cube\", geometry: BuiltIn(\"cube\"), transform: Transform(translate: \
         (0.5, 0.5, 0.5)))]), lights: [Directional(name: \"sun\", direction: (0.0, -1.0, 0.0), irradiance: (2.0, 3.0, 0.5))])",
    )
}

fn camera() -> Camera {
    let position = Vec3::new(0.4, 0.6, 2.0);
    Camera { position, target: position + Vec3::NEG_Z, up: Vec3::Y, vertical_fov: 1.0, near: 0.01 }
}

/// Every third texel is unlit.
fn lit(texel: u32) -> bool {
    !texel.is_multiple_of(3)
}

fn roughness(texel: u32) -> f32 {
    vector(texel, 90).x
}

fn importance(glossy: bool, weights: (f32, f32), stride: u32) -> Option<Vec<f32>> {
    let array = |name, value: &dyn Fn(u32) -> [f32; 4]| {
        let texels: Vec<[f32; 4]> = (0..SIZE * SIZE).map(value).collect();
        member(name, ResourceDesc::texture_2d_array(Format::Rgba32Float, (SIZE, SIZE), 1), &texels)
    };
    let position = |i| vector(i, 10).extend(if lit(i) { 1.0 } else { 0.0 }).to_array();
    let mut rsm = vec![
        array("position", &position),
        array("normal", &|_| [0.0, 1.0, 0.0, 0.0]),
        array("flux", &|_| [1.0; 4]),
        array("albedo", &|i| vector(i, 30).extend(1.0).to_array()),
    ];
    if glossy {
        rsm.push(array("specular", &|i| vector(i, 60).extend(roughness(i)).to_array()));
    }
    let image = |name, value: &dyn Fn(u32) -> [f32; 4]| {
        let pixels: Vec<[f32; 4]> = (0..FRAME.0 * FRAME.1).map(value).collect();
        member(name, ResourceDesc::texture_2d(Format::Rgba32Float, FRAME), &pixels)
    };
    let view = vec![
        image("depth", &|i| [depth(i); 4]),
        image("normal", &|i| normal(i).extend(0.0).to_array()),
        image("albedo", &|_| [0.5; 4]),
    ];
    let outputs = Harness::new(PASS)
        .set("measure", "reflectance")
        .set("evaluate", if stride == 1 { "texels" } else { "blocks" })
        .set("stride", stride)
        .set("diffuse_weight", weights.0)
        .set("view_weight", weights.1)
        .set("view_samples", SAMPLES)
        .frame(FRAME.0, FRAME.1)
        .with_scene(scene())
        .camera(camera())
        .input("rsm", "ReflectiveShadowMap", &[], rsm)
        .input("view", "GBuffer", &[], view)
        .run()?;
    Some(outputs.read("importance.map"))
}

fn depth(pixel: u32) -> f32 {
    if pixel.is_multiple_of(7) { 0.0 } else { 0.5 + vector(pixel, 40).x }
}

fn normal(pixel: u32) -> Vec3 {
    (vector(pixel, 50) - 0.5).normalize()
}

fn samples() -> Vec<ViewSample> {
    let sample = |k| {
        let [x, y, _] = halton3(k + 1, 0);
        let (x, y) = ((x * f64::from(FRAME.0)) as u32, (y * f64::from(FRAME.1)) as u32);
        let i = y * FRAME.0 + x;
        if depth(i) == 0.0 {
            return ViewSample::default();
        }
        let centred = |at: u32, of: u32| 2.0 * f64::from(at) + 1.0 - f64::from(of);
        let scale = f64::tan(0.5) / f64::from(FRAME.1);
        let way = DVec3::new(centred(x, FRAME.0) * scale, -centred(y, FRAME.1) * scale, -1.0);
        let at = camera().position.as_dvec3() + way * f64::from(depth(i));
        ViewSample { position: at / 3f64.sqrt(), normal: normal(i).as_dvec3(), response: DVec3::ONE }
    };
    (0..SAMPLES).map(sample).collect()
}

#[test]
fn reflectance_is_that_of_the_cpu_reference() {
    let samples = samples();
    for glossy in [false, true] {
        for (diffuse_weight, view_weight) in [(1.0, 0.0), (0.5, 0.5), (0.2, 0.9), (0.0, 1.0)] {
            let Some(found) = importance(glossy, (diffuse_weight, view_weight), 1) else { return };
            let value = |i: u32| {
                if !lit(i) {
                    return (0.0, 0.0);
                }
                let specular = if glossy { vector(i, 60).as_dvec3() } else { DVec3::ZERO };
                let specular = (specular, f64::from(roughness(i)));
                let beam = DVec3::new(2.0, 3.0, 0.5);
                let reflected =
                    reflected(beam, vector(i, 30).as_dvec3(), specular, f64::from(diffuse_weight));
                (reflected, seen(vector(i, 10).as_dvec3() / 3f64.sqrt(), &samples))
            };
            let values: Vec<(f64, f64)> = (0..SIZE * SIZE).map(value).collect();
            let wanted = by_reflectance(&values, f64::from(view_weight));
            for (i, (found, wanted)) in found.iter().zip(&wanted).enumerate() {
                let case = format!("glossy {glossy}, {diffuse_weight} and {view_weight}, texel {i}");
                assert!((f64::from(*found) - wanted).abs() < 1e-4, "{case}: {found} for {wanted}");
            }
            let greatest = found.iter().copied().fold(0.0, f32::max);
            // Vulkan lets a number divided by itself be 2.5 spacings off 1.
            let off = (greatest - 1.0).abs();
            assert!(
                off <= 3.0 * f32::EPSILON,
                "glossy {glossy}, {diffuse_weight} and {view_weight}: {greatest}"
            );
        }
    }
}

/// Where nothing reflects and nothing is seen there is nothing to divide by.
#[test]
fn what_reflects_nothing_has_no_importance() {
    let Some(found) = importance(false, (0.0, 0.0), 1) else { return };
    assert!(found.iter().all(|value| *value == 0.0));
}

/// The view is compared with the middle of a block, or with its first lit texel, and all lit texels of the block have that.
#[test]
fn a_block_is_seen_as_one_of_its_texels() {
    let samples = samples();
    for stride in [2, 5, 32] {
        let Some(found) = importance(false, (1.0, 1.0), stride) else { return };
        let texel_of_block = |i: u32| {
            let first = [i % SIZE, i / SIZE].map(|at| at / stride * stride);
            let inside = |[x, y]: &[u32; 2]| *x < SIZE && *y < SIZE && lit(y * SIZE + x);
            let rest = (0..stride * stride).map(|k| [first[0] + k % stride, first[1] + k / stride]);
            let middle = first.map(|at| at + stride / 2);
            let [x, y] = [middle].into_iter().chain(rest).find(inside).expect("a block has lit texels");
            y * SIZE + x
        };
        let value = |i: u32| {
            let at = vector(texel_of_block(i), 10).as_dvec3() / 3f64.sqrt();
            if lit(i) { (0.0, seen(at, &samples)) } else { (0.0, 0.0) }
        };
        let values: Vec<(f64, f64)> = (0..SIZE * SIZE).map(value).collect();
        for (i, (found, wanted)) in found.iter().zip(by_reflectance(&values, 1.0)).enumerate() {
            assert!(
                (f64::from(*found) - wanted).abs() < 1e-4,
                "stride {stride}, texel {i}: {found} for {wanted}"
            );
        }
    }
}
