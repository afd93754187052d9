//! A wall that moves over the image, beside what was seen of it in the frame before.

use glam::{Vec2, Vec3, vec2, vec3};
use pass::Format;
use pass_test::view::picture;
use pass_test::{Harness, Member, Outputs, halves};
use scene::Camera;

const SIDE: usize = 8;
const DEPTH: f32 = 2.0;

/// At the origin, looking along -z, with a field of view of 90°.
fn camera() -> Camera {
    let (position, target, vertical_fov) = (Vec3::ZERO, Vec3::NEG_Z, std::f32::consts::FRAC_PI_2);
    Camera { position, target, up: Vec3::Y, vertical_fov, near: 1e-3 }
}

/// What a pixel of a wall of some depth shows.
fn position(x: usize, y: usize, depth: f32) -> Vec3 {
    let ndc = (vec2(x as f32, y as f32) + 0.5) / SIDE as f32 * 2.0 - 1.0;
    vec3(ndc.x, -ndc.y, -1.0) * depth
}

/// A picture of the frame's size.
fn texture<T: bytemuck::NoUninit>(name: &str, format: Format, of: impl Fn(usize, usize) -> T) -> Member<'_> {
    picture(name, format, (SIDE as u32, SIDE as u32), |x, y| of(x as usize, y as usize))
}

fn unit(normal: Vec3) -> [u16; 4] {
    halves(normal.extend(0.0).as_dvec4().to_array())
}

/// The wall moves. Of what was seen in the frame before, column 5 had nothing, column 6 a wall behind, and column 3 one that faced
/// another way.
fn run(motion: Vec2) -> Option<Outputs> {
    let depth_before = |x: usize| match x {
        5 => 0.0,
        6 => 1.5 * DEPTH,
        _ => DEPTH,
    };
    let normal_before = |x: usize| if x == 3 { Vec3::X } else { Vec3::Z };
    let seen = |x, y| position(x, y, depth_before(x)).extend(depth_before(x)).to_array();
    Harness::new(reproject::PASS)
        .frame(SIDE as u32, SIDE as u32)
        .camera(camera())
        .input(
            "view",
            "GBuffer",
            &[],
            vec![
                texture("depth", Format::R32Float, |_, _| DEPTH),
                texture("normal", Format::Rgba16Float, |_, _| unit(Vec3::Z)),
                texture("motion", Format::Rg32Float, |_, _| motion.to_array()),
            ],
        )
        .past(
            "past",
            "SeenSurfaces",
            1,
            vec![
                texture("position", Format::Rgba32Float, seen),
                texture("normal", Format::Rgba16Float, |x, _| unit(normal_before(x))),
            ],
        )
        .run()
}

fn found(outputs: &Outputs, port: &str) -> (Vec<[f32; 2]>, Vec<u32>) {
    (outputs.read(&format!("{port}.place")), outputs.read(&format!("{port}.texels")))
}

#[test]
fn a_texel_counts_where_it_showed_the_surface() {
    let Some(outputs) = run(vec2(1.0, 0.0)) else { return };
    let (places, texels) = found(&outputs, "picture");
    let was_there = |x: usize| x < SIDE && ![3, 5, 6].contains(&x);
    for y in 0..SIDE {
        for x in 0..SIDE {
            let i = y * SIDE + x;
            assert_eq!(places[i], [x as f32 + 1.5, y as f32 + 0.5]);
            assert_eq!(texels[i] & 1 != 0, was_there(x + 1), "({x}, {y}): {:b}", texels[i]);
            assert_eq!(texels[i] & 8 != 0, was_there(x + 2) && y + 1 < SIDE, "({x}, {y}): {:b}", texels[i]);
        }
    }
}

/// Where the texel at the place showed something else, one beside it takes its place; where none did, there is none.
#[test]
fn a_surface_goes_on_from_beside_its_place() {
    let Some(outputs) = run(vec2(1.0, 0.0)) else { return };
    let (places, texels) = found(&outputs, "surface");
    for (x, taken) in [1, 2, 2, 4, 4, 7, 7].into_iter().enumerate() {
        let i = 3 * SIDE + x;
        assert!(texels[i] & 1 != 0, "{x}: {:b}", texels[i]);
        assert_eq!(places[i][0], taken as f32 + 0.5, "{x}");
    }
    let Some(outputs) = run(vec2(20.0, 0.0)) else { return };
    assert!(found(&outputs, "surface").1.iter().all(|texels| *texels == 0), "all has come into view");
}

/// In the first frame nothing was there.
#[test]
fn without_a_past_nothing_counts() {
    let view = vec![
        texture("depth", Format::R32Float, |_, _| DEPTH),
        texture("normal", Format::Rgba16Float, |_, _| unit(Vec3::Z)),
    ];
    let harness = Harness::new(reproject::PASS).frame(SIDE as u32, SIDE as u32).camera(camera());
    let Some(outputs) = harness.input("view", "GBuffer", &[], view).run() else { return };
    for port in ["surface", "picture"] {
        assert!(found(&outputs, port).1.iter().all(|texels| *texels == 0));
    }
    let seen: Vec<[f32; 4]> = outputs.read("seen.position");
    for (i, [x, y, z, depth]) in seen.into_iter().enumerate() {
        assert!(vec3(x, y, z).distance(position(i % SIDE, i / SIDE, DEPTH)) < 1e-5 && depth == DEPTH);
    }
}
