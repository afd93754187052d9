// The state of select.wgsl.

const SELECT_DIGITS: u32 = 256u;

struct Selection {
    /// The digits that are known.
    key: u32,
    /// First bit of the digit that is looked for.
    shift: u32,
    /// Rank among the elements that share the digits that are known.
    rank: u32,
    /// [digits] How many of those have a digit.
    counts: array<atomic<u32>, SELECT_DIGITS>,
}
