//! Uniform sampling: every texel alike, and the flux of the map.

mod cpu_reference;

use glam::{Vec3, vec3};
use interfaces::virtual_lights::{VirtualLight, VirtualLobe};
use pass::{Format, ResourceDesc};
use pass_test::{Harness, RsmTexel, member, random};
use sample_uniform::PASS;
use scene::{Light, LightKind};

const SIZE: (u32, u32) = (16, 10);

pass_test::shaders_are_valid!(PASS);

#[test]
fn every_texel_is_drawn_alike() {
    for layers in [1, 2, 6] {
        let texels = SIZE.0 * SIZE.1 * layers;
        let mut seen = vec![0_u32; texels as usize];
        for i in 0..100 * texels {
            let (layer, x, y) = cpu_reference::texel(random::halton3(i + 1, 3), SIZE, layers);
            seen[((layer * SIZE.1 + y) * SIZE.0 + x) as usize] += 1;
        }
        // A sequence of low discrepancy: far within the ±30 of independent numbers.
        assert!(seen.iter().all(|n| n.abs_diff(100) <= 15), "{layers} layers: {seen:?}");
    }
}

#[test]
fn numbers_next_to_one_stay_in_the_map() {
    assert_eq!(cpu_reference::texel([1.0_f64.next_down(); 3], SIZE, 6), (5, SIZE.0 - 1, SIZE.1 - 1));
    assert_eq!(cpu_reference::texel([1.0; 3], (1, 1), 1), (0, 0, 0));
}

#[test]
fn virtual_lights_carry_the_flux_of_the_map() {
    const COUNT: u32 = 4096;
    for layers in [1, 2, 6] {
        let texels = SIZE.0 * SIZE.1 * layers;
        let flux = |i: u32| random::unit_float(random::hash(i)).powi(4);
        let reflected: f64 = (0..texels).map(flux).sum();
        let second_moment = f64::from(texels) * (0..texels).map(|i| flux(i).powi(2)).sum::<f64>();
        let deviation = ((second_moment - reflected * reflected) / f64::from(COUNT)).sqrt();
        for seed in [0, 9] {
            let carried: f64 = (0..COUNT)
                .map(|i| {
                    let (layer, x, y) = cpu_reference::texel(random::halton3(i + 1, seed), SIZE, layers);
                    flux((layer * SIZE.1 + y) * SIZE.0 + x) * cpu_reference::weight(SIZE, layers, COUNT)
                })
                .sum();
            let error = (carried - reflected).abs();
            assert!(error < 4.0 * deviation, "{layers} layers, seed {seed}: {error} of {deviation}");
        }
    }
}

/// Lights sampled from a map whose texel i lies at (i, 0, 0), is 2 m² and reflects (1, g(i), 0) W; every third saw nothing.
fn draw(size: (u32, u32), layers: u32, count: u32, seed: u32) -> Option<Vec<VirtualLight>> {
    let texel = |i: u32| match i % 3 {
        0 => RsmTexel::default(),
        _ => RsmTexel {
            position: [i as f32, 0.0, 0.0, 1.0],
            normal: [0.0, 0.6, 0.8],
            flux: [1.0, green(i) as f32, 0.0, 2.0],
        },
    };
    let texels: Vec<RsmTexel> = (0..size.0 * size.1 * layers).map(texel).collect();
    Some(Harness::new(PASS).set("count", count).seed(seed).rsm(size, &texels).run()?.lights("lights"))
}

fn green(texel: u32) -> f64 {
    random::unit_float(random::hash(texel)).powi(4)
}

#[test]
fn lights_are_those_of_the_cpu_reference_and_carry_the_flux_of_the_map() {
    const COUNT: u32 = 4096;
    for layers in [1, 2, 6] {
        for seed in [0, 4] {
            let Some(lights) = draw(SIZE, layers, COUNT, seed) else { return };
            assert_eq!(lights.len(), COUNT as usize);
            let weight = cpu_reference::weight(SIZE, layers, COUNT) as f32;
            let mut elsewhere = 0;
            for (j, light) in (0..).zip(&lights) {
                let numbers = random::halton3(j + 1, pass::pass_seed(seed, "sample-uniform"));
                let (layer, x, y) = cpu_reference::texel(numbers, SIZE, layers);
                elsewhere += u32::from(light.texel != (layer * SIZE.1 + y) * SIZE.0 + x);
                let texel = light.texel;
                if texel.is_multiple_of(3) {
                    let dark = VirtualLight { normal: [0.0, 0.0, 1.0], texel, ..VirtualLight::default() };
                    assert_eq!(*light, dark);
                } else {
                    assert_eq!(light.position, [texel as f32, 0.0, 0.0]);
                    assert!((light.flux[0] / weight - 1.0).abs() < 1e-6, "{light:?}");
                    assert!((light.area / weight - 2.0).abs() < 2e-6, "{light:?}");
                }
            }
            // A number within rounding of a texel's edge may fall to either side.
            assert!(elsewhere <= 2, "{elsewhere} lights are at another texel");

            let texels = SIZE.0 * SIZE.1 * layers;
            let seen = || (0..texels).filter(|i| !i.is_multiple_of(3)).map(green);
            let reflected: f64 = seen().sum();
            let second_moment = f64::from(texels) * seen().map(|flux| flux * flux).sum::<f64>();
            let deviation = ((second_moment - reflected * reflected) / f64::from(COUNT)).sqrt();
            let carried: f64 = lights.iter().map(|light| f64::from(light.flux[1])).sum();
            let error = (carried - reflected).abs();
            assert!(error < 4.0 * deviation, "{layers} layers, seed {seed}: {error} of {deviation}");
        }
    }
}

#[test]
fn one_texel_and_one_light() {
    let Some(dark) = draw((1, 1), 1, 1, 0) else { return };
    assert_eq!((dark.len(), dark[0].flux), (1, [0.0; 3]));
    // More lights than texels: of two, the second saw something.
    let two = draw((2, 1), 1, 100, 0).unwrap_or_default();
    let carried: f32 = two.iter().map(|light| light.flux[0]).sum();
    assert!((carried - 1.0).abs() < 0.05, "{carried} of 1 W");
}

/// The surface that a light of the scene sees in its layer of maps of 4×4 texels, in one near the middle: position, flux and area.
struct Seen {
    layer: u32,
    position: Vec3,
    flux: f32,
    area: f32,
}

impl Seen {
    /// Index of the texel.
    fn texel(&self) -> u32 {
        self.layer * 16 + 6
    }
}

/// Two point lights see the same floor, which a third one does not see for what hangs above it. The floor that the second
/// sees is so near to the border of the first one's texel that another scale of the map would miss it.
const SEEN: [Seen; 3] = [
    Seen { layer: 5, position: vec3(0.45, 0.45, 0.0), flux: 2.0, area: 0.5 },
    Seen { layer: 11, position: vec3(0.47, 0.46, 0.0), flux: 3.0, area: 0.25 },
    Seen { layer: 17, position: vec3(0.1, 0.05, 2.5), flux: 7.0, area: 1.0 },
];

/// A surface that several lights see is shared by the virtual lights of their layers: by radiosity, 4 and 12 W/m². It is the
/// same where it lies within a quarter of a texel's side, here 0.177 m, of the plane, and is turned by up to 60°.
#[test]
fn what_several_lights_see_is_shared_by_radiosity() {
    const COUNT: u32 = 8192;
    let (size, layers) = ((4, 4), 18);
    let mut scene = pass_test::scene("plane");
    let point = |z| Light { kind: LightKind::Point, position: vec3(0.0, 0.0, z), ..scene.lights[0].clone() };
    scene.lights = [1.0, 2.0, 3.0].map(point).to_vec();
    let weight = cpu_reference::weight(size, layers, COUNT) as f32;
    let cases =
        [(0.0, 1.0, true), (0.17, 1.0, true), (0.19, 1.0, false), (0.0, 0.55, true), (0.0, 0.45, false)];
    for (above, cosine, is_same) in cases {
        let mut texels = vec![RsmTexel::default(); (size.0 * size.1 * layers) as usize];
        for (i, seen) in SEEN.iter().enumerate() {
            // Raised towards the first light, it is seen at the same place.
            let (up, cosine): (f32, f32) = if i == 1 { (above, cosine) } else { (0.0, 1.0) };
            let position =
                vec3(seen.position.x * (1.0 - up), seen.position.y * (1.0 - up), seen.position.z + up);
            texels[seen.texel() as usize] = RsmTexel {
                position: position.extend(1.0).to_array(),
                normal: [0.0, (1.0 - cosine * cosine).sqrt(), cosine],
                flux: [seen.flux, seen.flux, seen.flux, seen.area],
            };
        }
        let harness = Harness::new(PASS).with_scene(scene.clone()).set("count", COUNT);
        let Some(outputs) = harness.rsm(size, &texels).run() else { return };
        let lights = outputs.lights("lights");
        let shares = if is_same { [0.25, 0.75, 1.0] } else { [1.0; 3] };
        for (seen, share) in SEEN.iter().zip(shares) {
            let of_texel = lights.iter().filter(|light| light.texel == seen.texel());
            let mut areas = of_texel.map(|light| light.area).peekable();
            assert!(areas.peek().is_some(), "layer {} has no virtual light", seen.layer);
            let expected = weight * seen.area * share;
            assert!(
                areas.all(|area| (area / expected - 1.0).abs() < 1e-5),
                "layer {}, {above} m above, turned by the cosine {cosine}: {expected} m²",
                seen.layer
            );
        }
    }
}

/// Each light has the lobe of its own texel, and a surface that reflects nothing diffusely is lit all the same.
#[test]
fn lights_have_the_lobes_of_their_texels() {
    const COUNT: u32 = 500;
    let size = (4, 4);
    // Every fourth texel reflects nothing specularly.
    let specular = |i: u32| match i % 4 {
        3 => [0.0, 0.0, 0.0, 1.0],
        _ => [0.02 * i as f32 + 0.1, 0.0, 0.5, 0.05 * i as f32 + 0.1],
    };
    let desc = ResourceDesc::texture_2d_array(Format::Rgba32Float, size, 1);
    let texels =
        |name, of: &dyn Fn(u32) -> [f32; 4]| member(name, desc.clone(), &(0..16).map(of).collect::<Vec<_>>());
    let rsm = vec![
        texels("position", &|i| [0.01 * i as f32, 0.0, 0.0, 1.0]),
        texels("normal", &|_| [0.0, 1.0, 0.0, 0.0]),
        texels("flux", &|_| [0.0, 0.0, 0.0, 1.0]),
        texels("specular", &specular),
    ];
    let harness = Harness::new(PASS).scene("plane").set("count", COUNT).set("lobes", true);
    let Some(outputs) = harness.input("rsm", "ReflectiveShadowMap", &[], rsm).run() else { return };
    let (lights, lobes) = (outputs.lights("lights"), outputs.read::<VirtualLobe>("lights.lobes"));
    assert_eq!(lobes.len(), COUNT as usize);
    let mut lit = 0;
    for (light, lobe) in lights.iter().zip(lobes) {
        let [r, g, b, roughness] = specular(light.texel);
        assert_eq!((lobe.f0, lobe.roughness), ([r, g, b], roughness), "{light:?}");
        // Corners of the map are outside the spot's cone.
        assert!(lobe.flux[0] == 0.0 || r > 0.0, "{lobe:?}");
        assert_eq!(light.flux[0] > 0.0, lobe.flux[0] > 0.0, "{light:?}");
        lit += u32::from(lobe.flux[0] > 0.0);
    }
    assert!(lit > COUNT / 4, "{lit} lights have lobes");
}
