// The order in which lights give way to candidates. [SMC-IR Alg. 1, lines 9-16]

/// The key of what is not there.
const NO_KEY: u32 = 0xffffffffu;

/// Set in the key of a light that reaches what is in view, as far as is known: intensities are positive, and have no sign.
const VALID: u32 = 0x80000000u;

/// What replaces what.
struct Decision {
    /// Lights that give way.
    removed: u32,
    /// Candidates that become lights.
    chosen: u32,
}
