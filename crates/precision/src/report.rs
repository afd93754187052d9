//! The report: measured probes as JSON, and as a page.

use crate::measure::{Errors, Measured, Point, ROUNDING};
use report::escape::html as escape;
use report::{Band, Column, Entry, Line, Page, Series, Table, XyAxis, XyChart};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Returns all probes as JSON. Errors are relative; infinite values are `null`.
pub fn json(all: &[Measured]) -> Value {
    let errors = |errors: &Errors| json!({ "median": errors.median, "most": errors.most });
    let probe = |measured: &Measured| {
        let points = measured.points.iter().map(|point| {
            json!({
                "magnitude": point.magnitude,
                "error": errors(&point.errors),
                "unavoidable": errors(&point.unavoidable),
                "demanded": measured.demanded(point),
                "not_finite": point.not_finite,
            })
        });
        json!({
            "probe": measured.probe.name,
            "about": measured.probe.about,
            "magnitude": measured.probe.magnitude,
            "by": measured.by,
            "bound": measured.probe.bound,
            "holds": measured.holds(),
            "points": points.collect::<Vec<_>>(),
        })
    };
    Value::Array(all.iter().map(probe).collect())
}

/// Returns the page: a table of the probes, and a chart for each. It needs no other file and no network.
pub fn html(all: &[Measured], about: &str) -> String {
    let mut body = format!("<main>\n<h1>Single precision</h1>\n<p class=lead>{}</p>\n", escape(about));
    body += "<section><p>Errors are relative to the same function of the same inputs in f64. The unavoidable error is \
             that of a result that is rounded to f32, where each input is off by the rounding of f32: the error of the \
             function as it is written, with independent inputs. An error that exceeds it many times can be \
             avoided.</p>\n<div class=scroll>";
    body += &table(all).html(false);
    body += "</div></section>\n";
    for measured in all {
        let name = escape(&measured.probe.name);
        let _ = write!(
            body,
            "<section id=\"{name}\"><h2>{name}</h2>\n<p>{}</p>\n<div class=drawing>{}</div></section>\n",
            escape(&measured.probe.about),
            chart(measured).drawing(report::PAGE).svg()
        );
    }
    Page { title: "Lightloom: single precision", style: "", body: &(body + "</main>\n"), script: "" }.html()
}

/// Returns a row for each probe, at the magnitude where its error is the greatest multiple of the unavoidable one.
pub fn table(all: &[Measured]) -> Table {
    let numbers =
        ["worst at", "error", "in roundings", "unavoidable", "error over it", "at most", "not finite"];
    let numbers = numbers.into_iter().map(|title| Column::number(title, ""));
    let columns = std::iter::once(Column::text("probe", "")).chain(numbers).collect();
    let row = |measured: &Measured| {
        let worst = measured.worst()?;
        let class = if measured.holds() { "held" } else { "exceeds" };
        let not_finite: usize = measured.points.iter().map(|point| point.not_finite).sum();
        Some(vec![
            Entry::Link(measured.probe.name.clone()),
            Entry::Text(format!("{:.1e}", worst.magnitude)),
            Entry::Text(format!("{:.1e}", worst.errors.most)),
            Entry::Text(format!("{:.1}", worst.errors.most / ROUNDING)),
            Entry::Text(format!("{:.1e}", worst.unavoidable.most)),
            Entry::marked(format!("{:.2}", worst.ratio()), class, ""),
            Entry::Text(measured.probe.bound.to_string()),
            Entry::Text(not_finite.to_string()),
        ])
    };
    Table { columns, rows: all.iter().filter_map(row).collect(), ..Table::default() }
}

/// Returns the chart of a probe: a band from the median of the errors in `f32` to their 99th percentile, the 99th
/// percentile of the unavoidable error, and the greatest error that is allowed.
fn chart(measured: &Measured) -> XyChart {
    let series = |name: &str, index: usize, dashes: usize, error: &dyn Fn(&Point) -> f64| {
        let point = |point: &Point| report::Point {
            x: point.magnitude,
            y: error(point),
            tip: format!("{name}: {:.1e} at {:.1e}", error(point), point.magnitude),
            ..report::Point::default()
        };
        let points = measured.points.iter().map(point).collect();
        Series { name: name.to_owned(), index, lines: vec![Line { points, dashes }] }
    };
    let band = measured.points.iter().map(|point| (point.magnitude, point.errors.median, point.errors.most));
    XyChart {
        about: format!("Errors of {} by magnitude", measured.probe.name),
        x: XyAxis::quantity(&measured.probe.magnitude),
        y: XyAxis::quantity("relative error"),
        series: vec![
            series("error in f32, 99 % of the samples", 0, 0, &|point| point.errors.most),
            series("median", 5, 0, &|point| point.errors.median),
            series("unavoidable, 99 %", 2, 1, &|point| point.unavoidable.most),
            series("demanded", 1, 2, &|point| measured.demanded(point)),
        ],
        bands: vec![Band { index: 0, points: band.collect() }],
        ..XyChart::default()
    }
}
