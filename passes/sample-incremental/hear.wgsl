// Takes the site that was placed last into account for each probe.

#import "nearest-site.wgsl"

var<storage, read> shares: array<Share>;
var<storage, read> choice: Choice;
var<storage, read_write> probes: array<Probe>;
/// The slot of the site that is nearest to each probe.
var<storage, read_write> owners: array<u32>;

/// Takes the site that was placed last into account for a probe.
fn hear(index: u32, share: Share) {
    let placed = choice.placed;
    if placed < share.first || placed >= share.end {
        return;
    }
    if owners[index] == placed {
        // It went elsewhere.
        let nearest = nearest_site(probes[index].place, share, NO_SLOT);
        probes[index].distance = nearest.distance;
        owners[index] = nearest.slot;
        return;
    }
    let distance = squared_distance(sites[placed].place, probes[index].place);
    if distance < probes[index].distance || (distance == probes[index].distance && placed < owners[index]) {
        probes[index].distance = distance;
        owners[index] = placed;
    }
}
