//! The structure of trees, against brute force.

use ::light_tree::PASS;
use glam::{DVec3, Vec3};
use interfaces::light_tree as tree_of;
use interfaces::light_tree::{LightNode, LightTreeHeader, NO_LIGHT};
use interfaces::virtual_lights::{VirtualLight, to_bytes};
use pass_test::{Harness, INFINITELY_FAR, buffer, random};

pass_test::shaders_are_valid!(PASS);

fn unit(index: u32, dimension: u32) -> f32 {
    random::unit_float(random::hash2(index, dimension)) as f32
}

/// Returns lights in a box of 1 × 2 × 3 m that face everywhere.
fn lights(count: u32) -> Vec<VirtualLight> {
    let light = |i| {
        let [x, y, z, u, v, w] = [0, 1, 2, 3, 4, 5].map(|dimension| unit(i, dimension));
        let normal = Vec3::new(u - 0.5, v - 0.5, w - 0.5).normalize_or(Vec3::X);
        VirtualLight {
            position: [x, 2.0 * y, 3.0 * z],
            area: 0.1 * unit(i, 6),
            normal: normal.to_array(),
            flux: [unit(i, 7), 0.0, 0.1 + unit(i, 8)],
            ..VirtualLight::default()
        }
    };
    (0..count).map(light).collect()
}

fn brightness(light: &VirtualLight) -> f64 {
    let [r, g, b] = light.flux.map(f64::from);
    0.2126 * r + 0.7152 * g + 0.0722 * b
}

/// Builds a tree over these lights.
fn tree(lights: &[VirtualLight]) -> Option<(LightTreeHeader, Vec<LightNode>)> {
    let outputs = Harness::new(PASS).lights(lights).run()?;
    Some(tree_of::from_bytes(&outputs.read("tree")).expect("the tree has its leaves"))
}

/// Asserts that each light that is not dark is in one leaf, and that each node bounds the lights below it.
fn assert_bounds(lights: &[VirtualLight], header: &LightTreeHeader, nodes: &[LightNode]) {
    let lit: Vec<u32> = (0..lights.len() as u32).filter(|i| brightness(&lights[*i as usize]) > 0.0).collect();
    let leaves = tree_of::leaves(lights.len() as u32);
    assert_eq!((header.count, header.leaves), (lit.len() as u32, leaves));
    assert_eq!(header.root, leaves / tree_of::leaves(header.count), "the lowest node above all lights");
    let order: Vec<u32> = nodes[leaves as usize..].iter().map(|leaf| leaf.light).collect();
    let (taken, empty) = order.split_at(lit.len());
    let mut sorted = taken.to_vec();
    sorted.sort_unstable();
    assert_eq!(sorted, lit, "every light is in one leaf, and the first leaves are those of lights");
    assert!(empty.iter().all(|light| *light == NO_LIGHT));
    for index in 1..2 * leaves {
        let node = &nodes[index as usize];
        let height = leaves.ilog2() - index.ilog2();
        let first = ((index << height) - leaves) as usize;
        let below = taken.get(first..(first + (1 << height)).min(taken.len())).unwrap_or_default();
        let of = |far: bool| {
            let below = below.iter().map(|i| &lights[*i as usize]);
            below.filter(move |light| (light.kind == INFINITELY_FAR) == far)
        };
        let positions = || of(false).map(|light| Vec3::from(light.position));
        let low = positions().fold(Vec3::splat(3e38), Vec3::min);
        let high = positions().fold(Vec3::splat(-3e38), Vec3::max);
        assert_eq!((Vec3::from(node.low), Vec3::from(node.high)), (low, high), "box of node {index}");
        assert_eq!(node.area, of(false).map(|light| light.area).fold(3e38, f32::min), "area of node {index}");
        for (sum, far) in [(node.flux, false), (node.far, true)] {
            let exact: f64 = of(far).map(brightness).sum();
            // A rounding for each level.
            assert!((f64::from(sum) - exact).abs() <= 2e-6 * exact, "node {index}: {sum} of {exact}");
        }
        let axis = Vec3::from(node.axis).as_dvec3();
        let cosine = |light: &VirtualLight| axis.dot(Vec3::from(light.normal).as_dvec3());
        let widest = of(false).chain(of(true)).map(cosine).fold(1.0, f64::min);
        // Leaves have the cosine 1, which the normal, rounded, may miss.
        let rounding = if below.len() < 2 { 1e-6 } else { 0.0 };
        assert!(
            f64::from(node.cosine) <= widest + rounding,
            "cone of node {index}: {} of {widest}",
            node.cosine
        );
        if let [a, b] = below {
            let [a, b] = [a, b].map(|i| Vec3::from(lights[*i as usize].normal).as_dvec3());
            let half = 0.5 * DVec3::angle_between(a, b);
            // Between opposite normals there is no axis.
            let narrowest = if half < 1.57 { half.cos() } else { -1.0 };
            assert!(f64::from(node.cosine) >= narrowest - 1e-5, "node {index} has the narrowest cone of two");
        }
    }
}

#[test]
fn each_node_bounds_the_lights_below_it() {
    for count in [0, 1, 2, 3, 5, 64, 1000] {
        let mut lights = lights(count);
        let Some((header, nodes)) = tree(&lights) else { return };
        assert_bounds(&lights, &header, &nodes);
        // Some dark, some infinitely far.
        for (i, light) in lights.iter_mut().enumerate() {
            light.flux = if i % 7 == 2 { [0.0; 3] } else { light.flux };
            light.kind = u32::from(i % 5 == 1);
        }
        let Some((header, nodes)) = tree(&lights) else { return };
        assert_bounds(&lights, &header, &nodes);
    }
}

#[test]
fn lights_in_extreme_places_have_a_tree() {
    let all = |change: &dyn Fn(&mut VirtualLight)| {
        let mut lights = lights(77);
        lights.iter_mut().for_each(change);
        lights
    };
    for (name, lights) in [
        ("dark", all(&|light| light.flux = [0.0; 3])),
        ("in one place", all(&|light| light.position = [3.0, -1.0, 0.5])),
        (
            "in one place that faces one way",
            all(&|light| (light.position, light.normal) = ([3.0; 3], [0.0, 1.0, 0.0])),
        ),
        ("on a line", all(&|light| light.position = [light.position[0], 0.0, 0.0])),
        ("infinitely far", all(&|light| light.kind = INFINITELY_FAR)),
        (
            "of opposite normals",
            all(&|light| light.normal = [if light.area > 0.05 { 1.0 } else { -1.0 }, 0.0, 0.0]),
        ),
        ("far from the origin", all(&|light| light.position = light.position.map(|x| 1e6 + x))),
        ("tiny", all(&|light| light.position = light.position.map(|x| 1e-9 * x))),
    ] {
        eprintln!("{name}");
        let Some((header, nodes)) = tree(&lights) else { return };
        assert_bounds(&lights, &header, &nodes);
    }
}

#[test]
fn lights_that_face_one_way_have_narrow_cones() {
    let mut lights = lights(1000);
    lights.iter_mut().for_each(|light| light.normal = Vec3::new(0.6, 0.0, 0.8).to_array());
    let Some((header, nodes)) = tree(&lights) else { return };
    // A rounding for each of ten levels.
    let cosine = nodes[header.root as usize].cosine;
    assert!(cosine > 1.0 - 2e-5, "{cosine}");
}

#[test]
fn lights_of_a_node_are_near_each_other() {
    let lights = lights(1000);
    let Some((header, nodes)) = tree(&lights) else { return };
    let first = header.leaves / 8;
    // Of nodes of eight lights: those that have all of them.
    let full = &nodes[first as usize..(first + 1000 / 8) as usize];
    let diagonal = |node: &LightNode| Vec3::from(node.high).distance(Vec3::from(node.low));
    let mean = full.iter().map(diagonal).sum::<f32>() / full.len() as f32;
    // Eight of 1,000 lights fill a cube of 0.36 m in 6 m³, whose diagonal is 0.63 m; eight at random, 2.7 m.
    assert!(mean < 0.9, "the diagonal of eight lights is {mean} m");
}

#[test]
fn lights_beyond_the_count_are_in_no_tree() {
    let all = lights(100);
    let mut bytes = to_bytes(&all);
    bytes[..4].copy_from_slice(&37u32.to_le_bytes());
    let members = vec![("", buffer(bytes.len() as u64), bytes)];
    let harness = Harness::new(PASS).input("lights", "VirtualLights", &[("count", 100)], members);
    let Some(outputs) = harness.run() else { return };
    let (header, nodes) = tree_of::from_bytes(&outputs.read("tree")).unwrap();
    assert_eq!((header.count, header.leaves, header.root), (37, 128, 2));
    // As if the others were dark.
    let mut dark = all.clone();
    dark[37..].iter_mut().for_each(|light| light.flux = [0.0; 3]);
    assert_bounds(&dark, &header, &nodes);
}
