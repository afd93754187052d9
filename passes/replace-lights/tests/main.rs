//! The pass against Alg. 1 by sorting, and what no frame may do.

mod cpu_reference;

use cpu_reference::{Light, newcomers};
use interfaces::radiosity::PointRadiosity;
use interfaces::surface_points::{self, SurfacePoint};
use interfaces::virtual_lights::{self, VirtualLight};
use pass_test::random::hash;
use pass_test::{Harness, Outputs, elements};
use replace_lights::PASS;

pass_test::shaders_are_valid!(PASS);

/// The inputs of the pass: slots and candidates, each of which may be empty.
#[derive(Clone, Debug)]
struct Case {
    lights: Vec<Option<Light>>,
    candidates: Vec<Option<f32>>,
    moved: u32,
}

/// A point that is known by its seed.
fn point(seed: u32, mark: u32) -> SurfacePoint {
    SurfacePoint { position: [seed as f32; 3], triangle: seed % 7, seed, mark, ..SurfacePoint::NONE }
}

/// Seeds of lights, and of mailboxes, candidates and origins.
const SEEDS: [u32; 4] = [1000, 200_000, 400_000, 600_000];

impl Case {
    fn run(&self) -> Option<Outputs> {
        self.run_with(|_| {}, &[])
    }

    /// Runs the pass with mailboxes whose bytes are changed, and with more settings.
    fn run_with(&self, change: impl FnOnce(&mut [u8]), settings: &[(&str, u32)]) -> Option<Outputs> {
        let count = self.candidates.len();
        let points = |base: u32, is_there: &dyn Fn(usize) -> bool, mark: &dyn Fn(usize) -> bool| {
            let one =
                |i| if is_there(i) { point(base + i as u32, u32::from(mark(i))) } else { SurfacePoint::NONE };
            (0..count).map(one).collect::<Vec<_>>()
        };
        let light = |i: usize| self.lights[i].is_some();
        let marked = |i: usize| self.lights[i].is_some_and(|light| !light.is_valid);
        let candidate = |i: usize| self.candidates[i].is_some();
        let intensities: Vec<VirtualLight> = self
            .lights
            .iter()
            // Powers of two are exact whatever they are divided by and multiplied with.
            .map(|light| VirtualLight {
                flux: [light.map_or(0.0, |light| light.intensity / count as f32); 3],
                ..VirtualLight::default()
            })
            .collect();
        let radiosity: Vec<_> = self
            .candidates
            .iter()
            .map(|intensity| PointRadiosity { radiosity: [intensity.unwrap_or(9.0) * 2.0; 3], key: 1 })
            .collect();
        let density: Vec<f32> = self.candidates.iter().map(|c| if c.is_some() { 2.0 } else { 0.0 }).collect();
        let facts = &[("count", count as u32)];
        let never = |_: usize| false;
        let mut mailboxes = surface_points::to_bytes(41, &points(SEEDS[1], &light, &never));
        change(&mut mailboxes);
        settings
            .iter()
            .fold(Harness::new(PASS), |harness, (name, value)| harness.set(name, *value))
            .set("moved", self.moved)
            .surface_points("lights", 41, &points(SEEDS[0], &light, &marked))
            .input("mailboxes", "SurfacePoints", facts, elements(&mailboxes))
            .input("intensities", "VirtualLights", facts, elements(&virtual_lights::to_bytes(&intensities)))
            .surface_points("candidates", 41, &points(SEEDS[2], &candidate, &never))
            .surface_points("origins", 41, &points(SEEDS[3], &candidate, &never))
            .input("radiosity", "Radiosity", facts, elements(&radiosity))
            .input("density", "Density", facts, elements(&density))
            .run()
    }

    /// Asserts that slots hold what sorting says. Returns how many lights were replaced that were there; `None` without an
    /// adapter.
    fn check(&self) -> Option<usize> {
        self.check_with(&[], self.moved, 0.95)
    }

    /// Asserts the same with more settings, where at most so many lights are replaced, by candidates that outshine such a share.
    fn check_with(&self, settings: &[(&str, u32)], moved: u32, quantile: f64) -> Option<usize> {
        let outputs = self.run_with(|_| {}, settings)?;
        let (header, replaced) = outputs.surface_points("replaced");
        let (_, witnesses) = outputs.surface_points("witnesses");
        let wanted = newcomers(&self.lights, &self.candidates, moved as usize, quantile);
        for (slot, newcomer) in wanted.iter().enumerate() {
            let expected = |here: usize, there: usize| match (newcomer, self.lights[slot]) {
                (Some(index), _) => point(SEEDS[there] + *index as u32, 0),
                (None, Some(_)) => point(SEEDS[here] + slot as u32, 0),
                (None, None) => SurfacePoint::NONE,
            };
            assert_eq!(replaced[slot], expected(0, 2), "slot {slot}");
            assert_eq!(witnesses[slot], expected(1, 3), "the mailbox of slot {slot}");
        }
        assert_eq!(header.iteration, 41);
        assert_eq!(header.marked as usize, wanted.iter().flatten().count());
        let progress: Vec<u32> = outputs.read("progress");
        let warm_up = settings.iter().find(|(name, _)| *name == "warm_up").map_or(100, |(_, value)| *value);
        assert_eq!(progress, [42.min(warm_up), warm_up, 0, u32::from(warm_up <= 42)]);
        Some(wanted.iter().zip(&self.lights).filter(|(new, old)| new.is_some() && old.is_some()).count())
    }
}

/// Random slots and candidates. Intensities are powers of two, so that many are equal.
fn random(count: usize, seed: u32, [empty, invalid, missing]: [u32; 3], moved: u32) -> Case {
    let number = |i: usize, what: u32| hash(hash(seed ^ (what << 24)) ^ i as u32);
    let percent = |i: usize, what: u32, share: u32| number(i, what) % 100 < share;
    let intensity = |i: usize, what: u32| 2.0_f32.powi((number(i, what) % 17) as i32 - 8);
    let light = |i| Light { intensity: intensity(i, 1), is_valid: !percent(i, 2, invalid) };
    Case {
        lights: (0..count).map(|i| (!percent(i, 3, empty)).then(|| light(i))).collect(),
        candidates: (0..count).map(|i| (!percent(i, 4, missing)).then(|| 4.0 * intensity(i, 5))).collect(),
        moved,
    }
}

#[test]
fn replacement_is_that_of_sorting() {
    let shares = [[0, 0, 0], [0, 1, 0], [0, 30, 10], [100, 0, 20], [20, 5, 90], [0, 100, 0], [0, 10, 100]];
    let mut most = 0;
    for (seed, count) in [(1, 1), (2, 2), (3, 64), (4, 255), (5, 256), (6, 700)] {
        for share in shares {
            for moved in [0, 1, 16, 1000] {
                let Some(replaced) = random(count, seed, share, moved).check() else { return };
                assert!(replaced <= moved as usize, "{replaced} of {moved}");
                most = most.max(replaced);
            }
        }
    }
    assert!(most > 500, "{most}");
}

/// More lights give way up to the last iteration before the first frame, and no later, and candidates need not outshine as many.
#[test]
fn lights_are_replaced_in_haste_before_the_first_frame() {
    let case = random(613, 7, [0, 3, 10], 16);
    let mut replaced = Vec::new();
    // The iteration is number 42.
    for (warm_up, moved, quantile) in [(42, 48, 0.85), (41, 16, 0.95)] {
        let Some(count) = case.check_with(&[("haste", 3), ("warm_up", warm_up)], moved, quantile) else {
            return;
        };
        replaced.push(count);
    }
    assert_eq!(replaced, [48, 16]);
}

/// One light in twenty may be outshone by a candidate; it is the weakest that goes.
#[test]
fn lights_give_way_where_candidates_outshine_nearly_all() {
    let light = |intensity| Some(Light { intensity, is_valid: true });
    let lights: Vec<_> = (0..100).map(|i| light(2.0_f32.powi(i % 50 / 5))).collect();
    let with = |strongest: f32| {
        let mut candidates = vec![Some(0.5); 100];
        candidates[30] = Some(strongest);
        Case { lights: lights.clone(), candidates, moved: 16 }
    };
    // The greatest intensity is 2⁹, that of a tenth.
    assert_eq!(newcomers(&lights, &with(512.0).candidates, 16, 0.95), vec![None; 100]);
    let mut expected = vec![None; 100];
    expected[0] = Some(30);
    assert_eq!(newcomers(&lights, &with(1024.0).candidates, 16, 0.95), expected);
    for (strongest, replaced) in [(512.0, 0), (1024.0, 1)] {
        let Some(found) = with(strongest).check() else { return };
        assert_eq!(found, replaced);
    }
}

/// Without a candidate a light stays, also where it reaches nothing in view: the lights do not die out.
#[test]
fn where_nothing_is_seen_lights_stay() {
    let mut case = random(128, 9, [0, 100, 100], 16);
    let Some(replaced) = case.check() else { return };
    assert_eq!(replaced, 0);
    // Candidates that are black take the places of lights that reach nothing.
    case.candidates = vec![Some(0.0); 128];
    assert_eq!(case.check(), Some(16));
}

/// Intensities that are NaN or infinite neither stop the frame nor are chosen before finite and strong ones.
#[test]
fn intensities_that_are_no_numbers_count_as_none() {
    let mut case = random(64, 4, [0, 0, 0], 4);
    case.candidates = vec![Some(0.25); 64];
    case.candidates[5] = Some(f32::NAN);
    case.candidates[6] = Some(f32::INFINITY);
    let Some(outputs) = case.run() else { return };
    let (header, replaced) = outputs.surface_points("replaced");
    assert_eq!(header.marked, 1);
    assert!(replaced.iter().any(|point| point.seed == SEEDS[2] + 6));
    assert!(replaced.iter().all(|point| point.seed != SEEDS[2] + 5));
}

/// A light has a mailbox: where one of the two was reset, neither is kept.
#[test]
fn lights_without_mailboxes_end() {
    let mut case = random(64, 4, [0, 0, 100], 4);
    case.moved = 0;
    let Some(outputs) = case.run_with(|mailboxes| mailboxes[..4].fill(0), &[]) else { return };
    for port in ["replaced", "witnesses"] {
        let (_, points) = outputs.surface_points(port);
        assert!(points.iter().all(|point| *point == SurfacePoint::NONE), "{port}");
    }
}
