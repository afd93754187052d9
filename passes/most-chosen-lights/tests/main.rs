//! Which lights are taken, against a sort of how often each was chosen.

use interfaces::reservoirs::Reservoir;
use interfaces::virtual_lights::VirtualLight;
use most_chosen_lights::PASS;
use pass_test::Harness;
use pass_test::reservoirs::{SIDE, flat, reservoir};

const NONE: u32 = u32::MAX;
const PIXELS: u32 = SIDE * SIDE;

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

/// Lights of which each has its index as its texel.
fn lights(count: u32) -> Vec<VirtualLight> {
    let light = |i: u32| VirtualLight {
        position: [i as f32, 1.0, 0.0],
        normal: [0.0, -1.0, 0.0],
        flux: [1.0; 3],
        texel: i,
        ..VirtualLight::default()
    };
    (0..count).map(light).collect()
}

/// The texels of the lights that the pass takes, and the place of each light.
fn taken(lights: &[VirtualLight], reservoirs: &[Reservoir], count: u32) -> Option<(Vec<u32>, Vec<u32>)> {
    let harness = Harness::new(PASS).middle_of_plane(flat).lights(lights);
    let outputs = harness.reservoirs("reservoirs", 1, reservoirs).set("count", count).run()?;
    let chosen = outputs.lights("chosen").iter().map(|light| light.texel).collect();
    let mut places: Vec<u32> = outputs.read("places");
    places.truncate(lights.len());
    Some((chosen, places))
}

/// What the pass should take, and the places of the lights.
fn expected(lights: u32, reservoirs: &[Reservoir], count: u32) -> (Vec<u32>, Vec<u32>) {
    let times = |l: u32| reservoirs.iter().filter(|r| r.weight > 0.0 && r.index == l).count();
    let mut by_times: Vec<(usize, u32)> =
        (0..lights).map(|l| (times(l), l)).filter(|(n, _)| *n > 0).collect();
    by_times.sort_by_key(|(times, light)| (std::cmp::Reverse(*times), *light));
    let mut chosen: Vec<u32> = by_times.iter().take(count as usize).map(|(_, light)| *light).collect();
    chosen.sort_unstable();
    let place = |l| chosen.iter().position(|c| *c == l).map_or(NONE, |place| place as u32);
    let places = (0..lights).map(place).collect();
    (chosen, places)
}

/// Reservoirs of which each names the light that a function gives for its pixel.
fn choices(lights: &[VirtualLight], of: impl Fn(u32) -> u32) -> Vec<Reservoir> {
    (0..PIXELS).map(|pixel| reservoir(lights[of(pixel) as usize], 0.5, 1.0)).collect()
}

#[test]
fn the_lights_that_were_chosen_most_are_taken() {
    // More than two blocks of a workgroup, and many that were chosen equally often.
    let lights = lights(700);
    let reservoirs = choices(&lights, |pixel| {
        let number = f64::from(pixel.wrapping_mul(0x9e37_79b9)) / f64::from(u32::MAX);
        (700.0 * number.powi(3)).min(699.0) as u32
    });
    for count in [1, 2, 17, 256, 300, 699, 700, 1000] {
        let Some(found) = taken(&lights, &reservoirs, count) else { return };
        assert_eq!(found, expected(700, &reservoirs, count), "{count} lights");
    }
}

#[test]
fn lights_that_no_pixel_chose_are_not_taken() {
    let lights = lights(40);
    let mut reservoirs = choices(&lights, |pixel| 3 * (pixel % 5));
    // These have no light: no weight, or none that there is.
    for reservoir in reservoirs.iter_mut().take(PIXELS as usize / 2) {
        (reservoir.weight, reservoir.index) = (0.0, 7);
    }
    reservoirs[PIXELS as usize - 1].index = NONE;
    let Some(found) = taken(&lights, &reservoirs, 16) else { return };
    assert_eq!(found.0, [0, 3, 6, 9, 12]);
    assert_eq!(found, expected(40, &reservoirs, 16));
}

#[test]
fn of_lights_that_were_chosen_equally_often_the_first_are_taken() {
    let lights = lights(96);
    let reservoirs = choices(&lights, |pixel| pixel % 96);
    let Some((chosen, _)) = taken(&lights, &reservoirs, 10) else { return };
    assert_eq!(chosen, (0..10).collect::<Vec<u32>>());
}

#[test]
fn without_choices_none_are_taken() {
    let lights = lights(5);
    let mut reservoirs = choices(&lights, |_| 0);
    reservoirs.iter_mut().for_each(|reservoir| reservoir.weight = 0.0);
    let Some((chosen, places)) = taken(&lights, &reservoirs, 3) else { return };
    assert_eq!((chosen, places), (vec![], vec![NONE; 5]));
}
