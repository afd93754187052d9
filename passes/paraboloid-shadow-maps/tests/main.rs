//! Exact maps against rays.

mod cpu_reference;

use cpu_reference::{hit, image_bounds, map};
use frame_graph::Source;
use glam::{DMat3, DVec2, DVec3, dvec3, uvec2};
use gpu_algorithms::reference::paraboloid::{direction_from_paraboloid, frame_from_normal, texel_centre};
use interfaces::stands::Stand;
use interfaces::virtual_lights::VirtualLight;
use interfaces::visibility::AtlasLayout;
use paraboloid_shadow_maps::ParaboloidShadowMaps;
use pass::{Format, ResourceDesc};
use pass_test::{Harness, elements, light_at, member};
use scene::{Scene, Vertex};
use std::f64::consts::PI;
use std::sync::Arc;

/// The ways in which maps are rendered.
const METHODS: [&str; 2] = ["rasterised", "traced"];

/// Diagonal of the scene `plane`, a square of 2 m: the extent that all scenes here have.
const EXTENT: f64 = 2.828_427_124_746_19;

struct NoFiles;

impl frame_graph::Files for NoFiles {
    fn read(&self, _: &str) -> Option<Arc<Source>> {
        None
    }

    fn list(&self) -> Vec<String> {
        Vec::new()
    }
}

impl scene::SceneFiles for NoFiles {}

/// The scene `plane` with other triangles.
fn scene_of(triangles: &[[DVec3; 3]]) -> Scene {
    let path = pass_test::root().join("scenes/plane.ron");
    let mut scene = scene::load(&path.to_string_lossy(), &NoFiles).expect("the scene is there");
    let like = scene.vertices[0];
    let corners = triangles.iter().flatten();
    scene.vertices = corners.map(|at| Vertex { position: at.as_vec3().to_array(), ..like }).collect();
    scene.indices = (0..scene.vertices.len() as u32).collect();
    scene
}

/// The maps of these lights, row by row, rendered either way.
fn render(scene: &Scene, lights: &[(DVec3, DVec3)], tile: u32) -> Option<[Vec<Vec<f64>>; 2]> {
    let [rasterised, traced] =
        METHODS.map(|method| render_in_layers(scene, lights, (tile, AtlasLayout::SIDE), method));
    Some([rasterised?.0, traced?.0])
}

#[test]
fn what_is_cut_out_hides_nothing() {
    // 1 m above a square of 2 m, whose half with negative x is cut out.
    let lights = [(DVec3::Y, DVec3::NEG_Y)];
    let Some(maps) = render(&pass_test::rooms::half_plane(), &lights, 32) else { return };
    for (method, maps) in METHODS.iter().zip(&maps) {
        let mut met = 0;
        for (i, distance) in (0..).zip(&maps[0]) {
            let direction = direction_from_paraboloid(texel_centre(uvec2(i % 32, i / 32), 32));
            let at = DVec3::Y + frame_from_normal(DVec3::NEG_Y) * direction / direction.z;
            if direction.z <= 0.0 || at.x.abs().max(at.z.abs()) > 1.0 || at.x < -0.1 {
                assert!(*distance > 1e30, "{method}: texel {i} at {at} has {distance}");
            } else if at.x > 0.1 {
                let is_right = (distance * direction.z - 1.0).abs() < 1e-5;
                assert!(is_right, "{method}: texel {i} at {at} has {distance}");
                met += 1;
            }
        }
        assert!(met > 60, "{method}: {met} texels see the square");
    }
}

#[test]
fn a_dark_light_has_an_empty_map() {
    let dark = VirtualLight { flux: [0.0; 3], ..light_at(DVec3::Y, DVec3::NEG_Y) };
    for method in METHODS {
        let harness =
            Harness::new(paraboloid_shadow_maps::PASS).scene("plane").set("map", 8).set("method", method);
        let Some(outputs) = harness.lights(&[light_at(DVec3::Y, DVec3::NEG_Y), dark]).run() else { return };
        let atlas = outputs.read::<f32>("visibility.atlas");
        let columns = outputs.fact("visibility", "columns").as_u32().expect("a number") as usize;
        let is_of =
            |light: usize, i: usize| (i / (8 * columns) / 8 * columns + i % (8 * columns) / 8) == light;
        let met = |light| atlas.iter().enumerate().filter(|(i, at)| is_of(light, *i) && **at < 1e30).count();
        assert!(met(0) > 10 && met(1) == 0, "{method}: {} and {} texels", met(0), met(1));
    }
}

/// The maps in an atlas whose layers have sides of at most `side`, and how many layers there are.
fn render_in_layers(
    scene: &Scene,
    lights: &[(DVec3, DVec3)],
    (tile, side): (u32, u32),
    method: &str,
) -> Option<(Vec<Vec<f64>>, u32)> {
    let given: Vec<VirtualLight> =
        lights.iter().map(|(position, normal)| light_at(*position, *normal)).collect();
    let pass = ParaboloidShadowMaps { side };
    let harness = Harness::new(&pass).with_scene(scene.clone()).set("map", tile).set("method", method);
    let outputs = harness.lights(&given).run()?;
    let atlas: Vec<f32> = outputs.read("visibility.atlas");
    let columns = outputs.fact("visibility", "columns").as_u32().expect("a number");
    let layers = outputs.desc("visibility.atlas").texture().map_or(0, |texture| texture.layers);
    // Rows go on from layer to layer.
    let texel = |light: u32, i: u32| {
        let (x, y) = (light % columns * tile + i % tile, light / columns * tile + i / tile);
        f64::from(atlas[(y * columns * tile + x) as usize])
    };
    let map = |light| (0..tile * tile).map(|i| texel(light, i)).collect();
    Some(((0..lights.len() as u32).map(map).collect(), layers))
}

/// A hash in [-1, 1).
fn noise(seed: &mut u64) -> f64 {
    *seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
    (*seed >> 33) as f64 / f64::from(1u32 << 30) - 1.0
}

fn vector(seed: &mut u64) -> DVec3 {
    DVec3::from([0; 3].map(|_| noise(seed)))
}

/// As single precision has it, so that rounding is not part of what is compared.
fn single(v: DVec3) -> DVec3 {
    v.as_vec3().as_dvec3()
}

/// Triangles of all sizes around the origin, slivers and points among them.
fn triangles(count: usize, seed: &mut u64) -> Vec<[DVec3; 3]> {
    (0..count)
        .map(|i| {
            let size = [0.05, 0.5, 3.0, 300.0][i % 4];
            let at = 1.5 * vector(seed);
            let mut corners = [0; 3].map(|_| at + size * vector(seed));
            match i % 9 {
                7 => corners[2] = 0.5 * (corners[0] + corners[1]) + 1e-6 * vector(seed),
                8 => corners[1] = corners[0],
                _ => {}
            }
            corners.map(single)
        })
        .collect()
}

#[test]
fn a_quad_has_the_distances_of_its_plane() {
    let path = pass_test::root().join("scenes/plane.ron");
    let scene = scene::load(&path.to_string_lossy(), &NoFiles).expect("the scene is there");
    let lights = [
        (dvec3(0.25, 0.5, -0.125), DVec3::NEG_Y),
        (dvec3(0.0, 0.01, 0.0), dvec3(0.6, 0.0, 0.8)),
        (dvec3(0.0, 0.5, 0.0), DVec3::Y),
    ];
    let tile = 64;
    let Some(maps) = render(&scene, &lights, tile) else { return };
    for ((position, normal), map) in maps.iter().flat_map(|maps| lights.iter().zip(maps)) {
        let frame = frame_from_normal(*normal);
        let mut inside = 0;
        for (i, got) in map.iter().enumerate() {
            let local =
                direction_from_paraboloid(texel_centre(uvec2(i as u32 % tile, i as u32 / tile), tile));
            let direction = frame * local;
            let distance = -position.y / direction.y;
            let at = position + distance * direction;
            let from_middle = at.x.abs().max(at.z.abs());
            let hit = distance > 0.0 && from_middle < 1.0 && local.z > 1e-3;
            // Within rounding of the quad's border or the horizon either answer is right.
            if (from_middle - 1.0).abs() < 1e-4 || (local.z - 1e-3).abs() < 1e-4 {
                continue;
            }
            let wanted = if hit { distance } else { 3.0e38 };
            assert!((got - wanted).abs() <= 1e-5 * wanted, "texel {i} from {position:?}: {got} for {wanted}");
            inside += u32::from(hit);
        }
        assert!(inside > 500 || normal.y > 0.0, "the quad fills {inside} texels from {position:?}");
    }
}

#[test]
fn the_gpu_agrees_with_the_cpu_reference() {
    let seed = &mut 7;
    let triangles = triangles(60, seed);
    let mut lights: Vec<(DVec3, DVec3)> = (0..6).map(|_| (vector(seed), vector(seed).normalize())).collect();
    // In the plane of the first triangle, and on a corner of another.
    lights.push((triangles[0][0] + 1e-4, vector(seed).normalize()));
    lights.push((triangles[2][1], vector(seed).normalize()));
    let lights: Vec<(DVec3, DVec3)> = lights.into_iter().map(|(p, n)| (single(p), single(n))).collect();
    for tile in [1, 3, 32, 64] {
        let Some(maps) = render(&scene_of(&triangles), &lights, tile) else { return };
        for (method, maps) in METHODS.iter().zip(&maps) {
            let mut differ = 0;
            for ((position, normal), got) in lights.iter().zip(maps) {
                let wanted = map(&triangles, *position, *normal, tile, EXTENT);
                let pairs = got.iter().zip(&wanted);
                differ +=
                    pairs.filter(|(got, wanted)| (*got - wanted.min(3.0e38)).abs() > 1e-3 * **got).count();
            }
            // A ray within rounding of an edge may pass on either side.
            let texels = lights.len() * (tile * tile) as usize;
            assert!(
                differ * 500 <= texels,
                "{method}: {differ} of {texels} texels differ in maps of {tile}²"
            );
        }
    }
}

#[test]
fn the_bounds_hold_every_texel_that_is_hit() {
    let seed = &mut 11;
    for triangle in triangles(400, seed) {
        let frame = frame_from_normal(vector(seed).normalize());
        let light = vector(seed);
        let local = triangle.map(|corner| frame.transpose_mul_vec3(corner - light));
        if local.iter().all(|corner| corner.z <= 0.0) {
            continue;
        }
        let (low, high) = image_bounds(local, EXTENT);
        for i in 0..48 * 48 {
            let at = texel_centre(uvec2(i % 48, i / 48), 48);
            if hit(direction_from_paraboloid(at), local, EXTENT).is_some() {
                let inside = (low - 1e-9).cmple(at).all() && at.cmple(high + 1e-9).all();
                assert!(inside, "{at:?} of {local:?} is outside {low:?}..{high:?}");
            }
        }
    }
}

/// The images of edges bend beyond the box around their ends, also of those that the horizon cuts.
#[test]
fn triangles_across_the_horizon_are_whole() {
    let corners = [dvec3(-0.37, -0.3, 0.28), dvec3(0.43, 0.14, 0.12), dvec3(-0.66, -0.02, -0.1)];
    for turn in 0..24 {
        let turned = frame_from_normal(DVec3::Z) * DMat3::from_rotation_z(f64::from(turn) * PI / 12.0);
        for first in 0..3 {
            let triangle = [0, 1, 2].map(|i| single(turned * corners[(first + i) % 3]));
            let Some(maps) = render(&scene_of(&[triangle]), &[(DVec3::ZERO, DVec3::Z)], 64) else { return };
            let wanted = map(&[triangle], DVec3::ZERO, DVec3::Z, 64, EXTENT);
            for (method, maps) in METHODS.iter().zip(&maps) {
                let pairs = || maps[0].iter().zip(&wanted);
                let is_seen = pairs().filter(|(_, wanted)| wanted.is_finite()).count();
                let differ = pairs().filter(|(got, wanted)| (*got - wanted.min(3.0e38)).abs() > 1e-3 * **got);
                let differ = differ.count();
                // A ray within rounding of an edge may pass on either side.
                assert!(
                    is_seen > 1000 && differ <= 1,
                    "{method}, turned by {turn}/24: {differ} of {is_seen} texels differ"
                );
            }
        }
    }
}

#[test]
fn the_bounds_are_tight() {
    // Small triangles: the box is that of the corners but for the bend of the arcs, a second-order term.
    let seed = &mut 13;
    for _ in 0..200 {
        let middle = dvec3(noise(seed), noise(seed), 1.2);
        let corners = [0; 3].map(|_| middle + 0.02 * vector(seed));
        let (low, high) = image_bounds(corners, EXTENT);
        let images = corners.map(|c| c.truncate() / (c.length() + c.z));
        let least = images.into_iter().fold(DVec2::INFINITY, DVec2::min);
        let most = images.into_iter().fold(DVec2::NEG_INFINITY, DVec2::max);
        assert!(low.cmple(least).all() && (least - low).max_element() < 1e-4, "{corners:?}");
        assert!(high.cmpge(most).all() && (high - most).max_element() < 1e-4, "{corners:?}");
    }
}

#[test]
fn no_triangles_leave_nothing() {
    let Some(maps) = render(&scene_of(&[]), &[(DVec3::ZERO, DVec3::Y)], 8) else { return };
    assert!(maps.iter().flatten().flatten().all(|depth| *depth >= 2.9e38), "nothing is there");
}

#[test]
fn maps_are_the_same_in_one_layer_and_in_several() {
    let seed = &mut 17;
    let scene = scene_of(&triangles(40, seed));
    let lights: Vec<(DVec3, DVec3)> = (0..7).map(|_| (vector(seed), vector(seed).normalize())).collect();
    for method in METHODS {
        let in_layers = |side| render_in_layers(&scene, &lights, (16, side), method);
        let Some((maps, layers)) = in_layers(8192) else { return };
        assert_eq!(layers, 1);
        // Four maps a layer, of which the last has three; one map a layer; sides that are no multiple of the maps'.
        for (side, wanted) in [(32, 2), (16, 7), (47, 2)] {
            let Some((cut, layers)) = in_layers(side) else { return };
            assert_eq!(layers, wanted, "layers of {side}²");
            assert!(cut == maps, "{method}: layers of {side}² hold other maps than one layer");
        }
    }
}

/// The results of the pass: the atlas and where its lights stand.
type Left = (Vec<f32>, Vec<Stand>);

/// The maps where those of another frame are there: none with an age of 0.
fn render_after(
    scene: &Scene,
    lights: &[VirtualLight],
    (tile, side, method): (u32, u32, &str),
    past: &Left,
    age: u32,
) -> Option<Left> {
    let layout = AtlasLayout::new(lights.len() as u32, tile, side).expect("there is room");
    let atlas = ResourceDesc::texture_2d_array(
        Format::R32Float,
        (layout.columns() * tile, layout.rows() * tile),
        layout.layers(),
    );
    let pass = ParaboloidShadowMaps { side };
    let outputs = Harness::new(&pass)
        .with_scene(scene.clone())
        .set("map", tile)
        .set("method", method)
        .lights(lights)
        .past("past", "Visibility", age, vec![member("atlas", atlas, &past.0)])
        .past("rendered", "Stands", age, elements(&past.1))
        .fact("count", lights.len() as u32)
        .run()?;
    Some((outputs.read("visibility.atlas"), outputs.read("stands")))
}

/// The second of two frames renders the maps of lights that moved, to the bit as if there had been no other, and leaves
/// every other texel as it is.
#[test]
fn maps_of_lights_that_stay_are_kept() {
    let seed = &mut 23;
    let scene = scene_of(&triangles(40, seed));
    // A side that is no power of two as well.
    let shapes = [(16, 8192, 7), (16, 47, 7), (8, 16, 300), (6, 47, 7)];
    for ((tile, side, count), method) in
        shapes.iter().flat_map(|shape| METHODS.map(|method| (*shape, method)))
    {
        let mut before: Vec<_> =
            (0..count).map(|_| light_at(vector(seed), vector(seed).normalize())).collect();
        // A light of one color shines.
        before[2].flux = [0.0, 0.0, 1.0];
        let mut after = before.clone();
        for index in [1, 4, 5] {
            after[index].position[index % 3] += 0.25;
        }
        after[6].normal = after[6].normal.map(|x| -x);
        let layout = AtlasLayout::new(count, tile, side).expect("there is room");
        let texels = (layout.columns() * layout.rows() * layout.layers() * tile * tile) as usize;
        let nothing = (vec![0.0; texels], vec![Stand::default(); count as usize]);
        let with = |lights: &[VirtualLight], past: &Left, age| {
            render_after(&scene, lights, (tile, side, method), past, age)
        };
        let Some(first) = with(&before, &nothing, 1) else { return };
        let fresh = with(&after, &nothing, 0).expect("the adapter is still there");
        assert!(first.1.iter().zip(&before).all(|(stand, light)| stand.position == light.position));
        // The first frame renders all maps, as a pass does that keeps none.
        let pass = ParaboloidShadowMaps { side };
        let plain = Harness::new(&pass).with_scene(scene.clone()).set("map", tile).set("method", method);
        let plain = plain.lights(&before).run();
        let plain: Vec<f32> = plain.expect("the adapter is still there").read("visibility.atlas");
        // Kept texels differ from rendered ones.
        let marked = (first.0.iter().map(|distance| -distance).collect(), first.1.clone());
        let second = with(&after, &marked, 1).expect("the adapter is still there");
        assert_eq!(second.1, fresh.1);
        let width = layout.columns() * tile;
        for index in 0..count {
            let [x, y, layer] = layout.origin(index);
            let moved = [1, 4, 5, 6].contains(&index);
            for i in 0..tile * tile {
                let row = layer * layout.rows() * tile + y + i / tile;
                let at = (row * width + x + i % tile) as usize;
                let expected = if moved { fresh.0[at] } else { marked.0[at] };
                assert_eq!(second.0[at], expected, "texel {i} of map {index} of {tile}², layers of {side}²");
                assert_eq!(first.0[at], plain[at], "texel {i} of map {index} of {tile}², first frame");
            }
        }
        // Without history everything is rendered, and where nothing moved nothing is.
        assert_eq!(with(&before, &marked, 0), Some(first));
        assert_eq!(with(&before, &marked, 1), Some(marked));
    }
}

#[test]
fn one_link_of_two_is_refused() {
    let lights = [light_at(DVec3::ZERO, DVec3::Y)];
    let pass = ParaboloidShadowMaps { side: 8192 };
    let harness = Harness::new(&pass).scene("plane").set("map", 8u32).lights(&lights);
    let harness = harness.past("rendered", "Stands", 1, elements(&[0_u32; 8])).fact("count", 1u32);
    let Some(said) = harness.refusal() else { return };
    assert!(said.contains("`past` and `rendered`: one of them is missing"), "{said}");
}
