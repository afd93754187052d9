//! Fluxes against sums in double precision.

use interfaces::surface_points::SurfacePoint;
use interfaces::virtual_lights::{self, VirtualLight};
use lights_from_photons::PASS;
use pass_test::{Harness, buffer, elements};

pass_test::shaders_are_valid!(PASS);

const NONE: u32 = u32::MAX;

fn point(seed: u32) -> SurfacePoint {
    SurfacePoint { seed, triangle: 0, normal: [0.0, 1.0, 0.0], ..SurfacePoint::default() }
}

fn light(flux: [f32; 3]) -> VirtualLight {
    VirtualLight { flux, ..VirtualLight::default() }
}

/// What the pass reads, with lights that stay, of which each is its own heir.
struct Case {
    points: Vec<SurfacePoint>,
    photons: Vec<VirtualLight>,
    owners: Vec<u32>,
    before: Vec<SurfacePoint>,
    owners_before: Vec<u32>,
    heirs: Vec<u32>,
    past: Vec<VirtualLight>,
    /// The number of these that count.
    past_count: u32,
    /// Frames of history.
    age: u32,
    frames: u32,
}

impl Case {
    /// Photons of these owners among a number of lights that had nothing before.
    fn new(lights: u32, photons: Vec<VirtualLight>, owners: Vec<u32>) -> Case {
        let points: Vec<SurfacePoint> = (0..lights).map(point).collect();
        Case {
            before: points.clone(),
            points,
            photons,
            owners_before: owners.clone(),
            owners,
            heirs: (0..lights).collect(),
            past: vec![VirtualLight::default(); lights as usize],
            past_count: lights,
            age: 0,
            frames: 64,
        }
    }

    /// Returns the fluxes of the lights.
    fn run(&self) -> Option<Vec<[f32; 3]>> {
        Some(self.lights()?.iter().map(|light| light.flux).collect())
    }

    fn lights(&self) -> Option<Vec<VirtualLight>> {
        let count = |of: usize| of as u32;
        let history = |lights: &[VirtualLight]| {
            let mut bytes = virtual_lights::to_bytes(lights);
            bytes[..4].copy_from_slice(&self.past_count.to_ne_bytes());
            vec![("", buffer(bytes.len() as u64), bytes)]
        };
        let photons = virtual_lights::to_bytes(&self.photons);
        let owned = |harness: Harness<'static>, port: &'static str, owners: &[u32]| {
            harness.input(port, "Owners", &[("count", count(owners.len()))], elements(owners))
        };
        let mut harness = Harness::new(PASS)
            .scene("plane")
            .set("frames", self.frames)
            .surface_points("points", 3, &self.points)
            .surface_points("before", 3, &self.before)
            .input(
                "density",
                "Density",
                &[("count", count(self.points.len()))],
                elements(&vec![2.0f32; self.points.len()]),
            )
            .input(
                "photons",
                "VirtualLights",
                &[("count", count(self.photons.len()))],
                vec![("", buffer(photons.len() as u64), photons)],
            );
        for (port, owners) in
            [("owners", &self.owners), ("owners_before", &self.owners_before), ("heirs", &self.heirs)]
        {
            harness = owned(harness, port, owners);
        }
        let outputs = harness
            .past("past", "VirtualLights", self.age, history(&self.past))
            .fact("count", count(self.past.len()))
            .past("unmoved", "VirtualLights", self.age, history(&self.photons))
            .fact("count", count(self.photons.len()))
            .run()?;
        Some(outputs.lights("lights"))
    }
}

fn sum(fluxes: &[[f32; 3]], channel: usize) -> f64 {
    fluxes.iter().map(|flux| f64::from(flux[channel])).sum()
}

/// The same photons shared out evenly, at random and to one light alone have the same sum; it is theirs, over twenty powers of
/// ten. Photons without an owner do not count.
#[test]
fn the_sum_of_all_lights_is_that_of_all_photons() {
    let photons: Vec<VirtualLight> = (0..6000)
        .map(|i| 10f32.powf((i % 201) as f32 * 0.1 - 10.0))
        .map(|power| light([power, 0.5 * power, 3.0]))
        .collect();
    let owners: [fn(u32) -> u32; 3] = [
        |i| if i % 7 == 0 { NONE } else { i % 60 },
        |i| if i % 7 == 0 { NONE } else { (pass_test::random::hash(i) % 3600).isqrt() },
        |i| if i % 7 == 0 { NONE } else { 5 },
    ];
    for (pattern, owner) in owners.into_iter().enumerate() {
        let case = Case::new(60, photons.clone(), (0..6000).map(owner).collect());
        let Some(found) = case.run() else { return };
        for channel in 0..3 {
            let counted = photons.iter().enumerate().filter(|(i, _)| i % 7 != 0);
            let wanted: f64 = counted.map(|(_, photon)| f64::from(photon.flux[channel])).sum();
            let ratio = sum(&found, channel) / wanted;
            assert!((ratio - 1.0).abs() < 1e-5, "pattern {pattern}, channel {channel}: {ratio}");
        }
        let others = found.iter().enumerate().filter(|(i, flux)| *i != 5 && flux[0] > 0.0).count();
        assert_eq!(others == 0, pattern == 2, "each goes to its owner: {found:?}");
    }
}

/// A frame that puts a light in, and takes others out, leaves the sum as it was: what lights had goes where their photons go, or
/// to the heir; what reaches nothing in view is lost.
#[test]
fn lights_that_come_and_go_leave_the_sum_as_it_was() {
    let photons = vec![light([1.0; 3]); 8];
    let mut case = Case::new(6, photons, vec![0, 0, 0, 5, 1, 1, 3, 3]);
    case.past = [[8.0, 4.0, 2.0], [1.0; 3], [16.0; 3], [32.0; 3], [64.0; 3], [128.0; 3]].map(light).to_vec();
    // Light 5 is put in where a quarter of the photons of light 0 are. Light 2 has none, and gives way to 1; light 4 has none and
    // reaches nothing. Light 5 of the frame before gives all that it has to light 3.
    case.owners_before = vec![0, 0, 0, 0, 1, 1, 5, 5];
    case.heirs = vec![0, 1, 1, 3, 4, 3];
    case.before[4].mark = 1;
    case.age = 10;
    case.frames = 65536;
    // With so long a mean of so old a history, the photons of the frame count for an eleventh.
    let Some(found) = case.run() else { return };
    let handed = [[6.0, 3.0, 1.5], [17.0; 3], [0.0; 3], [160.0; 3], [0.0; 3], [2.0, 1.0, 0.5]];
    let fresh = [3.0, 2.0, 0.0, 2.0, 0.0, 1.0];
    for (i, found) in found.iter().enumerate() {
        for channel in 0..3 {
            let wanted = (10.0 * handed[i][channel] + fresh[i]) / 11.0;
            assert!((f64::from(found[channel]) - wanted).abs() < 1e-4, "light {i}: {found:?}, not {wanted}");
        }
    }
}

/// Where the view comes to see more, photons count whole, however old the mean is; where it sees no longer, their part is lost.
#[test]
fn the_view_may_come_to_see_other_surfaces() {
    let mut case = Case::new(2, vec![light([1.0; 3]); 6], vec![0, 0, 1, NONE, NONE, 1]);
    case.owners_before = vec![0, NONE, 1, 1, 1, 1];
    case.past = vec![light([4.0; 3]), light([12.0; 3])];
    case.age = 9;
    let Some(found) = case.run() else { return };
    // Light 0 keeps all and sees one more; light 1 keeps two photons of four.
    let wanted = [4.0 * 0.9 + 0.1 + 1.0, 6.0 * 0.9 + 2.0 * 0.1];
    for (found, wanted) in found.iter().zip(wanted) {
        assert!((found[1] - wanted).abs() < 1e-5, "{found:?}, not {wanted}");
    }
}

/// A flux is the mean of all frames, of the last `frames` of them as a decaying one.
#[test]
fn fluxes_are_means_over_frames() {
    for (age, frames, share) in [(0, 64, 1.0), (3, 64, 0.25), (40, 20, 0.05)] {
        let mut case = Case::new(1, vec![light([2.0; 3])], vec![0]);
        case.past = vec![light([1.0; 3])];
        (case.age, case.frames) = (age, frames);
        let Some(found) = case.run() else { return };
        assert!((found[0][0] - (1.0 + share)).abs() < 1e-6, "{age}, {frames}: {found:?}");
    }
}

/// The area is that of the density; there is no light where there is no point.
#[test]
fn lights_stand_on_their_points() {
    let mut case = Case::new(4, vec![light([1.0; 3])], vec![1]);
    case.points[2] = SurfacePoint::NONE;
    let Some(found) = case.lights() else { return };
    let areas: Vec<f32> = found.iter().map(|light| light.area).collect();
    assert!(areas.iter().zip([1.0, 1.0, 0.0, 1.0]).all(|(a, b)| (a - b / 6.0).abs() < 1e-6), "{areas:?}");
    assert_eq!((found[1].normal, found[1].flux, found[2].flux), ([0.0, 1.0, 0.0], [1.0; 3], [0.0; 3]));
}

#[test]
fn extremes_stay_finite() {
    for flux in [0.0, 1e-45, 1e-38, 3e38, f32::INFINITY, f32::NAN, -1.0] {
        let mut case = Case::new(3, vec![light([flux; 3]); 300], (0..300).map(|i| i % 4).collect());
        case.past = vec![light([flux; 3]); 3];
        case.age = 5;
        let Some(found) = case.run() else { return };
        assert!(found.iter().flatten().all(|x| x.is_finite() && *x >= 0.0), "{flux}: {found:?}");
    }
    let mut none = Case::new(2, vec![VirtualLight::default()], vec![NONE]);
    none.points.fill(SurfacePoint::NONE);
    none.before.fill(SurfacePoint::NONE);
    none.heirs.fill(NONE);
    let Some(found) = none.run() else { return };
    assert_eq!(found[..2], [[0.0; 3]; 2]);
}

/// What stands behind the lights of the frame before was none of them.
#[test]
fn lights_that_do_not_count_hand_nothing_on() {
    let mut case = Case::new(3, vec![light([1.0; 3])], vec![0]);
    case.past = vec![light([4.0; 3]); 3];
    (case.past_count, case.age, case.heirs) = (2, 9, vec![0, 1, 1]);
    let Some(found) = case.run() else { return };
    let expected = [4.0 * 0.9 + 0.1, 4.0 * 0.9, 0.0];
    for (found, expected) in found.iter().zip(expected) {
        assert!((found[0] - expected).abs() < 1e-5, "{found:?}, not {expected}");
    }
}

/// However many photons share what a light had, and whatever their fluxes: all of it goes on.
#[test]
fn what_is_handed_on_adds_up() {
    let photons: Vec<VirtualLight> = (0..600)
        .map(|i| {
            [0, 1, 2].map(|c| 0.1 + pass_test::random::unit_float(pass_test::random::hash2(i, c)) as f32)
        })
        .map(light)
        .collect();
    let mut case = Case::new(5, photons, (0..600).map(|i| i % 5).collect());
    case.owners_before = (0..600).map(|i| i % 7 % 2).collect();
    case.past = [[3.0, 0.7, 10.1], [0.9, 5.3, 1.7], [0.0; 3], [0.0; 3], [0.0; 3]].map(light).to_vec();
    (case.age, case.frames) = (3, 65536);
    let Some(found) = case.run() else { return };
    for channel in 0..3 {
        let of =
            |lights: &[VirtualLight]| lights.iter().map(|light| f64::from(light.flux[channel])).sum::<f64>();
        let expected = 0.75 * of(&case.past) + 0.25 * of(&case.photons);
        let ratio = sum(&found, channel) / expected;
        assert!((ratio - 1.0).abs() < 1e-5, "channel {channel}: {ratio}");
    }
}
