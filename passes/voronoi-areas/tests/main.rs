//! Areas against closed forms.

use interfaces::areas::PointArea;
use interfaces::surface_points::SurfacePoint;
use pass_test::{Harness, Outputs, elements};
use voronoi_areas::PASS;

/// The area of the scene `plane` \[m²\].
const AREA: f64 = 4.0;

fn point(seed: u32) -> SurfacePoint {
    SurfacePoint { seed, triangle: 0, ..SurfacePoint::default() }
}

struct Samples {
    points: Vec<SurfacePoint>,
    density: Vec<f32>,
    owners: Vec<u32>,
}

impl Samples {
    /// Samples of a density that belong to points in turn.
    fn in_turn(count: u32, density: f64, points: u32) -> Samples {
        Samples {
            points: (0..count).map(point).collect(),
            density: vec![density as f32; count as usize],
            owners: (0..count).map(|i| i % points).collect(),
        }
    }
}

fn run(
    points: &[SurfacePoint],
    samples: &Samples,
    past: Option<&[PointArea]>,
    frames: u32,
) -> Option<Outputs> {
    let facts = &[("count", samples.points.len() as u32)];
    let mut harness = Harness::new(PASS)
        .scene("plane")
        .set("frames", frames)
        .surface_points("points", 3, points)
        .surface_points("samples", 3, &samples.points)
        .input("sample_density", "Density", facts, elements(&samples.density))
        .input("owners", "Owners", facts, elements(&samples.owners));
    if let Some(past) = past {
        harness = harness.past("past", "Areas", 1, elements(past)).fact("count", past.len() as u32);
    }
    harness.run()
}

fn areas(outputs: &Outputs, count: usize) -> Vec<PointArea> {
    outputs.read::<PointArea>("areas")[..count].to_vec()
}

pass_test::shaders_are_valid!(PASS);

/// Samples of uniform density stand for the same area each, and a point for those that it has. N points of area A have the
/// density 1 / (N A).
#[test]
fn points_stand_for_their_samples() {
    let points: Vec<SurfacePoint> = (0..100).map(point).collect();
    let mut samples = Samples::in_turn(10_000, 1.0 / AREA, 100);
    // The first point has the samples of the second too.
    samples.owners.iter_mut().filter(|owner| **owner == 1).for_each(|owner| *owner = 0);
    let Some(outputs) = run(&points, &samples, None, 32) else { return };
    let density: Vec<f32> = outputs.read("density");
    for (i, found) in areas(&outputs, 100).iter().enumerate() {
        let cells = [2.0, 0.0].get(i).copied().unwrap_or(1.0);
        let wanted = AREA / 100.0 * cells;
        assert!((f64::from(found.area) - wanted).abs() < 1e-6 * AREA, "{i}: {found:?} for {wanted}");
        assert_eq!((found.seed, found.frames), (i as u32, 1));
        let dense = f64::from(density[i]) * 100.0 * wanted;
        assert!(if cells == 0.0 { density[i] > 9e36 } else { (dense - 1.0).abs() < 1e-5 }, "{i}: {dense}");
    }
}

/// Whatever the densities, and over ten powers of ten of them, the sum is that of 1 / (N p).
#[test]
fn areas_add_up() {
    let points: Vec<SurfacePoint> = (0..37).map(point).collect();
    let mut samples = Samples::in_turn(5000, 1.0, 37);
    for (i, density) in samples.density.iter_mut().enumerate() {
        *density = 10f32.powf((i % 101) as f32 * 0.1 - 3.0);
    }
    // These are not there, or belong to nobody.
    for i in (0..5000).step_by(7) {
        samples.points[i] = SurfacePoint::NONE;
    }
    for i in (0..5000).step_by(11) {
        samples.owners[i] = u32::MAX;
    }
    let Some(outputs) = run(&points, &samples, None, 32) else { return };
    let there = |i: &usize| !samples.points[*i].is_none();
    let present = (0..5000).filter(there).count() as f64;
    let owned = (0..5000).filter(|i| there(i) && samples.owners[*i] != u32::MAX);
    let wanted: f64 = owned.map(|i| (1.0 / (present * f64::from(samples.density[i]))).min(AREA)).sum();
    let found: f64 = areas(&outputs, 37).iter().map(|found| f64::from(found.area)).sum();
    assert!((found / wanted - 1.0).abs() < 1e-5, "{found} for {wanted}");
}

/// An area is the mean over the frames in which its point was there, of the last `frames` of them as a decaying one. A point
/// of another seed begins again.
#[test]
fn areas_are_means_over_frames() {
    let points: Vec<SurfacePoint> = (0..4).map(point).chain([SurfacePoint::NONE]).collect();
    let samples = Samples::in_turn(1000, 1.0 / AREA, 4);
    let own = AREA as f32 / 4.0;
    let area = |seed, frames, area| PointArea { seed, frames, area, pad: 0 };
    let past = [area(0, 1, 0.0), area(1, 9, 0.5), area(99, 9, 0.5), area(3, 0, 0.5), area(4, 9, 0.5)];
    let Some(outputs) = run(&points, &samples, Some(&past), 8) else { return };
    let wanted = [
        area(0, 2, own * 0.5),
        area(1, 8, 0.5 + (own - 0.5) / 8.0),
        area(2, 1, own),
        area(3, 1, own),
        area(0, 0, 0.0),
    ];
    for (found, wanted) in areas(&outputs, 5).iter().zip(wanted) {
        assert!((found.area - wanted.area).abs() < 1e-6, "{found:?} for {wanted:?}");
        assert_eq!((found.seed, found.frames), (wanted.seed, wanted.frames));
    }
    assert_eq!(outputs.read::<f32>("density")[4], 0.0, "there is no point");
}

#[test]
fn extremes_stay_finite() {
    let points = [point(0), SurfacePoint::NONE];
    for density in [0.0, 1e-38, 3e38, f32::INFINITY, f32::NAN] {
        let mut samples = Samples::in_turn(10, 1.0, 2);
        samples.density.fill(density);
        let Some(outputs) = run(&points, &samples, None, 1) else { return };
        for found in areas(&outputs, 2) {
            assert!((0.0..=10.0 * AREA).contains(&f64::from(found.area)), "{density}: {found:?}");
        }
        let found: Vec<f32> = outputs.read("density");
        assert!(found[0].is_finite() && found[0] > 0.0 && found[1] == 0.0, "{density}: {found:?}");
    }
    let none = [SurfacePoint::NONE; 3];
    let nothing = Samples { points: none.to_vec(), density: vec![0.0; 3], owners: vec![u32::MAX; 3] };
    let Some(outputs) = run(&none, &nothing, None, 1) else { return };
    assert_eq!(outputs.read::<f32>("density")[..3], [0.0; 3]);
}
