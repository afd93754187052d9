// What the steps of verify-lights share: how a light stands. [SMC-IR §3.2.2]

/// A light that no point in view has reached so far, and one that needs none: it is known to be reached, or is not there.
/// Others hold the index of the point that reached them.
const UNSEEN: u32 = 0xffffffffu;
const SETTLED: u32 = 0xfffffffeu;

/// The lights that are unseen, and how the next round is dispatched.
struct Round {
    workgroups_x: u32,
    workgroups_y: u32,
    workgroups_z: u32,
    /// How many lights are unseen.
    unseen: u32,
}
