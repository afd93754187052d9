//! Scenes that light from infinitely far lights, against closed forms.

use crate::adapter::{done, mean, renderer, shown};
use crate::program::Folder;
use glam::{DVec3, dvec3};
use metrics::Image;
use renderer::Renderer;
use scene::{Environment, Scene};
use std::f64::consts::PI;

const SIZE: (u32, u32) = (24, 18);

/// A map that is dim, but for a texel of 10⁵, turned by an angle.
fn with_a_bright_texel() -> Environment {
    let mut texels = vec![[1.0, 2.0, 0.5]; 16 * 8];
    texels[2 * 16 + 11] = [1e5; 3];
    Environment { width: 16, height: 8, texels, rotation: 0.7 }
}

/// Radiance from a direction, by what `Environment` says of its map.
fn radiance(environment: &Environment, direction: DVec3) -> [f64; 3] {
    let turned = glam::DQuat::from_rotation_y(-f64::from(environment.rotation)) * direction;
    let (width, height) = (f64::from(environment.width), f64::from(environment.height));
    let x = (turned.x.atan2(-turned.z) / (2.0 * PI) + 0.5) * width;
    let y = turned.y.acos() / PI * height;
    let (x, y) = ((x as u32).min(environment.width - 1), (y as u32).min(environment.height - 1));
    environment.texels[(y * environment.width + x) as usize].map(f64::from)
}

/// Irradiance of a plane that faces up, by the midpoints of many directions.
fn irradiance(environment: &Environment) -> [f64; 3] {
    let (rows, columns) = (512, 2048);
    let mut sum = [0.0; 3];
    for (row, column) in (0..rows).flat_map(|row| (0..columns).map(move |column| (row, column))) {
        // Even in the squared sine, and so by the cosine.
        let level = ((f64::from(row) + 0.5) / f64::from(rows)).sqrt();
        let (sine, cosine) = (2.0 * PI * (f64::from(column) + 0.5) / f64::from(columns)).sin_cos();
        let direction = dvec3(level * sine, (1.0 - level * level).sqrt(), level * cosine);
        let found = radiance(environment, direction);
        (0..3).for_each(|c| sum[c] += PI * found[c] / f64::from(rows * columns));
    }
    sum
}

/// The scene `plane` without its light, under an environment.
fn plane_under(renderer: &Renderer, environment: Environment) -> Scene {
    let mut scene = renderer.scene().clone();
    scene.lights.clear();
    scene.environment = Some(environment);
    scene
}

/// Asserts that the pixels which see the plane reflect half of an irradiance, and that the others show the sky.
fn assert_lit(image: &Image, direct: &Image, irradiance: [f64; 3], most: f64) {
    let mut mean = [0.0; 3];
    let mut count = 0.0;
    for (pixel, lit) in image.pixels().iter().zip(direct.pixels()) {
        if lit[3] == 0.0 {
            assert!(pixel[0] > 0.0 && lit[..3] == [0.0; 3], "the sky is seen, and is no reflected light");
            continue;
        }
        count += 1.0;
        (0..3).for_each(|c| mean[c] += f64::from(lit[c]));
    }
    assert!(count > 50.0 && count < f64::from(SIZE.0 * SIZE.1));
    for c in 0..3 {
        let expected = 0.5 * irradiance[c] / PI;
        let found = mean[c] / count;
        assert!((found / expected - 1.0).abs() < most, "channel {c}: {found}, not {expected}");
    }
}

#[test]
fn paths_find_the_light_of_a_sky() {
    let values = ["samples=64", "filter=centre"];
    let Some(mut renderer) = renderer("reference", "plane", SIZE, &values) else { return };
    let uniform = Environment::uniform([1.0, 2.0, 0.5]);
    let bright = with_a_bright_texel();
    for (sky, expected, most) in
        [(uniform, [PI, 2.0 * PI, 0.5 * PI], 2e-3), (bright.clone(), irradiance(&bright), 0.01)]
    {
        let scene = plane_under(&renderer, sky);
        renderer.set_scene(scene).unwrap();
        done(&mut renderer);
        let [image, direct] = ["image", "direct"].map(|name| renderer.output(name).unwrap());
        assert_lit(&image, &direct, expected, most);
    }
    // A black one is none.
    let scene = plane_under(&renderer, Environment::uniform([0.0; 3]));
    renderer.set_scene(scene).unwrap();
    done(&mut renderer);
    assert!(renderer.output("image").unwrap().pixels().iter().all(|pixel| pixel[..3] == [0.0; 3]));
}

/// Walls that reflect half and emit ½ see as much wherever they look, and the hole between them shows: 1.
#[test]
fn a_box_that_is_open_to_a_sky_is_a_furnace() {
    let values = ["samples=64", "bounces=12", "filter=centre"];
    let Some(mut renderer) = renderer("reference", "cornell-box", SIZE, &values) else { return };
    let mut scene = renderer.scene().clone();
    scene.lights.clear();
    scene.environment = Some(Environment::uniform([1.0; 3]));
    for material in &mut scene.materials {
        material.base_color = glam::Vec4::new(0.5, 0.5, 0.5, 1.0);
        material.emission = glam::Vec3::splat(0.5);
    }
    renderer.set_scene(scene).unwrap();
    done(&mut renderer);
    let image = renderer.output("image").unwrap();
    let off = |pixel: &[f32; 4]| (pixel[0] - 1.0).abs();
    let greatest = image.pixels().iter().map(off).fold(0.0, f32::max);
    assert!(greatest < 0.05, "{greatest} in a pixel of 64 samples");
    let [_, mean, _] = mean(&image);
    assert!((mean - 1.0).abs() < 2e-3, "{mean}");
}

/// A pipeline whose lights are those of the sky alone, all of them gathered at each pixel.
fn lit_by_sky(shadows: &str, passes: &str) -> String {
    format!(
        r#"Pipeline(
            about: "The sky alone",
            passes: {{
                "view": Pass(kind: "gbuffer"),
                "sky": Pass(kind: "environment-lights", set: {{ "count": 256 }}),
                {passes}
                "gather": Pass(
                    kind: "gather",
                    in: {{ "view": "view", "lights": "sky", "visibility": "{shadows}" }},
                    set: {{ "interleave_x": 1, "interleave_y": 1 }},
                ),
                "image": Pass(kind: "composite", in: {{ "view": "view", "indirect": "gather" }}),
            }},
            outputs: {{ "image": "image.indirect_radiance" }},
        )"#
    )
}

/// A ball above a floor, from a side, under a sky whose sun is a tenth of its light.
const BALL: &str = r#"Scene(
    about: "A ball on a floor",
    geometry: Objects([
        Object(name: "floor", geometry: BuiltIn("plane")),
        Object(name: "ball", geometry: BuiltIn("sphere"),
            transform: Transform(translate: (0.1, 0.5, 0.0), scale: (0.3, 0.3, 0.3))),
    ]),
    camera: Camera(position: (0.0, 1.5, 2.0), target: (0.0, 0.2, 0.0), vertical_fov_deg: 45),
    environment: Environment(map: BuiltIn("sky"), rotation_deg: 40),
)"#;

/// Exact maps of lights infinitely far show what rays find, but for pixels at the edges of shadows; imperfect maps have their energy.
#[test]
fn maps_of_skies_converge_to_rays() {
    let folder = Folder::new(&[]);
    folder.write("ball.ron", BALL);
    let exact =
        r#""maps": Pass(kind: "paraboloid-shadow-maps", in: { "lights": "sky" }, set: { "map": 256 }),"#;
    let imperfect = |points: u32| {
        format!(
            r#""maps": Sub(
                file: "parts/imperfect-shadow-maps.ron",
                in: {{ "lights": "sky" }},
                set: {{ "map": 128, "points_per_map": {points}, "points": 262144 }},
            ),"#
        )
    };
    let rays = r#""maps": Pass(kind: "visibility-ray-traced", in: { "lights": "sky" }),"#;
    let picture = |name: &str, passes: &str| {
        folder.write(&format!("{name}.ron"), &lit_by_sky("maps", passes));
        let at = |file: &str| folder.at(file).display().to_string();
        let mut renderer = renderer(&at(&format!("{name}.ron")), &at("ball.ron"), (48, 36), &[])?;
        Some(shown(&mut renderer, "image"))
    };
    let Some(truth) = picture("rays", rays) else { return };
    let energy = |image: &Image| mean(image)[1] / mean(&truth)[1];
    let [exact, few, many] =
        [("exact", exact.to_owned()), ("few", imperfect(1000)), ("many", imperfect(16000))]
            .map(|(name, passes)| picture(name, &passes).expect("the adapter is still there"));
    assert!((energy(&exact) - 1.0).abs() < 2e-3, "{}", energy(&exact));
    assert!((energy(&many) - 1.0).abs() < 0.01, "{}", energy(&many));
    let whole = mean(&truth)[1];
    let off = |image: &Image| {
        let pairs = image.pixels().iter().zip(truth.pixels());
        let far = pairs.filter(|(a, b)| f64::from((a[1] - b[1]).abs()) > 0.05 * whole).count();
        far as f64 / image.pixels().len() as f64
    };
    let [exact, few, many] = [exact, few, many].map(|image| off(&image));
    assert!(
        exact < 0.01 && many < 0.5 * few,
        "{exact}, and with few and many points {few} and {many} of the pixels"
    );
}

/// The shipped pipeline has the energy of path tracing under a sky with a sun.
#[test]
fn direct_light_of_a_sky_has_the_energy_of_path_tracing() {
    let folder = Folder::new(&[]);
    folder.write("ball.ron", BALL);
    let scene = folder.at("ball.ron").display().to_string();
    let Some(mut truth) = renderer("reference", &scene, (48, 36), &["samples=512", "filter=centre"]) else {
        return;
    };
    done(&mut truth);
    let truth = mean(&truth.output("direct").unwrap());
    let mut renderer =
        renderer("ism-environment", &scene, (48, 36), &["lights=512", "map=128", "points_per_map=4000"])
            .expect("the adapter is still there");
    let found = mean(&shown(&mut renderer, "direct"));
    for c in 0..3 {
        let energy = found[c] / truth[c];
        assert!((energy - 1.0).abs() < 0.03, "channel {c}: {energy}");
    }
}
