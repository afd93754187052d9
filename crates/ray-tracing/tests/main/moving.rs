//! Refit and rebuild.

use crate::shared::{Mesh, Random};
use glam::Vec3;
use ray_tracing::{Bvh, Refit};

fn assert_same_hits(a: &Bvh, b: &Bvh) {
    let mut hits = 0;
    for ray in Random(7).rays((Vec3::splat(-1.5), Vec3::splat(1.5)), 3000) {
        let distance =
            |bvh: &Bvh| bvh.intersect(ray.origin, ray.direction, 0.0, f32::MAX).map(|hit| hit.distance);
        assert_eq!(distance(a), distance(b), "{ray:?}");
        hits += usize::from(distance(a).is_some());
    }
    assert!(hits > 300, "{hits}");
}

#[test]
fn a_refitted_tree_has_the_hits_of_a_new_one() {
    let rest = Mesh::sphere(20, Vec3::ZERO);
    let mut bvh = rest.bvh();
    let bent = rest.map(|p| Vec3::new(p.x + 0.3 * p.y * p.y, p.y * 1.1, p.z - 0.2 * p.x));
    assert_eq!(bvh.refit(&bent.positions, &bent.indices), Refit::Refitted);
    assert_same_hits(&bvh, &bent.bvh());
}

#[test]
fn triangles_may_lose_and_gain_area() {
    let rest = Mesh::sphere(20, Vec3::ZERO);
    let flat = rest.clone().map(|p| if p.x > 0.0 { Vec3::ZERO } else { p });
    let mut bvh = flat.bvh();
    bvh.refit(&rest.positions, &rest.indices);
    assert_same_hits(&bvh, &rest.bvh());
    bvh.refit(&flat.positions, &flat.indices);
    assert_same_hits(&bvh, &flat.bvh());
}

#[test]
fn a_tree_that_has_become_bad_is_rebuilt() {
    let rest = Mesh::sphere(20, Vec3::ZERO);
    let mut bvh = rest.bvh();
    let cost = bvh.cost();
    // Every vertex in another's place.
    let count = rest.positions.len();
    let mixed = Mesh {
        positions: (0..count).map(|i| rest.positions[i * 367 % count]).collect(),
        indices: rest.indices.clone(),
    };
    assert_eq!(bvh.refit(&mixed.positions, &mixed.indices), Refit::Rebuilt);
    assert_same_hits(&bvh, &mixed.bvh());
    assert_eq!(bvh.cost(), mixed.bvh().cost());
    assert_eq!(
        bvh.refit(&rest.positions, &rest.indices),
        Refit::Refitted,
        "smaller costs less, if not least"
    );
    assert!(bvh.cost() > cost);
}
