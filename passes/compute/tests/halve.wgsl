#import "dispatch.wgsl"

struct Settings {
    /// What each number is divided by. [default: 2.0, min: 0.5]
    divisor: f32,
    /// Whether it is done. [default: "yes", one_of: ["yes", "no", "twice"]]
    done: u32,
}

var<uniform> settings: Settings;
var<storage, read> numbers: array<f32>;
var<storage, read_write> halves: array<f32, 100>;

@compute @workgroup_size(64)
fn halve(row: Row) {
    let i = index_in(row, 64u);
    // The last number is left out, to see that it is zero.
    if i < 99u {
        // A word is its position among its pass type.
        let divisors = array(settings.divisor, 1.0, settings.divisor * settings.divisor);
        halves[i] = numbers[i] / divisors[settings.done];
    }
}
