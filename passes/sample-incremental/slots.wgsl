// Shared by the steps of sample-incremental: slots, which hold one light each; sites, which are where lights lie among the
// directions of their source; probes, which are directions that sites share out among them. [Laine et al. 2007; ACRSM §3.2.3]

const NO_SLOT: u32 = 0xffffffffu;
const NO_SOURCE: u32 = 0xffffffffu;

/// To which source a slot belongs.
struct Share {
    /// Index of the source; NO_SOURCE where none shines.
    source: u32,
    /// The slots of this source: from `first` to before `end`.
    first: u32,
    end: u32,
    /// The factor of fluxes: 1, unless there are more sources than slots.
    weight: f32,
    /// Slots for each unit of the domain's area: a squared distance times this does not depend on the source.
    density: f32,
}

/// The slot has no source.
const SITE_ABSENT: u32 = 0u;
/// The slot is dark until it gets a place.
const SITE_WAITING: u32 = 1u;
/// The light is that of the frame before.
const SITE_KEPT: u32 = 2u;
/// The light is new in this frame.
const SITE_NEW: u32 = 3u;

/// A place that is nearer to nothing than NOTHING_NEAR.
const NOWHERE: vec3<f32> = vec3<f32>(1e15, 1e15, 1e15);

struct Site {
    /// In the domain of its source: see domain.wgsl. NOWHERE for one that is absent or waits.
    place: vec3<f32>,
    /// SITE_…
    state: u32,
}

struct Probe {
    /// In the domain of its source.
    place: vec3<f32>,
    /// Squared distance to the nearest site; NOTHING_NEAR where there is none.
    distance: f32,
}

/// The content of the cell of a site.
struct Cell {
    probes: u32,
    /// Sum of what the source gives to its probes: see `shine_unit`.
    shine: u32,
}

/// Squared distance where there is no site.
const NOTHING_NEAR: f32 = 1e20;

/// The site that is nearest to a place.
struct Nearest {
    /// Squared; NOTHING_NEAR where there is none.
    distance: f32,
    slot: u32,
}

/// Nothing more is placed in this frame.
const CHOICE_REST: u32 = 0u;
/// The emptiest place of the sources that have a slot that waits is filled.
const CHOICE_FILL: u32 = 1u;
/// A crowded light goes to the emptiest place of its source.
const CHOICE_CROWD: u32 = 2u;

/// The next placement.
struct Choice {
    /// CHOICE_…
    mode: u32,
    /// The slot whose light is crowded.
    slot: u32,
    /// Distance to its nearest neighbour, squared and times the density: what a new place has to exceed.
    crowd: f32,
    /// The slot that was placed last, which the probes do not take into account yet; NO_SLOT for none.
    placed: u32,
    /// Lights that are new in this frame.
    new_lights: u32,
}

/// The place that is farthest from all sites, of some probes.
struct Hole {
    /// Squared distance times the density; negative where there is no probe.
    key: f32,
    probe: u32,
}

/// The count of a probe to which the source gives all of its intensity, so that no sum overflows.
fn shine_unit(probes: u32) -> u32 {
    return min(0x10000u, 0xffffffffu / max(probes, 1u));
}
