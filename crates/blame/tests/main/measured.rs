//! Error, the map and what has changed, of pictures whose error is known.

use blame::{
    Cell, Game, Map, Owing, Pictures, Player, References, Shares, Stage, Subset, Weights, blamed, rows, table,
};
use metrics::Image;

const SIZE: (usize, usize) = (12, 8);

/// A picture that is 1 everywhere, plus an error of each pixel.
fn picture(error: impl Fn(usize, usize) -> f32) -> Image {
    Image::from_fn(SIZE.0, SIZE.1, |x, y| {
        let value = 1.0 + error(x, y);
        [value, value, value, 1.0]
    })
    .unwrap()
}

fn player(name: &str, frames: u32) -> Player {
    Player {
        name: name.to_owned(),
        doc: format!("no {name}"),
        passes: vec![name.to_owned()],
        changes: Vec::new(),
        reference: Vec::new(),
        frames,
    }
}

/// References of 1 with noise of ±`noise`, opposite in both halves.
fn references(noise: f32) -> (References, Weights) {
    let halves = [noise, -noise].map(|noise| picture(|x, y| if (x + y) % 2 == 0 { noise } else { -noise }));
    let weights = Weights::relative_to(&picture(|_, _| 0.0));
    (References::new(halves, &weights).unwrap(), weights)
}

#[test]
fn bias_and_variance_are_those_of_the_pictures() {
    let (references, weights) = references(0.0);
    // Bias 0.1, and ±0.2 in turn: with a mean of 0 over the seeds, the variance is 0.04 · 4/3.
    let images = [0.2, -0.2, 0.2, -0.2].map(|noise| picture(|_, _| 0.1 + noise)).to_vec();
    let cell = Pictures { images, ms: vec![1.0; 4] }.cell(&references, &weights).unwrap();
    let mean = |values: &[f64]| values.iter().sum::<f64>() / values.len() as f64;
    let epsilon = 1.01;
    let variance = 0.04 * 4.0 / 3.0;
    assert!((mean(&cell.variance) - variance / epsilon).abs() < 1e-6, "{cell:?}");
    assert!((mean(&cell.bias_squared) - (0.01 - variance / 4.0) / epsilon).abs() < 1e-6, "{cell:?}");
    assert!((mean(&cell.energy) - 1.1).abs() < 1e-6);
}

#[test]
fn noise_of_the_reference_is_no_bias() {
    let (references, weights) = references(0.3);
    let images = vec![references.mean().clone(); 3];
    let cell = Pictures { images, ms: Vec::new() }.cell(&references, &weights).unwrap();
    // The mean of both halves is exact here, and known to be so only up to its own noise.
    assert!(cell.bias_squared.iter().all(|bias| (bias + 0.09 / 1.01).abs() < 1e-6), "{cell:?}");
}

/// Two players, of which each owes the error of one half of the picture.
fn halves() -> (Vec<Player>, Vec<(Pictures, References)>, Weights) {
    let (references, weights) = references(0.0);
    let cells = (0..4_u32).map(|exact: Subset| {
        let error = move |x: usize, _: usize| {
            let left = x < SIZE.0 / 2;
            match (left, exact & 1 == 0, exact & 2 == 0) {
                (true, true, _) => 0.5,
                (false, _, true) => 0.25,
                _ => 0.0,
            }
        };
        let images = vec![picture(error); 3];
        (Pictures { images, ms: vec![f64::from(4 - exact); 3] }, references.clone())
    });
    (vec![player("left", 1), player("right", 1)], cells.collect(), weights)
}

fn shares_of(
    players: &[Player],
    cells: &[(Pictures, References)],
    weights: &Weights,
    stages: &[Stage],
) -> Shares {
    let game = Game::new(players.len(), 6, 0);
    let measured: Vec<Cell> =
        cells.iter().map(|(pictures, references)| pictures.cell(references, weights).unwrap()).collect();
    let owing = Owing {
        players: players.iter().map(|player| player.passes.clone()).collect(),
        rest: vec!["view".to_owned()],
    };
    table(&game, players, &owing, stages, &|subset| measured[subset as usize].clone())
}

#[test]
fn shares_add_up_and_the_map_says_where() {
    let (players, cells, weights) = halves();
    let shares = shares_of(&players, &cells, &weights, &[]);
    let names: Vec<&str> = shares.rows.iter().map(|row| row.name.as_str()).collect();
    assert_eq!(names, ["left", "right"]);
    assert!((shares.rows[0].error.mean - 0.125 / 1.01).abs() < 1e-6, "{:?}", shares.rows);
    assert!((shares.rows[1].error.mean - 0.031_25 / 1.01).abs() < 1e-6);
    let sum: f64 = shares.rows.iter().map(|row| row.error.mean).sum::<f64>() + shares.rest.error.mean;
    assert!((sum - shares.whole.error.mean).abs() < 1e-12);
    // Time falls from 4 to 1 ms: what rows save is negative.
    let saved: f64 = shares.rows.iter().map(|row| row.saves.unwrap().mean).sum();
    assert!((shares.rest.saves.unwrap().mean - saved - shares.whole.saves.unwrap().mean).abs() < 1e-9);

    let game = Game::new(2, 6, 0);
    let pairs: Vec<(&Pictures, &References)> =
        cells.iter().map(|(pictures, references)| (pictures, references)).collect();
    let map = Map::new(&game, &players, SIZE, &pairs, &weights, &|subset| subset as usize);
    for y in 0..SIZE.1 {
        // Three pixels and more from the middle no window reaches over it.
        assert_eq!(map.owner[y * SIZE.0 + 2], Some(0));
        assert_eq!(map.owner[y * SIZE.0 + 9], Some(1));
    }
    assert!((map.error[2] - 0.5 / 1.01_f32.sqrt()).abs() < 1e-5 && (map.error[9] - 0.25).abs() < 0.01);
}

#[test]
fn the_mean_of_many_frames_takes_the_noise_away() {
    let (references, weights) = references(0.0);
    let images = [0.2, -0.2, 0.2, -0.2].map(|noise| picture(|_, _| noise)).to_vec();
    let cell = (Pictures { images, ms: vec![1.0; 4] }, references);
    let players = [player("one frame", blame::FRAMES)];
    let shares = shares_of(&players, &[cell.clone(), cell], &weights, &[]);
    let (row, whole) = (&shares.rows[0], &shares.whole);
    assert!((row.variance.mean - whole.variance.mean * 15.0 / 16.0).abs() < 1e-9);
    assert_eq!(row.bias_squared.mean, 0.0);
    assert!((shares.rest.saves.unwrap().mean - 16.0).abs() < 1e-9);
}

#[test]
fn stages_share_what_is_left() {
    let (players, cells, weights) = halves();
    let cell = |bias: f64, energy: f64| Cell {
        bias_squared: vec![bias; 3],
        variance: vec![9.0; 3],
        energy: vec![energy; 3],
        ms: Vec::new(),
    };
    let stage = Stage {
        name: "lights".to_owned(),
        doc: String::new(),
        passes: vec!["lights".to_owned()],
        cells: [cell(0.5, 1.1), cell(0.1, 1.0)],
    };
    let without = shares_of(&players, &cells, &weights, &[]);
    let shares = shares_of(&players, &cells, &weights, &[stage]);
    let row = shares.rows.iter().find(|row| row.name == "lights").unwrap();
    assert!((row.error.mean - 0.4).abs() < 1e-12 && (row.energy.mean - 0.1).abs() < 1e-12);
    assert!((shares.rest.bias_squared.mean - without.rest.bias_squared.mean + 0.4).abs() < 1e-12);
    let sum: f64 = shares.rows.iter().map(|row| row.error.mean).sum::<f64>() + shares.rest.error.mean;
    assert!((sum - shares.whole.error.mean).abs() < 1e-12);
}

#[test]
fn a_row_names_few_of_many_passes() {
    let (players, cells, weights) = halves();
    let mut shares = shares_of(&players, &cells, &weights, &[]);
    let mut named = |count: usize| {
        shares.rest.passes = (0..count).map(|i| format!("p{i}")).collect();
        rows(&shares, false).text()
    };
    assert!(named(5).contains("p0, p1, p2, p3, p4 "), "{}", named(5));
    let many = named(20);
    assert!(many.contains("p0, p1, p2, p3 and 16 more ") && !many.contains("p4"), "{many}");
}

#[test]
fn a_change_is_owed_to_what_has_changed() {
    let (players, cells, weights) = halves();
    let before = shares_of(&players, &cells, &weights, &[]);
    assert_eq!(before.changes(&before), []);
    let mut brighter = cells.clone();
    // The error of the right half grows where the second player is not exact.
    for (pictures, _) in &mut brighter[..2] {
        for (seed, image) in pictures.images.iter_mut().enumerate() {
            let width = image.width();
            for (at, pixel) in image.pixels_mut().iter_mut().enumerate() {
                if at % width >= SIZE.0 / 2 {
                    pixel[..3].iter_mut().for_each(|value| *value += 0.25 + 0.001 * seed as f32);
                }
            }
        }
    }
    let changes = shares_of(&players, &brighter, &weights, &[]).changes(&before);
    let names: Vec<&str> = blamed(&changes).iter().map(|change| change.name.as_str()).collect();
    assert_eq!(names, ["right"], "{changes:?}");
    assert!(changes[0].error.mean > 0.05 && changes[0].energy.mean > 0.1, "{changes:?}");
}
