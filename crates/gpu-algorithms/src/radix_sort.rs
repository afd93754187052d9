//! A stable sort of keys and values: `shaders/algorithms/radix-sort.wgsl`.

use crate::{Blocks, scan};
use pass::{Compute, Define, OutputDesc, PassTypeError, Request, ResourceDesc, UseContext, Value};

const SORT: &str = "shaders/algorithms/radix-sort.wgsl";
const OFFSETS: &str = "shaders/algorithms/radix-offsets.wgsl";

/// A stable sort of keys, each a u32, with a value of 32 bits each. Elements with equal keys keep their order.
///
/// Buffers are named as `port` or `port.member`. The keys and values may be in the same buffers to which the sorted
/// ones are written. The time is proportional to `length` and to `bits`.
#[derive(Clone, Copy, Debug)]
pub struct RadixSort<'a> {
    /// The number of elements, at most 2³¹; where there is a count, their greatest number.
    pub length: u32,
    /// A buffer whose first word is the number of elements, such as `VirtualLights`.
    pub count: Option<&'a str>,
    /// The number of low bits of a key that are sorted: the other bits must be 0. Fewer bits are faster; 32 sorts any
    /// keys.
    pub bits: u32,
    /// The keys: `array<u32>`.
    pub keys: &'a str,
    /// The values: `array<u32>`; without them, the value of an element is its index.
    pub values: Option<&'a str>,
    /// The sorted keys, in ascending order: `array<u32>`.
    pub sorted_keys: &'a str,
    /// The values, in the order of their keys: `array<u32>`.
    pub sorted_values: &'a str,
    /// Prefix of the names of the scratch memory.
    pub scratch: &'a str,
}

impl RadixSort<'_> {
    fn offsets(&self, cx: &UseContext<'_>) -> Result<u32, PassTypeError> {
        Ok(digits(cx)? * Blocks::of(cx)?.count(self.length))
    }

    fn scratch_name(&self, part: &str) -> String {
        format!("{}_{part}", self.scratch)
    }

    /// Returns the scratch memory: 8 bytes per element, and little more.
    ///
    /// # Errors
    /// Where the WGSL of the algorithms is refused.
    pub fn scratch(&self, cx: &UseContext<'_>) -> Result<Vec<OutputDesc>, PassTypeError> {
        let offsets = self.offsets(cx)?;
        let buffer = |part, words: u32| {
            OutputDesc::scratch(&self.scratch_name(part), ResourceDesc::buffer(4 * u64::from(words.max(1))))
        };
        let mut scratch =
            vec![buffer("keys", self.length), buffer("values", self.length), buffer("offsets", offsets)];
        scratch.extend(scan::scratch(cx, &self.scratch_name("sums"), offsets)?);
        Ok(scratch)
    }

    /// Returns the steps.
    ///
    /// # Errors
    /// Where the WGSL of the algorithms is refused.
    pub fn steps(&self, cx: &UseContext<'_>) -> Result<Vec<Compute>, PassTypeError> {
        let (blocks, bits_of_digit) = (Blocks::of(cx)?, digits(cx)?.ilog2());
        let count_of_offsets = self.offsets(cx)?;
        let [keys, values, offsets, sums] =
            ["keys", "values", "offsets", "sums"].map(|part| self.scratch_name(part));
        // The passes go to and fro between scratch and result. Their number is even, so that the last writes the result
        // and the first may read it.
        let passes = 2 * self.bits.clamp(1, 32).div_ceil(2 * bits_of_digit);
        let mut steps = Vec::new();
        for pass in 0..passes {
            let (from, to) = match pass {
                0 => ((self.keys, self.values), (&*keys, &*values)),
                odd if odd % 2 == 1 => ((&*keys, Some(&*values)), (self.sorted_keys, self.sorted_values)),
                _ => ((self.sorted_keys, Some(self.sorted_values)), (&*keys, &*values)),
            };
            let shader = self.shader(from.1.is_none());
            let sort = |entry| {
                let step = blocks
                    .dispatch(&shader, entry, self.length)
                    .value("sort_length", Value::U32(self.length))
                    .value("sort_blocks", Value::U32(blocks.count(self.length)))
                    .value("sort_shift", Value::U32(bits_of_digit * pass))
                    .bind("sort_offsets", &offsets)
                    .bind("sort_keys", from.0);
                match self.count {
                    Some(count) => step.bind("sort_count", count),
                    None => step,
                }
            };
            let mut moved = sort("move_elements").bind("sorted_keys", to.0).bind("sorted_values", to.1);
            if let Some(values) = from.1 {
                moved = moved.bind("sort_values", values);
            }
            steps.push(sort("count_digits"));
            let scan = scan::steps(cx, &pass::request(OFFSETS, &[]), count_of_offsets, &sums)?;
            steps.extend(scan.into_iter().map(|step| {
                step.value("sort_blocks", Value::U32(blocks.count(self.length)))
                    .bind("sort_offsets", &offsets)
            }));
            steps.push(moved);
        }
        Ok(steps)
    }

    fn shader(&self, indices: bool) -> Request {
        let counted = Define::Bool(self.count.is_some());
        pass::request(SORT, &[("INDICES", Define::Bool(indices)), ("COUNTED", counted)])
    }
}

/// Returns the number of values of a digit of the sort, a power of two.
fn digits(cx: &UseContext<'_>) -> Result<u32, PassTypeError> {
    cx.constant(SORT, "DIGITS")
}
