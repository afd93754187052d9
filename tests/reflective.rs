//! Light gathered from reflective shadow maps, against sums over their texels on the CPU.

use crate::adapter::{bits, done, energy, renderer, shown};
use glam::{DVec2, DVec3, Vec3, dvec2, dvec3};
use metrics::Epsilon;
use renderer::Renderer;
use scene::LightKind;
use std::f64::consts::PI;

/// A texel of a map.
struct Texel {
    layer: u32,
    /// Column and row of its middle, as fractions of the map.
    place: DVec2,
    position: DVec3,
    normal: DVec3,
    /// Green \[W\].
    flux: f64,
}

fn vector(texel: [f32; 4]) -> DVec3 {
    Vec3::from_slice(&texel).as_dvec3()
}

/// Column and row.
fn place(i: usize, width: usize) -> DVec2 {
    dvec2((i % width) as f64, (i / width) as f64)
}

/// All texels of the map that saw something.
fn texels(renderer: &Renderer, layers: u32) -> Vec<Texel> {
    let of_layer = |layer| {
        let read = |member| renderer.picture(&format!("rsm.rsm.{member}"), layer).unwrap();
        let [position, normal, flux] = ["position", "normal", "flux"].map(read);
        let side = position.width();
        let texel = move |i: usize| Texel {
            layer,
            place: (place(i, side) + 0.5) / side as f64,
            position: vector(position.pixels()[i]),
            normal: vector(normal.pixels()[i]).normalize_or_zero(),
            flux: flux.pixels()[i][1].into(),
        };
        (0..side * side).map(texel).filter(|texel| texel.normal != DVec3::ZERO)
    };
    (0..layers).flat_map(of_layer).collect()
}

/// Position and normal of what each pixel sees.
fn receivers(renderer: &Renderer) -> Vec<Option<(DVec3, DVec3)>> {
    let [depth, normal] =
        ["depth", "normal"].map(|member| renderer.picture(&format!("view.view.{member}"), 0).unwrap());
    let camera = renderer.scene().camera;
    let axes = camera.view().inverse().as_dmat4();
    let size = dvec2(depth.width() as f64, depth.height() as f64);
    let half = f64::from(camera.vertical_fov / 2.0).tan() * dvec2(size.x / size.y, -1.0);
    let receiver = |i: usize| {
        let along = f64::from(depth.pixels()[i][0]);
        let ray = ((2.0 * place(i, depth.width()) + 1.0) / size - 1.0) * half;
        let at = axes.transform_point3(dvec3(ray.x, ray.y, -1.0) * along);
        (along > 0.0).then(|| (at, vector(normal.pixels()[i]).normalize()))
    };
    (0..depth.width() * depth.height()).map(receiver).collect()
}

fn received(texel: &Texel, (at, normal): (DVec3, DVec3)) -> f64 {
    let offset = at - texel.position;
    let d2 = offset.length_squared();
    texel.flux * texel.normal.dot(offset).max(0.0) * (-normal.dot(offset)).max(0.0) / (PI * d2 * d2)
}

/// The gather at every pixel, with what it read.
fn gathered(scene: &str, radius: &str) -> Option<Renderer> {
    let values = ["lights=8192", "divisor=1", "rsm.size=48", "gather.area_bound=0", radius];
    let mut renderer = renderer("reflective-shadow-maps", scene, (24, 18), &values)?;
    for resource in ["rsm", "view"] {
        renderer.keep(resource).unwrap();
    }
    renderer.frame().unwrap();
    Some(renderer)
}

/// Under a spot, the sun and a point light, of which most pixels lie beyond the edges of most maps, or behind.
#[test]
fn with_the_whole_map_as_radius_each_pixel_has_the_sum_over_all_texels() {
    let Some(renderer) = gathered("cornell-box-lights", "gather.radius=1.5") else { return };
    let layers: u32 = renderer.scene().lights.iter().map(|light| light.layers()).sum();
    let (texels, receivers) = (texels(&renderer, layers), receivers(&renderer));
    let irradiance = renderer.output("irradiance").unwrap();
    let (mut ratios, mut whole) = (Vec::new(), [0.0; 2]);
    for (receiver, found) in receivers.into_iter().zip(irradiance.pixels()) {
        let Some(receiver) = receiver else { continue };
        let expected: f64 = texels.iter().map(|texel| received(texel, receiver)).sum();
        ratios.push(f64::from(found[1]) / expected);
        whole = [whole[0] + f64::from(found[1]), whole[1] + expected];
    }
    ratios.sort_by(f64::total_cmp);
    let [low, middle, high] = [1, 10, 19].map(|twentieth| ratios[ratios.len() * twentieth / 20]);
    // A pixel whose distance to a texel is less than that between texels has one sample for much of its light.
    assert!(layers > 6 && ratios.len() > 300, "{layers} layers, {} pixels", ratios.len());
    assert!(low > 0.97 && (middle - 1.0).abs() < 0.005 && high < 1.03, "{low} to {high}, {middle}");
    assert!((whole[0] / whole[1] - 1.0).abs() < 0.03, "{whole:?} over all pixels");
}

/// The disc lies around the texel that shows what the pixel sees.
#[test]
fn a_small_radius_takes_the_texels_around_the_projection() {
    let Some(renderer) = gathered("cornell-box", "gather.radius=0.25") else { return };
    let (texels, receivers) = (texels(&renderer, 1), receivers(&renderer));
    let irradiance = renderer.output("irradiance").unwrap();
    let (mut pixels, mut errors, mut whole) = (0, 0.0, 0.0);
    for (receiver, found) in receivers.into_iter().zip(irradiance.pixels()) {
        let Some(receiver) = receiver else { continue };
        let distance = |texel: &&Texel| texel.position.distance(receiver.0);
        let own =
            texels.iter().min_by(|a, b| distance(a).total_cmp(&distance(b))).expect("the map is not empty");
        if distance(&own) > 0.01 {
            continue;
        }
        let near =
            texels.iter().filter(|texel| texel.place.distance(own.place) < 0.25 && texel.layer == own.layer);
        let expected: f64 = near.map(|texel| received(texel, receiver)).sum();
        pixels += 1;
        errors += (f64::from(found[1]) - expected).abs();
        whole += expected;
    }
    // Texels that the circle cuts count whole or not at all here: a tenth of those within.
    assert!(pixels > 30 && errors < 0.1 * whole, "{pixels} pixels, {errors} of {whole}");
}

/// What is interpolated differs little from what is gathered at every pixel, the less the finer the picture, and is the same where
/// it is gathered again.
#[test]
fn interpolation_is_near_to_a_gather_at_every_pixel() {
    for scene in ["cornell-box", "cornell-box-point"] {
        let mut errors = Vec::new();
        for side in [48, 96] {
            let picture = |divisor: &str| {
                let values = [divisor, "lights=2048", "rsm.size=256"];
                Some(shown(
                    &mut renderer("reflective-shadow-maps", scene, (side, side), &values)?,
                    "irradiance",
                ))
            };
            let Some(coarse) = picture("divisor=4") else { return };
            let full = picture("divisor=1").expect("the adapter is still there");
            let pair = metrics::Pair::new(&coarse, &full).unwrap();
            errors.push(pair.mape(Epsilon::default()).expect("the picture is lit"));
            let same = bits(&coarse).iter().zip(&bits(&full)).filter(|(a, b)| a == b).count();
            // A sixteenth was gathered first; the rest of these, again.
            let pixels = (side * side) as usize;
            assert!(same > pixels / 14 && same < pixels * 2 / 3, "{scene}: {same} of {pixels} pixels");
        }
        assert!(errors[1] < 0.03 && errors[1] < errors[0], "{scene}: {errors:?}");
    }
}

/// Where nothing is between the surfaces, the light that is gathered is that of path tracing.
#[test]
fn without_occluders_the_energy_is_that_of_path_tracing() {
    let energy_by = |pipeline: &str, values: &[&str]| {
        let mut renderer = renderer(pipeline, "empty", (48, 48), values)?;
        let mut scene = pass_test::rooms::floor_and_wall();
        scene.lights[0].kind = LightKind::Point;
        scene.lights[0].position = Vec3::new(1.2, 1.2, 0.1);
        renderer.set_scene(scene).unwrap();
        done(&mut renderer);
        Some(energy(&renderer.output("indirect").unwrap()))
    };
    // Of 48² pixels, interpolation loses 4 % in the corner.
    let Some(gathered) = energy_by("reflective-shadow-maps", &["divisor=1"]) else { return };
    let truth =
        energy_by("reference", &["samples=512", "filter=centre"]).expect("the adapter is still there");
    let ratio = gathered / truth;
    assert!(truth > 0.0 && (ratio - 1.0).abs() < 0.02, "{ratio} of the energy");
}
