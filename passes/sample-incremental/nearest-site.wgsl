// The nearest of the sites of a source, by all pairs.

#import "slots.wgsl"

var<storage, read_write> sites: array<Site>;

fn squared_distance(a: vec3<f32>, b: vec3<f32>) -> f32 {
    let way = a - b;
    return dot(way, way);
}

/// The site nearest to a place, of those of a source but one slot; of equals, the first.
fn nearest_site(place: vec3<f32>, share: Share, without: u32) -> Nearest {
    var nearest = Nearest(NOTHING_NEAR, NO_SLOT);
    for (var i = share.first; i < min(share.end, arrayLength(&sites)); i++) {
        let distance = squared_distance(sites[i].place, place);
        if distance < nearest.distance && i != without {
            nearest = Nearest(distance, i);
        }
    }
    return nearest;
}
