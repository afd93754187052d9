//! Lobes by the pass itself: it is given lights from all sides, or one light with a lobe.

mod cpu_reference;

use cpu_reference::{Model, hemisphere};
use gather_glossy::PASS;
use glam::{DVec3, dvec3};
use interfaces::virtual_lights::{self, VirtualLight, VirtualLobe};
use pass::{Format, ResourceDesc};
use pass_test::view::CAMERA;
use pass_test::{Harness, Outputs, buffer, halves, member};
use std::f64::consts::PI;

pass_test::shaders_are_valid!(PASS);

const INFINITELY_FAR: u32 = 1;

/// What a pixel sees: depth, normal, and reflectance at normal incidence with roughness.
type Seen = (f32, DVec3, [f64; 4]);

const WHITE: [f64; 4] = [1.0, 1.0, 1.0, 0.3];

/// Runs the pass for a row of pixels that look along −z, without visibility.
fn harness(seen: &[Seen], lights: &[VirtualLight], lobes: Option<&[VirtualLobe]>) -> Harness<'static> {
    let picture = |format| ResourceDesc::texture_2d(format, (seen.len() as u32, 1));
    let depth: Vec<f32> = seen.iter().map(|(depth, ..)| *depth).collect();
    let normal: Vec<[u16; 4]> = seen.iter().map(|(_, n, _)| halves([n.x, n.y, n.z, 0.0])).collect();
    let specular: Vec<[u16; 4]> = seen.iter().map(|(.., specular)| halves(*specular)).collect();
    let view = vec![
        member("depth", picture(Format::R32Float), &depth),
        member("normal", picture(Format::Rgba16Float), &normal),
        member("specular", picture(Format::Rgba16Float), &specular),
    ];
    // Room for one light even where there is none.
    let room = virtual_lights::to_bytes(&vec![VirtualLight::default(); lights.len().max(1)]).len();
    let mut given = vec![("", buffer(room as u64), virtual_lights::to_bytes(lights))];
    given.extend(lobes.map(|lobes| member("lobes", buffer(size_of_val(lobes) as u64), lobes)));
    Harness::new(PASS)
        .frame(seen.len() as u32, 1)
        .scene("plane")
        .camera(scene_camera())
        .input("view", "GBuffer", &[], view)
        .input("lights", "VirtualLights", &[("count", lights.len() as u32)], given)
        .set("interleave_x", 1)
        .set("interleave_y", 1)
}

/// So narrow a view that all pixels look along −z.
fn scene_camera() -> scene::Camera {
    scene::Camera { vertical_fov: 1e-4, ..CAMERA }
}

fn of_model(harness: Harness<'static>, model: Model) -> Harness<'static> {
    let harness = harness.set("model", model.name());
    match model {
        Model::Ggx(_) => harness,
        Model::Phong(n) | Model::Blinn(n) => harness.set("exponent", n as f32),
    }
}

fn read(outputs: &Outputs, name: &str) -> Vec<[f32; 4]> {
    outputs.read(name)
}

/// Lights infinitely far from all over the hemisphere above a normal, of 1 W/(m² sr).
fn sky(normal: DVec3, rings: u32, sides: u32) -> Vec<VirtualLight> {
    let irradiance = (2.0 * PI / f64::from(rings * sides)) as f32;
    let light = |from: DVec3| VirtualLight {
        normal: (-from).as_vec3().to_array(),
        flux: [irradiance; 3],
        kind: INFINITELY_FAR,
        ..VirtualLight::default()
    };
    hemisphere(normal, rings, sides).map(light).collect()
}

fn tilted(degrees: f64) -> DVec3 {
    let (sin, cos) = degrees.to_radians().sin_cos();
    dvec3(sin, 0.0, cos)
}

/// Directional albedos that the pass computes of a white surface, tilted by these angles from the camera.
fn albedo(model: Model, degrees: f64, (rings, sides): (u32, u32)) -> Option<f64> {
    let normal = tilted(degrees);
    let roughness = if let Model::Ggx(roughness) = model { roughness } else { 0.5 };
    let seen = [(2.0, normal, [1.0, 1.0, 1.0, roughness])];
    let outputs = of_model(harness(&seen, &sky(normal, rings, sides), None), model).run()?;
    Some(f64::from(read(&outputs, "reflected")[0][0]))
}

/// A lobe reflects what its reflectance says at normal incidence, whatever its exponent; seen at an angle, no more, and what its
/// definition says.
#[test]
fn the_integral_of_a_lobe_is_its_reflectance() {
    let exponents = [0.0, 0.5, 1.0, 2.0, 7.0, 20.0, 50.0];
    let models = exponents.into_iter().flat_map(|n| [Model::Phong(n), Model::Blinn(n)]);
    for model in models {
        let Some(found) = albedo(model, 0.0, (1024, 8)) else { return };
        assert!((found - 1.0).abs() < 2e-3, "{model:?} reflects {found} of what comes from all sides");
    }
    // ∫ μ / (1 + μ) dμ: microfacets of roughness 1 reflect 1 − ln 2, and smooth ones all but nothing less than 1.
    for (roughness, wanted, tolerance) in [(1.0, 1.0 - 2f64.ln(), 1e-4), (0.3, 1.0, 0.01)] {
        let found = albedo(Model::Ggx(roughness), 0.0, (1024, 8)).expect("the adapter is still there");
        assert!((found - wanted).abs() < tolerance, "roughness {roughness}: {found} for {wanted}");
    }
    for model in
        [Model::Phong(0.0), Model::Phong(20.0), Model::Blinn(0.0), Model::Blinn(20.0), Model::Ggx(0.5)]
    {
        for degrees in [30.0, 70.0] {
            let normal = tilted(degrees);
            let directions = 512.0 * 512.0;
            let term = |from: DVec3| model.lobe(normal, from, DVec3::Z) * normal.dot(from);
            let wanted = hemisphere(normal, 512, 512).map(term).sum::<f64>() * 2.0 * PI / directions;
            let found = albedo(model, degrees, (96, 96)).expect("the adapter is still there");
            // Half floats turn the normal by up to 3e-4.
            assert!(
                (found - wanted).abs() < 4e-3 && found < 1.001,
                "{model:?} at {degrees}°: {found} for {wanted}"
            );
        }
    }
}

/// A light with a lobe at the origin, which reflects towards the pixels what came from `incoming`.
fn glossy_light(incoming: DVec3, roughness: f64) -> (VirtualLight, VirtualLobe) {
    let light = VirtualLight { normal: [0.0, 0.0, -1.0], flux: [0.0; 3], ..VirtualLight::default() };
    let lobe = VirtualLobe {
        incoming: incoming.as_vec3().to_array(),
        roughness: roughness as f32,
        flux: [3.0; 3],
        f0: [1.0; 3],
        ..VirtualLobe::default()
    };
    (light, lobe)
}

/// The irradiance at a pixel before the light, and what the pixel reflects of it: both by lobes.
#[test]
fn lights_and_pixels_reflect_by_their_lobes() {
    let incoming = dvec3(-0.4, 0.1, -1.0).normalize();
    for model in
        [Model::Phong(1.0), Model::Phong(50.0), Model::Blinn(1.0), Model::Blinn(50.0), Model::Ggx(0.4)]
    {
        let (mut light, lobe) = glossy_light(incoming, 0.4);
        light.position = [-1.0, 0.0, 0.0];
        let seen = [(2.0, DVec3::Z, [1.0, 1.0, 1.0, 0.4])];
        let Some(outputs) = of_model(harness(&seen, &[light], Some(&[lobe])), model).run() else { return };
        let offset = dvec3(1.0, 0.0, -2.0);
        let (d2, way) = (offset.length_squared(), offset.normalize());
        // Both cosines are those of the way to the axis.
        let cosine = -way.z;
        let wanted = 3.0 * model.lobe(DVec3::NEG_Z, incoming, way) * cosine * cosine / d2;
        let found = f64::from(read(&outputs, "irradiance")[0][0]);
        assert!(wanted > 1e-4 && (found / wanted - 1.0).abs() < 1e-3, "{model:?}: {found} for {wanted}");
        let wanted = wanted * model.lobe(DVec3::Z, -way, DVec3::Z);
        let found = f64::from(read(&outputs, "reflected")[0][0]);
        assert!((found / wanted - 1.0).abs() < 2e-3, "{model:?}: {found} for {wanted} reflected");
    }
}

/// A lobe reflects as much from one direction into another as from that into the first.
#[test]
fn lobes_are_reciprocal() {
    let (a, b) = (dvec3(0.6, 0.2, -1.0).normalize(), dvec3(-0.3, 0.5, -1.0).normalize());
    for model in [Model::Phong(20.0), Model::Blinn(20.0), Model::Ggx(0.3), Model::Ggx(0.9)] {
        let roughness = if let Model::Ggx(roughness) = model { roughness } else { 0.5 };
        let intensity = |from: DVec3, to: DVec3| {
            let (mut light, lobe) = glossy_light(from, roughness);
            light.position = (dvec3(0.0, 0.0, -2.0) - to).as_vec3().to_array();
            let seen = [(2.0, DVec3::Z, [0.0; 4])];
            let outputs = of_model(harness(&seen, &[light], Some(&[lobe])), model).run()?;
            // Irradiance over both cosines, which are the same.
            Some(f64::from(read(&outputs, "irradiance")[0][0]) / (to.z * to.z))
        };
        let (Some(there), Some(back)) = (intensity(a, b), intensity(b, a)) else { return };
        assert!(there > 0.0 && (there / back - 1.0).abs() < 1e-4, "{model:?}: {there} and {back}");
    }
}

/// Lights that stand for an area widen lobes, which reflect as much all the same.
#[test]
fn widened_lobes_are_bounded_by_the_area_of_lights_and_reflect_as_much() {
    let mirror = [1.0, 1.0, 1.0, 0.0];
    let light = |area: f32| VirtualLight {
        position: [0.0, 0.0, 0.0],
        normal: [0.0, 0.0, -1.0],
        flux: [1.0; 3],
        area,
        ..VirtualLight::default()
    };
    let shown = |area: f32, widening: f32| {
        let seen = [(2.0, DVec3::Z, mirror)];
        let outputs = harness(&seen, &[light(area)], None).set("widening", widening).run()?;
        Some(f64::from(read(&outputs, "reflected")[0][0]))
    };
    // A mirror shows a disc of 0.1 m² that emits 1 W with the radiance 1 / (π 0.1).
    let Some(found) = shown(0.1, 1.0) else { return };
    let wanted = 1.0 / (PI * 0.1);
    assert!((found / wanted - 1.0).abs() < 0.02, "{found} for {wanted}");
    let (sharp, point) = (shown(0.1, 0.0).unwrap(), shown(0.0, 1.0).unwrap());
    assert!((sharp / point - 1.0).abs() < 1e-3, "{sharp} without widening, {point} of a point");
    assert!(point > 1e3 * found && point < 1e6, "{point}: bounded, although a mirror");
}

/// Whatever is given, what is computed is finite and not negative.
#[test]
fn extremes_stay_finite() {
    let (light, lobe) = glossy_light(dvec3(0.0, 0.0, -1.0), 0.0);
    let at = |position: [f32; 3]| VirtualLight { position, flux: [1e20; 3], ..light };
    let lobes = [VirtualLobe { flux: [1e20; 3], ..lobe }, VirtualLobe { incoming: [0.0, 0.0, 1.0], ..lobe }];
    let mirror = [1.0, 0.5, 0.0, 0.0];
    let grazing = tilted(89.99);
    let seen =
        [(2.0, DVec3::Z, mirror), (2.0, grazing, mirror), (2.0, -DVec3::Z, mirror), (0.0, DVec3::Z, mirror)];
    for model in [Model::Ggx(0.0), Model::Phong(0.0), Model::Phong(1e5), Model::Blinn(0.0), Model::Blinn(1e5)]
    {
        for lights in [vec![at([0.0; 3]), at([0.0, 0.0, -2.0])], vec![at([0.0, 0.0, -3.0]); 2], Vec::new()] {
            let harness = harness(&seen, &lights, Some(&lobes[..lights.len().max(1)]));
            let Some(outputs) = of_model(harness, model).run() else { return };
            for output in ["irradiance", "reflected"] {
                for value in read(&outputs, output).into_iter().flatten() {
                    assert!(value.is_finite() && value >= 0.0, "{model:?}: {value} of {output}, {lights:?}");
                }
            }
            let reflected = read(&outputs, "reflected");
            let alpha: Vec<f32> = reflected.iter().map(|texel| texel[3]).collect();
            assert_eq!(alpha, [1.0, 1.0, 1.0, 0.0], "alpha says where something is seen");
            if lights.is_empty() {
                assert!(reflected.iter().all(|[r, g, b, _]| [*r, *g, *b] == [0.0; 3]), "no lights, no light");
            }
        }
    }
}

/// Without lobes, irradiance is what lights send diffusely, and a surface without specular reflectance reflects nothing here.
#[test]
fn matte_surfaces_have_the_irradiance_alone() {
    let light = VirtualLight { normal: [0.0, 0.0, -1.0], flux: [5.0; 3], ..VirtualLight::default() };
    let seen = [(2.0, DVec3::Z, [0.0, 0.0, 0.0, 0.3]), (2.0, DVec3::Z, WHITE)];
    let Some(outputs) = harness(&seen, &[light], None).run() else { return };
    let irradiance = read(&outputs, "irradiance");
    assert!((f64::from(irradiance[0][0]) / (5.0 / (4.0 * PI)) - 1.0).abs() < 1e-5, "{irradiance:?}");
    assert_eq!(irradiance[0], irradiance[1]);
    let reflected = read(&outputs, "reflected");
    assert_eq!(reflected[0], [0.0, 0.0, 0.0, 1.0]);
    assert!(reflected[1][0] > 0.0);
}
