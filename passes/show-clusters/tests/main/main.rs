//! The picture of clusters.

mod cpu_reference;
mod gpu;

use cpu_reference::color_of;
use pass_test::random::hash;
use show_clusters::PASS;

pass_test::shaders_are_valid!(PASS);

#[test]
fn clusters_can_be_told_apart() {
    let colors: Vec<_> = (0..512).map(|i| color_of(i, hash(i))).collect();
    let (mut alike, mut pairs) = (0, 0);
    for (i, a) in colors.iter().enumerate() {
        assert!((*a).min_element() >= 0.05 && a.max_element() <= 1.0, "{a}");
        for b in &colors[i + 1..] {
            pairs += 1;
            alike += u32::from(a.distance(*b) < 0.1);
        }
        for next in colors[i + 1..].iter().take(4) {
            assert!(a.distance(*next) > 0.15, "cluster {i} looks like one of the next: {a} {next}");
        }
    }
    assert!(alike < pairs / 20, "{alike} of {pairs} pairs look alike");
}
