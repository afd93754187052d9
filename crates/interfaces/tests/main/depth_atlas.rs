//! How splatted maps are split into runs that a step can bind.

use interfaces::depth_atlas::windows;

#[test]
fn windows_hold_every_map_once_and_begin_where_they_can_be_bound() {
    for (count, tile) in
        [(1, 1), (5, 1), (130, 3), (300, 8), (4096, 128), (4097, 128), (70, 512), (1 << 20, 64)]
    {
        for block in [1, 4, 32, 128] {
            for most in [1, 70_000, 1 << 20, 128 << 20] {
                let case = format!("{count} maps of {tile}², blocks of {block}, {most} bytes");
                let map = u64::from(tile * tile) * 4;
                let fewest = u64::from(block.max(64));
                let mut next = 0;
                for window in windows(count, tile, block, most) {
                    assert_eq!(window.maps.start, next, "{case}");
                    assert!(!window.maps.is_empty(), "{case}");
                    let (start, end) = (u64::from(window.maps.start) * map, u64::from(window.maps.end) * map);
                    assert_eq!(window.bytes, start..end.next_multiple_of(16), "{case}");
                    assert_eq!((start % 256, window.maps.start % block), (0, 0), "{case}");
                    assert!(end - start <= most.max(fewest * map), "{case}");
                    next = window.maps.end;
                }
                assert_eq!(next, count, "{case}");
            }
        }
    }
    assert_eq!(windows(4096, 128, 1, 128 << 20).len(), 2, "as few as possible");
    assert_eq!(windows(0, 64, 1, 128 << 20), []);
}
