//! Densities against all pairs in double precision, and against what a known density gives.

mod cpu_reference;

use cpu_reference::{consistent_k, density};
use interfaces::surface_points::SurfacePoint;
use nearest_neighbours::PASS;
use pass_test::Harness;
use pass_test::random::{hash2, unit_float};

/// The area of the scene `plane` \[m²\].
const AREA: f64 = 4.0;

fn run(harness: Harness<'_>) -> Option<Vec<f32>> {
    let outputs = harness.run()?;
    let mut found: Vec<f32> = outputs.read("density");
    // A buffer may be larger.
    found.truncate(outputs.fact("density", "count").as_u32()? as usize);
    Some(found)
}

fn at(position: [f64; 3]) -> SurfacePoint {
    SurfacePoint { position: position.map(|x| x as f32), normal: [0.0, 1.0, 0.0], ..SurfacePoint::default() }
}

fn random(i: u32, seed: u32) -> [f64; 3] {
    [0, 1, 2].map(|dimension| unit_float(hash2(hash2(seed, dimension), i)))
}

/// Points in a square of 1 m.
fn square(count: u32, seed: u32) -> Vec<SurfacePoint> {
    (0..count).map(|i| random(i, seed)).map(|[x, z, _]| at([x, 0.0, z])).collect()
}

/// Points on a floor and two walls, here and there in clusters, some of them in one place and some empty.
fn scattered(count: u32, seed: u32) -> Vec<SurfacePoint> {
    let point = |i: u32| {
        let [u, v, w] = random(i, seed);
        let narrow = if w < 0.3 { 0.01 } else { 1.0 };
        let (u, v) = (u * narrow, v * narrow * narrow);
        let position = match i % 3 {
            0 => [u, 0.0, v],
            1 => [0.0, u, v],
            _ => [u, v, 1.0],
        };
        match i % 11 {
            0 => SurfacePoint::NONE,
            1 => at([0.25, 0.5, 0.25]),
            _ => at(position),
        }
    };
    (0..count).map(point).collect()
}

/// Density of each point by definition; `own` leaves the point itself out.
fn by_definition(points: &[SurfacePoint], among: &[SurfacePoint], own: bool, k: u32) -> Vec<f64> {
    let count = among.iter().filter(|point| !point.is_none()).count() as u32;
    let k = if k == 0 { consistent_k(count) } else { k };
    let of = |(i, point): (usize, &SurfacePoint)| {
        if point.is_none() {
            return 0.0;
        }
        let others = among.iter().enumerate().filter(|(j, other)| !(other.is_none() || own && *j == i));
        let squared = others.map(|(_, other)| {
            let off = |axis: usize| f64::from(other.position[axis]) - f64::from(point.position[axis]);
            (0..3).map(|axis| off(axis).powi(2)).sum()
        });
        density(squared, k, count, AREA)
    };
    points.iter().enumerate().map(of).collect()
}

fn assert_near(found: &[f32], expected: &[f64], case: &str) {
    assert_eq!(found.len(), expected.len(), "{case}");
    for (i, (found, expected)) in std::iter::zip(found, expected).enumerate() {
        let found = f64::from(*found);
        assert!(
            found.is_finite() && (found - expected).abs() <= 1e-5 * expected,
            "{case}, {i}: {found} for {expected}"
        );
    }
}

/// The densities, which both structures give to the bit.
fn both(harness: impl Fn() -> Harness<'static>) -> Option<Vec<f32>> {
    let pairs = run(harness().set("structure", "pairs"))?;
    let tree = run(harness().set("structure", "tree"))?;
    let bits = |densities: &[f32]| densities.iter().map(|p| p.to_bits()).collect::<Vec<u32>>();
    let differ = std::iter::zip(bits(&pairs), bits(&tree)).filter(|(a, b)| a != b).count();
    assert_eq!(differ, 0, "of {} densities", pairs.len());
    Some(pairs)
}

fn harness(points: &[SurfacePoint], among: Option<&[SurfacePoint]>) -> Harness<'static> {
    let harness = Harness::new(PASS).scene("plane").surface_points("points", 3, points);
    match among {
        Some(among) => harness.surface_points("among", 3, among),
        None => harness,
    }
}

#[test]
fn every_variant_of_the_shaders_is_valid() {
    pass_test::assert_shaders_are_valid(PASS);
}

#[test]
fn densities_are_those_of_all_pairs() {
    let all = [0, 1, 2, 4, 5, 6, 9, 32].as_slice();
    for (count, neighbours) in [(1, &all[..2]), (2, &all[..3]), (3, &[1, 2, 32]), (700, all), (1500, &[1, 6])]
    {
        let points = scattered(count, count);
        for k in neighbours.iter().copied() {
            let Some(found) = both(|| harness(&points, None).set("k", k)) else { return };
            assert_near(
                &found,
                &by_definition(&points, &points, true, k),
                &format!("{count} points, k = {k}"),
            );
        }
    }
}

#[test]
fn neighbours_may_be_other_points() {
    for (queries, count) in [(300, 1), (700, 900), (5, 3000), (1, 300)] {
        let (points, among) = (scattered(queries, 1), scattered(count, 2));
        for k in [1, 2, 6] {
            let Some(found) = both(|| harness(&points, Some(&among)).set("k", k)) else { return };
            assert_near(
                &found,
                &by_definition(&points, &among, false, k),
                &format!("{queries} of {count}, k = {k}"),
            );
        }
    }
    // Far from all of them, and on the other side of the origin.
    let (far, among) = ([at([900.0, -300.0, 0.5]), at([-70.0, 0.5, 0.5])], scattered(500, 3));
    let Some(found) = both(|| harness(&far, Some(&among)).set("k", 3u32)) else { return };
    assert_near(&found, &by_definition(&far, &among, false, 3), "far away");
}

/// Points that are fewer than there is room for: what lies behind them is no neighbour, and has no density.
#[test]
fn room_behind_the_points_counts_for_nothing() {
    let (points, among) = (scattered(300, 1), scattered(700, 2));
    let with_room = |among: Option<&[SurfacePoint]>| {
        let harness = Harness::new(PASS).scene("plane");
        let harness = harness.surface_points_before("points", 3, &points, &scattered(700, 3));
        match among {
            Some(among) => harness.surface_points_before("among", 3, among, &scattered(1300, 4)),
            None => harness,
        }
    };
    for among in [None, Some(&*among)] {
        for k in [1, 6] {
            let Some(found) = both(|| with_room(among).set("k", k)) else { return };
            let case = format!("k = {k}, among others: {}", among.is_some());
            let expected = by_definition(&points, among.unwrap_or(&points), among.is_none(), k);
            assert_near(&found[..300], &expected, &case);
            assert_eq!(found[300..], [0.0; 700], "{case}");
        }
    }
    let expected = owners_by_definition(&points, &among, false);
    for structure in ["pairs", "tree"] {
        let harness = with_room(Some(&among)).set("structure", structure).set("owners", true);
        let Some(outputs) = harness.run() else { return };
        let found: Vec<u32> = outputs.read("owners");
        assert_eq!(found[..300], expected, "{structure}");
        assert_eq!(found[300..1000], [u32::MAX; 700], "{structure}");
    }
}

/// More neighbours than one dispatch takes.
#[test]
fn searches_are_cut_into_several_dispatches() {
    let (points, among) = (scattered(300, 1), scattered(40_000, 2));
    for k in [0, 1, 32] {
        let Some(found) = both(|| harness(&points, Some(&among)).set("k", k)) else { return };
        assert_near(&found, &by_definition(&points, &among, false, k), &format!("k = {k}"));
    }
}

#[test]
fn one_point_may_be_anywhere() {
    for points in [vec![at([0.5; 3])], vec![SurfacePoint::NONE, at([0.5; 3])], vec![at([0.5; 3]); 7]] {
        let expected: Vec<f64> = points.iter().map(|p| if p.is_none() { 0.0 } else { 1.0 / AREA }).collect();
        let Some(found) = both(|| harness(&points, None)) else { return };
        assert_near(&found, &expected, "all in one place");
    }
    let none = [SurfacePoint::NONE; 3];
    let Some(found) = both(|| harness(&none, None)) else { return };
    assert_eq!(found, [0.0; 3]);
    let found = both(|| harness(&[at([0.5; 3])], Some(&none))).unwrap();
    assert_near(&found, &[1.0 / AREA], "there is none");
}

/// Both sides of a wall of 1 mm: without `sides`, the nearest neighbour is behind it.
#[test]
fn sides_of_a_wall_count_apart() {
    let grid = |i: u32| [f64::from(i % 8) * 0.1, 0.0, f64::from(i / 8) * 0.1];
    let front: Vec<SurfacePoint> = (0..64).map(|i| at(grid(i))).collect();
    let behind = front.iter().map(|point| {
        let [x, _, z] = point.position;
        SurfacePoint { position: [x, -0.001, z], normal: [0.0, -1.0, 0.0], ..*point }
    });
    let points: Vec<SurfacePoint> = front.iter().copied().chain(behind).collect();
    for (sides, distance) in [(false, 0.001), (true, 0.1)] {
        let Some(found) = both(|| harness(&points, None).set("sides", sides)) else { return };
        let expected = 1.0 / (128.0 * std::f64::consts::PI * distance * distance);
        for p in found {
            assert!((f64::from(p) / expected - 1.0).abs() < 1e-4, "sides: {sides}: {p} for {expected}");
        }
    }
}

/// The owner of each point by definition: what is nearest, of equals the first, whether or not it is in the same place; with
/// `sides`, of those that face the same way.
fn owners_by_definition(points: &[SurfacePoint], among: &[SurfacePoint], sides: bool) -> Vec<u32> {
    let of = |point: &SurfacePoint| {
        let faces = |other: &SurfacePoint| {
            !sides || std::iter::zip(point.normal, other.normal).map(|(a, b)| a * b).sum::<f32>() > 0.5
        };
        let squared = |other: &SurfacePoint| -> f32 {
            (0..3).map(|axis| (other.position[axis] - point.position[axis]).powi(2)).sum()
        };
        let others = among.iter().enumerate().filter(|(_, other)| !other.is_none() && faces(other));
        let nearest = others.min_by(|(_, a), (_, b)| squared(a).total_cmp(&squared(b)));
        nearest.filter(|_| !point.is_none()).map_or(u32::MAX, |(index, _)| index as u32)
    };
    points.iter().map(of).collect()
}

/// Also where many are equally near, where many or all are in one place, and where neighbours take several dispatches. Normals are
/// along axes; nothing among the last faces upwards.
#[test]
fn owners_are_the_nearest() {
    let coarse = |count, seed| -> Vec<SurfacePoint> {
        let mut points = scattered(count, seed);
        for (i, point) in points.iter_mut().enumerate() {
            point.position = point.position.map(|x| (x * 8.0).round() / 8.0);
            point.normal = [[1.0, 0.0, 0.0], [-1.0, 0.0, 0.0], [0.0, -1.0, 0.0], [0.0, 0.0, 1.0]][i % 4];
        }
        points
    };
    let in_one_place = |count: usize| vec![coarse(2, 2)[1]; count];
    let upwards: Vec<SurfacePoint> = scattered(300, 1);
    for (points, among) in [
        (coarse(300, 1), coarse(1, 2)),
        (coarse(700, 1), coarse(900, 2)),
        (coarse(300, 1), coarse(40_000, 2)),
        (coarse(300, 1), in_one_place(3000)),
        (upwards, coarse(40_000, 2)),
    ] {
        for sides in [false, true] {
            let expected = owners_by_definition(&points, &among, sides);
            for (structure, k) in [("pairs", 1), ("tree", 1), ("tree", 6)] {
                let harness = harness(&points, Some(&among)).set("structure", structure).set("k", k);
                let Some(outputs) = harness.set("owners", true).set("sides", sides).run() else { return };
                let found: Vec<u32> = outputs.read("owners");
                assert_eq!(
                    found[..points.len()],
                    expected,
                    "{} of {}, {structure}, sides: {sides}",
                    points.len(),
                    among.len()
                );
            }
        }
    }
}

/// For points that are independent and uniform in a square of 1 m², π r² of the k-th of I - 1 others has the mean k / I (the
/// mean of Beta(k, I - k)), so 1/p has the mean 1 m²: away from the sides.
#[test]
fn the_mean_area_of_uniform_points_is_exact() {
    for k in [1, 6] {
        let (mut sum, mut squares, mut inside) = (0.0, 0.0, 0.0);
        for seed in 0..4 {
            let points = square(4096, seed);
            let Some(found) = run(harness(&points, None).set("k", k)) else { return };
            for (point, p) in std::iter::zip(&points, found) {
                if point.position.iter().step_by(2).all(|x| (0.1..0.9).contains(x)) {
                    let area = 1.0 / f64::from(p);
                    sum += area;
                    squares += area * area;
                    inside += 1.0;
                }
            }
        }
        let mean: f64 = sum / inside;
        let deviation = (squares / inside - mean * mean).sqrt();
        // Areas of the k-th neighbour are Gamma distributed, with the relative spread k^-½; neighbours share theirs.
        assert!((deviation * f64::from(k).sqrt() - 1.0).abs() < 0.1, "k = {k}: spread {deviation}");
        let error = deviation * (f64::from(2 * k) / inside).sqrt();
        assert!((mean - 1.0).abs() < 4.0 * error, "k = {k}: {mean} ± {error}");
    }
}

/// Lengths scale with the scene: the density is its inverse square.
#[test]
fn scenes_may_have_any_size() {
    let points = scattered(400, 9);
    let Some(metres) = both(|| harness(&points, None).set("k", 2u32)) else { return };
    for scale in [2f32.powi(-20), 2f32.powi(-10), 2f32.powi(13), 2f32.powi(20)] {
        let scaled: Vec<SurfacePoint> =
            points.iter().map(|p| SurfacePoint { position: p.position.map(|x| x * scale), ..*p }).collect();
        let scene = pass_test::scene_from(&format!(
            "Scene(geometry: Objects([Object(name: \"plane\", geometry: BuiltIn(\"plane\"), transform: Transform(scale: ({scale:?}, {scale:?}, \
             {scale:?})))]))"
        ));
        let found = both(|| {
            let harness = Harness::new(PASS).with_scene(scene.clone());
            harness.surface_points("points", 0, &scaled).set("k", 2u32)
        });
        for (found, expected) in std::iter::zip(found.unwrap(), &metres) {
            let found = f64::from(found) * f64::from(scale).powi(2);
            assert!((found - f64::from(*expected)).abs() <= 1e-5 * found, "{scale}: {found} for {expected}");
        }
    }
}

#[test]
fn k_grows_with_the_root_of_the_count() {
    for (count, k) in
        [(0, 1), (2048, 1), (4095, 1), (4096, 2), (9215, 2), (9216, 3), (1 << 20, 32), (u32::MAX, 32)]
    {
        assert_eq!(consistent_k(count), k, "{count} points");
    }
    // On the GPU, of those that are not empty.
    for count in [4095, 4096] {
        let mut points = square(count, 1);
        points.extend([SurfacePoint::NONE; 500]);
        let Some(found) = both(|| harness(&points, None)) else { return };
        assert_near(
            &found,
            &by_definition(&points, &points, true, consistent_k(count)),
            "of points that are there",
        );
    }
}

/// How long both structures take, for the README.
#[test]
#[ignore = "a measurement"]
fn measurement() {
    for (queries, count) in [(2048, 2048), (8192, 8192), (32_768, 2048), (32_768, 32_768)] {
        let (points, among) = (square(queries, 1), square(count, 2));
        for structure in ["pairs", "tree"] {
            let timed = |frames: u32| {
                let harness = harness(&points, Some(&among)).set("structure", structure).frames(frames);
                let begin = std::time::Instant::now();
                run(harness.depends_on_thread_order("it is timed")).map(|_| begin.elapsed().as_secs_f64())
            };
            let frames = if queries * count > 1 << 28 { 2 } else { 20 };
            // Compiled once before.
            let (Some(_), Some(one), Some(more)) = (timed(1), timed(1), timed(1 + frames)) else { return };
            println!("{queries} of {count}, {structure}: {:.1} ms", (more - one) / f64::from(frames) * 1e3);
        }
    }
}
