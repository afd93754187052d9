//! What was measured: as JSON, and as a page.

use crate::chart;
use crate::measure::{Errors, Measured, ROUNDING};
use frame_graph::xml::{escape, page};
use serde_json::{Value, json};
use std::fmt::Write as _;

/// Returns all probes as JSON. Errors are relative; what is infinite is `null`.
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

const STYLE: &str = include_str!("report.css");

/// Returns the page: a table of the probes, and a chart for each. It needs no other file and no network.
pub fn html(all: &[Measured], about: &str) -> String {
    let mut body = format!("<h1>Single precision</h1>\n<p>{}</p>\n", escape(about));
    body += "<p>Errors are relative to the same function of the same inputs in f64. What is unavoidable is the error of a result \
             that is rounded to f32, where each input is off by the rounding of f32: of the function as it is written, whose \
             inputs count as independent. An error many times that can be avoided.</p>\n\
             <p><span class=\"key most\"></span> error in f32, from the median to 99 % of the samples \
             <span class=\"key unavoidable\"></span> unavoidable, of 99 % \
             <span class=\"key demanded\"></span> demanded</p>\n";
    body += "<table>\n<thead><tr>";
    for column in [
        "probe",
        "worst at",
        "error",
        "in roundings",
        "unavoidable",
        "error over it",
        "demanded",
        "not finite",
    ] {
        let _ = write!(body, "<th scope=\"col\">{column}</th>");
    }
    body += "</tr></thead>\n<tbody>\n";
    for measured in all {
        body += &row(measured);
    }
    body += "</tbody>\n</table>\n";
    for measured in all {
        let name = escape(&measured.probe.name);
        let _ = write!(
            body,
            "<section id=\"{name}\"><h2>{name}</h2>\n<p>{}</p>\n{}</section>\n",
            escape(&measured.probe.about),
            chart::svg(measured)
        );
    }
    page("Lightloom: single precision", STYLE, &body)
}

fn row(measured: &Measured) -> String {
    let Some(worst) = measured.worst() else { return String::new() };
    let name = escape(&measured.probe.name);
    format!(
        "<tr><th scope=\"row\"><a href=\"#{name}\">{name}</a></th><td>{:.1e}</td><td>{:.1e}</td><td>{:.1}</td><td>{:.1e}</td>\
         <td class=\"{}\">{:.2}</td><td>{}</td><td>{}</td></tr>\n",
        worst.magnitude,
        worst.errors.most,
        worst.errors.most / ROUNDING,
        worst.unavoidable.most,
        if measured.holds() { "held" } else { "exceeds" },
        worst.ratio(),
        measured.probe.bound,
        measured.points.iter().map(|point| point.not_finite).sum::<usize>()
    )
}
