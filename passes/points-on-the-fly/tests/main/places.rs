//! Where samples lie.

use crate::cpu_reference::{ANY_NUMBER, WHOLE, Wanted, place};

#[test]
fn every_map_has_its_samples_spread_over_the_whole() {
    for (maps, per_map) in [(1, 1), (1, 1000), (31, 7), (32, 8), (33, 9), (100, 64), (1024, 3)] {
        let wanted = Wanted::new(maps, per_map, ANY_NUMBER);
        let mut strata = vec![vec![false; per_map as usize]; maps as usize];
        let mut numbers = Vec::new();
        for place in (0..wanted.threads()).filter_map(|index| place(index, &wanted)) {
            // One in each of as many equal parts as the map has samples.
            let part = (u64::from(place.number) * u64::from(per_map) / u64::from(WHOLE)) as usize;
            let seen = &mut strata[place.map as usize][part];
            assert!(!*seen, "map {} has two samples in part {part} of {per_map}", place.map);
            *seen = true;
            numbers.push(place.number);
        }
        assert!(strata.into_iter().flatten().all(|seen| seen), "{maps} maps of {per_map}");
        numbers.sort_unstable();
        numbers.dedup();
        assert_eq!(numbers.len(), (maps * per_map) as usize, "no two maps share a sample");
    }
}

#[test]
fn no_more_samples_than_are_asked_for() {
    // 100 of 4 · 50: half of each map's, over all of the surface.
    let wanted = Wanted::new(4, 50, 100);
    let places: Vec<_> = (0..200).filter_map(|index| place(index, &wanted)).collect();
    assert_eq!(places.len(), 100);
    for map in 0..4 {
        let numbers: Vec<u32> =
            places.iter().filter(|place| place.map == map).map(|place| place.number).collect();
        assert_eq!(numbers.len(), 25);
        assert!(numbers[0] < WHOLE / 25 && numbers[24] > WHOLE / 25 * 24, "map {map}: {numbers:?}");
    }
}

#[test]
fn neighbours_are_near_each_other_and_of_different_maps() {
    let wanted = Wanted::new(1024, 800, ANY_NUMBER);
    for first in [0, 32 * 500, 32 * 800 * 31] {
        let warp: Vec<_> = (first..first + 32).map(|index| place(index, &wanted).unwrap()).collect();
        let (least, most) = (warp[0].number, warp[31].number);
        assert!(most - least < WHOLE / 800 / 16, "32 threads cover a small part of a stratum");
        let mut maps: Vec<u32> = warp.iter().map(|place| place.map).collect();
        maps.dedup();
        assert_eq!(maps.len(), 32);
    }
}
