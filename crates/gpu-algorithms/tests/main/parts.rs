//! Dispatches cut into parts.

use gpu_algorithms::parts;

#[test]
fn parts_cover_all_elements_once_and_the_last_is_open() {
    for length in [0, 1, 2, 9, 10, 11, 1000] {
        for most in [0, 1, 3, 10, u32::MAX] {
            let parts: Vec<_> = parts(length, most).collect();
            let mut next = 0;
            for part in &parts {
                assert_eq!(part.begin, next, "{length} by {most}");
                assert!(part.last || part.end - part.begin == most.max(1), "{length} by {most}");
                next = part.end;
            }
            assert_eq!(next, u32::MAX);
            assert_eq!(parts.iter().filter(|part| part.last).count(), 1);
            assert!(parts.iter().all(|part| part.begin < length.max(1)), "{length} by {most}: an empty part");
        }
    }
}
