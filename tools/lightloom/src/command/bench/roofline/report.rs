//! Prints a roofline.

use super::work::{Quantity, Work};
use super::{Frame, Pass, Roofline};
use crate::command::bench::layout::{digits, print_columns};
use crate::output::stdout;
use serde_json::{Map, Value, json};

impl Roofline {
    pub(in crate::command::bench) fn print(&self, markdown: bool) {
        if markdown {
            stdout!("{}\n", self.machine.line());
        }
        print_columns(["ceiling", "measured"], self.ceilings.0.iter().map(|c| c.cells()), markdown);
        for frame in &self.frames {
            stdout!("\n{}\n", frame.name);
            let heads = ["pass", "measured", "at least", "bound by", "over that", "what it must move and do"];
            let passes = frame.passes.iter().map(|pass| self.cells(pass));
            print_columns(heads, passes.chain([self.sums(frame)]), markdown);
        }
        stdout!("");
        stdout!("{}{}", if markdown { "- " } else { "" }, self.note);
        if !markdown {
            stdout!("{}", self.machine.line());
        }
    }

    fn cells(&self, pass: &Pass) -> [String; 6] {
        let time = pass.time.with_unit("ms");
        let Some((quantity, least)) = pass.work.bound(&self.ceilings) else {
            return [pass.name.clone(), time, String::new(), String::new(), String::new(), String::new()];
        };
        [
            pass.name.clone(),
            time,
            format!("{} ms", digits(least)),
            quantity.names().1.to_owned(),
            format!("{} ×", digits(pass.time.median / least)),
            described(&pass.work),
        ]
    }

    /// Returns the last row of a frame: all its passes.
    fn sums(&self, frame: &Frame) -> [String; 6] {
        let least = self.least(frame);
        [
            "all".to_owned(),
            frame.time.with_unit("ms"),
            format!("{} ms", digits(least)),
            String::new(),
            format!("{} ×", digits(frame.time.median / least)),
            String::new(),
        ]
    }

    /// Returns the least milliseconds of a frame, whose passes run one after the other.
    fn least(&self, frame: &Frame) -> f64 {
        frame.passes.iter().filter_map(|pass| pass.work.bound(&self.ceilings)).map(|(_, least)| least).sum()
    }

    pub(in crate::command::bench) fn to_json(&self) -> Value {
        let ceilings: Vec<Value> = self.ceilings.0.iter().map(|ceiling| ceiling.to_json()).collect();
        let frames: Vec<Value> = self.frames.iter().map(|frame| self.frame_to_json(frame)).collect();
        self.machine.json_with([
            ("ceilings", ceilings.into()),
            ("frames", frames.into()),
            ("note", self.note.as_str().into()),
        ])
    }

    fn frame_to_json(&self, frame: &Frame) -> Value {
        let passes = frame.passes.iter().map(|pass| {
            let bound = pass.work.bound(&self.ceilings);
            let least: Map<String, Value> = pass
                .work
                .least(&self.ceilings)
                .map(|(quantity, least)| (quantity.names().0.to_owned(), json!(least)))
                .collect();
            json!({
                "name": pass.name,
                "kind": pass.kind,
                "median": pass.time.median,
                "least": pass.time.least,
                "greatest": pass.time.greatest,
                "unit": "ms",
                "counts": pass.work.to_json(),
                "at_least_by_count": least,
                "at_least": bound.map(|(_, least)| least),
                "bound_by": bound.map(|(quantity, _)| quantity.names().0),
            })
        });
        json!({
            "name": frame.name,
            "median": frame.time.median,
            "least": frame.time.least,
            "greatest": frame.time.greatest,
            "unit": "ms",
            "at_least": self.least(frame),
            "passes": passes.collect::<Vec<_>>(),
        })
    }
}

/// Formats the counts of a pass.
fn described(work: &Work) -> String {
    // Bytes of buffers are among all that are moved.
    let counts =
        work.counts().filter(|(quantity, _)| !matches!(quantity, Quantity::Read | Quantity::Written));
    let texts: Vec<String> =
        counts.map(|(quantity, count)| format!("{} {}", rounded(count), quantity.names().1)).collect();
    texts.join(", ")
}

/// Formats a count with three significant digits.
fn rounded(count: u64) -> String {
    match count {
        0..1_000 => count.to_string(),
        1_000..1_000_000 => format!("{} k", digits(count as f64 / 1e3)),
        1_000_000..1_000_000_000 => format!("{} M", digits(count as f64 / 1e6)),
        _ => format!("{} G", digits(count as f64 / 1e9)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_have_prefixes() {
        let mut work = Work::default();
        work.add(Quantity::Bytes, 67_108_864);
        work.add(Quantity::Read, 67_108_864);
        work.add(Quantity::Threads, 1_024);
        work.add(Quantity::Dispatches, 3);
        assert_eq!(described(&work), "67.1 M bytes moved, 1.02 k threads, 3 dispatches");
    }
}
