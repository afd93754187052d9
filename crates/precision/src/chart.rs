//! Errors over magnitudes as SVG, both axes logarithmic.

use crate::measure::{Errors, Measured, Point, ROUNDING};
use frame_graph::xml::escape;
use std::fmt::Write as _;

const WIDTH: f64 = 640.0;
const HEIGHT: f64 = 320.0;
const LEFT: f64 = 56.0;
const BELOW: f64 = 44.0;
const MARGIN: f64 = 12.0;

/// The most ticks along the axis of magnitudes.
const MOST_TICKS: i32 = 10;

/// An axis of powers of ten, from `low` to `high`, drawn from `begin` to `end` [px].
struct Axis {
    low: f64,
    high: f64,
    begin: f64,
    end: f64,
}

impl Axis {
    /// Where a value is; at an end, beyond it.
    fn place(&self, value: f64) -> f64 {
        let share = (value.max(f64::MIN_POSITIVE).log10() - self.low) / (self.high - self.low);
        self.begin + share.clamp(0.0, 1.0) * (self.end - self.begin)
    }

    /// Powers of ten on the axis, no closer than `most` allows.
    fn ticks(&self, most: i32) -> impl Iterator<Item = i32> + use<> {
        let (first, last) = (self.low.ceil() as i32, self.high.floor() as i32);
        let step = ((last - first) / most + 1).max(1);
        (first..=last).filter(move |power| power % step == 0)
    }
}

/// Returns the chart of a probe: a band from the median of the errors in `f32` to their 99th percentile, the same of
/// the unavoidable error as a dashed line, and the error that is demanded as a dotted one.
pub(crate) fn svg(measured: &Measured) -> String {
    let points = &measured.points;
    let highest = points.iter().flat_map(|point| [point.errors.most, measured.demanded(point)]);
    let highest = highest.filter(|error| error.is_finite()).fold(1e-6, f64::max);
    let (low, high) = measured.probe.range;
    let x = Axis { low: low.log10(), high: high.log10(), begin: LEFT, end: WIDTH - MARGIN };
    let y = Axis {
        low: (0.1 * ROUNDING).log10(),
        high: highest.log10().ceil().min(2.0),
        begin: HEIGHT - BELOW,
        end: MARGIN,
    };
    let title = escape(&format!("Errors of {} by magnitude", measured.probe.name));
    let mut out = format!(
        "<svg viewBox=\"0 0 {WIDTH} {HEIGHT}\" width=\"{WIDTH}\" height=\"{HEIGHT}\" role=\"img\"><title>{title}</title>\n"
    );
    for power in x.ticks(MOST_TICKS) {
        let at = x.place(10f64.powi(power));
        let _ = write!(
            out,
            "<path class=\"grid\" d=\"M{at:.1} {:.1}V{:.1}\"/><text x=\"{at:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
            y.begin,
            y.end,
            y.begin + 16.0,
            power_of_ten(power)
        );
    }
    for power in y.ticks(MOST_TICKS) {
        let at = y.place(10f64.powi(power));
        let _ = write!(
            out,
            "<path class=\"grid\" d=\"M{:.1} {at:.1}H{:.1}\"/><text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"end\">{}</text>",
            x.begin,
            x.end,
            x.begin - 6.0,
            at + 4.0,
            power_of_ten(power)
        );
    }
    let _ = writeln!(
        out,
        "<text x=\"{:.1}\" y=\"{:.1}\" text-anchor=\"middle\">{}</text>",
        0.5 * (x.begin + x.end),
        HEIGHT - 8.0,
        escape(&measured.probe.magnitude)
    );
    let line = |error: &dyn Fn(&Point) -> f64, points: &mut dyn Iterator<Item = &Point>| {
        let mut path = String::new();
        for point in points {
            let _ = write!(path, " {:.1} {:.1}", x.place(point.magnitude), y.place(error(point)));
        }
        path
    };
    let of = |which: fn(&Errors) -> f64| move |point: &Point| which(&point.errors);
    let upper = line(&of(|errors| errors.most), &mut points.iter());
    let lower = line(&of(|errors| errors.median), &mut points.iter().rev());
    let median = line(&of(|errors| errors.median), &mut points.iter());
    let unavoidable = line(&|point| point.unavoidable.most, &mut points.iter());
    let demanded = line(&|point| measured.demanded(point), &mut points.iter());
    let _ = writeln!(out, "<path class=\"band\" d=\"M{upper} L{lower} Z\"/>");
    for (class, path) in
        [("demanded", demanded), ("unavoidable", unavoidable), ("median", median), ("most", upper)]
    {
        let _ = writeln!(out, "<path class=\"line {class}\" d=\"M{path}\"/>");
    }
    out + "</svg>\n"
}

fn power_of_ten(power: i32) -> String {
    format!("10<tspan dy=\"-5\" font-size=\"9\">{power}</tspan>")
}
