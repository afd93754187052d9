// What a pass was asked for and could not make all of.

struct Tally {
    /// How many were asked for.
    asked: u32,
    /// How many were made.
    made: u32,
}
