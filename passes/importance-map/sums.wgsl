// The two parts of the mixed importance, summed over texels.

#import "algorithms/scaled.wgsl"

struct Sums {
    contribution: Scaled,
    /// Luminance of the reflected flux [W].
    flux: Scaled,
}
