// What a pass was requested to produce, and what it produced.

struct Counters {
    /// How many were requested.
    requested: u32,
    /// How many were produced.
    produced: u32,
}
