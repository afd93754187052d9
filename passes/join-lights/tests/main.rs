//! Tests of the pass.

use glam::DVec3;
use interfaces::virtual_lights::{self, VirtualLight, VirtualLobe};
use join_lights::PASS;
use pass_test::{Harness, light_at, member};

pass_test::shaders_are_valid!(PASS);

/// Lights whose flux is their number, from one on.
fn numbered(start: u32, count: u32) -> Vec<VirtualLight> {
    let light = |i: u32| VirtualLight { flux: [i as f32; 3], ..light_at(DVec3::X, DVec3::Y) };
    (start..start + count).map(light).collect()
}

/// Joins two sets, of which the first declares `most` lights; the numbers of what comes out.
fn joined(first: &[VirtualLight], most: u32, second: &[VirtualLight]) -> Option<Vec<u32>> {
    // What is beyond the lights of a set would be seen.
    let set = |lights: &[VirtualLight], most: usize| {
        let mut room = lights.to_vec();
        room.resize(most.max(1), VirtualLight { flux: [9e9; 3], ..light_at(DVec3::X, DVec3::Y) });
        let mut content = virtual_lights::to_bytes(&room);
        content[..4].copy_from_slice(&(lights.len() as u32).to_le_bytes());
        vec![("", pass_test::buffer(content.len() as u64), content)]
    };
    let outputs = Harness::new(PASS)
        .input("first", "VirtualLights", &[("count", most)], set(first, most as usize))
        .input("second", "VirtualLights", &[("count", second.len() as u32)], set(second, second.len()))
        .run()?;
    assert_eq!(*outputs.fact("lights", "count"), (most + second.len() as u32).into());
    Some(outputs.lights("lights").iter().map(|light| light.flux[0] as u32).collect())
}

/// Each light is there once, each set in its order; and any run of them has the share of both that they have in all.
#[test]
fn sets_alternate_in_proportion() {
    for (first, second) in
        [(1024, 256), (1280, 256), (7, 3), (3, 7), (5, 5), (1, 100), (100, 1), (4, 0), (0, 4)]
    {
        let Some(all) = joined(&numbered(0, first), first.max(1), &numbered(10_000, second)) else { return };
        let [ours, theirs]: [Vec<u32>; 2] =
            [false, true].map(|is| all.iter().copied().filter(|i| (*i >= 10_000) == is).collect());
        assert!(ours.into_iter().eq(0..first), "{first} and {second}");
        assert!(theirs.into_iter().eq(10_000..10_000 + second), "{first} and {second}");
        for (i, run) in
            (0..all.len()).flat_map(|i| (i + 1..=all.len().min(i + 24)).map(move |end| (i, i..end)))
        {
            let found = all[run.clone()].iter().filter(|i| **i >= 10_000).count() as f64;
            let share = run.len() as f64 * f64::from(second) / f64::from(first + second);
            assert!((found - share).abs() <= 1.0, "{found} for {share} from {i} on, {first} and {second}");
        }
    }
}

/// A set may hold fewer lights than it has room for: what is beyond is no light.
#[test]
fn what_is_beyond_the_count_of_a_set_is_left_out() {
    let Some(all) = joined(&numbered(0, 2), 6, &numbered(100, 2)) else { return };
    assert_eq!(all, [0, 100, 1, 101]);
}

/// Lobes stay with their lights; lights of a set without lobes reflect nothing specularly.
#[test]
fn lobes_stay_with_their_lights() {
    let set = |lights: &[VirtualLight], has_lobes: bool| {
        let content = virtual_lights::to_bytes(lights);
        let mut members = vec![("", pass_test::buffer(content.len() as u64), content)];
        let lobe = |light: &VirtualLight| VirtualLobe { flux: light.flux, ..VirtualLobe::default() };
        let lobes: Vec<VirtualLobe> = lights.iter().map(lobe).collect();
        let desc = pass_test::buffer(size_of_val(&*lobes) as u64);
        members.extend(has_lobes.then(|| member("lobes", desc, &lobes)));
        members
    };
    let (first, second) = (numbered(1, 5), numbered(100, 2));
    for (of_first, of_second) in [(true, true), (true, false), (false, true)] {
        let outputs = Harness::new(PASS)
            .input("first", "VirtualLights", &[("count", 5)], set(&first, of_first))
            .input("second", "VirtualLights", &[("count", 2)], set(&second, of_second))
            .run();
        let Some(outputs) = outputs else { return };
        let (lights, lobes) = (outputs.lights("lights"), outputs.read::<VirtualLobe>("lights.lobes"));
        assert_eq!((lights.len(), lobes.len()), (7, 7));
        for (light, lobe) in std::iter::zip(&lights, &lobes) {
            let has_lobe = if light.flux[0] < 100.0 { of_first } else { of_second };
            assert_eq!(lobe.flux, if has_lobe { light.flux } else { [0.0; 3] });
        }
    }
}
