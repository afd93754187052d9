// The interface Counters: the number of results that a pass was requested to produce, and that it produced.

struct Counters {
    /// How many were requested.
    requested: u32,
    /// How many were produced.
    produced: u32,
}
