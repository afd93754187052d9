//! The drawing of a plan as SVG.

use super::Plan;
use super::drawing::{BoxKind, CHARACTER, MARGIN};
use crate::xml::escape;
use std::fmt::Write as _;

/// Returns the text of a line that fits into a box.
fn short(text: &str, width: f32) -> String {
    let most = (width / CHARACTER) as usize - 2;
    if text.chars().count() <= most {
        return text.to_owned();
    }
    text.chars().take(most - 1).chain(['…']).collect()
}

fn fill(kind: BoxKind) -> &'static str {
    match kind {
        BoxKind::Pass(_) => "#dcecf7",
        BoxKind::Culled => "#e8e8e8",
        BoxKind::Off => "#f7e3c0",
        BoxKind::Output => "#d9f0d3",
    }
}

pub(super) fn svg(plan: &Plan) -> String {
    let drawing = plan.drawing();
    let (width, height) = drawing.size;
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{width}\" height=\"{height}\" \
         viewBox=\"0 0 {width} {height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <defs><marker id=\"tip\" viewBox=\"0 0 8 8\" refX=\"8\" refY=\"4\" markerWidth=\"8\" markerHeight=\"8\" \
         orient=\"auto\"><path d=\"M0,0 L8,4 L0,8 z\" fill=\"#555\"/></marker></defs>\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let mut labels = String::new();
    for edge in &drawing.edges {
        let mut path = format!("M{:.1},{:.1}", edge.start.0, edge.start.1);
        for [a, b, end] in &edge.curves {
            let _ = write!(path, " C{:.1},{:.1} {:.1},{:.1} {:.1},{:.1}", a.0, a.1, b.0, b.1, end.0, end.1);
        }
        let dashes = if edge.past { " stroke-dasharray=\"5 4\"" } else { "" };
        let _ = writeln!(
            out,
            "<path d=\"{path}\" fill=\"none\" stroke=\"#777\"{dashes} marker-end=\"url(#tip)\"/>"
        );
        let (x, y) = edge.label_at;
        let anchor = if edge.past { "start" } else { "end" };
        let _ = writeln!(
            labels,
            "<text x=\"{x:.1}\" y=\"{y:.1}\" font-size=\"10\" fill=\"#333\" text-anchor=\"{anchor}\" \
             paint-order=\"stroke\" stroke=\"white\" stroke-width=\"3\">{}</text>",
            escape(&edge.label)
        );
    }
    for drawn in &drawing.boxes {
        let ((x, y), (width, height)) = (drawn.at, drawn.size);
        let _ = writeln!(
            out,
            "<g><title>{}</title><rect x=\"{x:.1}\" y=\"{y:.1}\" width=\"{width}\" height=\"{height}\" rx=\"4\" \
             fill=\"{}\" stroke=\"#555\"/>",
            escape(&drawn.title),
            fill(drawn.kind)
        );
        for (i, line) in drawn.lines.iter().enumerate() {
            let weight = if i == 0 { " font-weight=\"bold\"" } else { " fill=\"#333\"" };
            let (x, y) = (x + 8.0, y + 19.0 + i as f32 * 17.0);
            let text = escape(&short(line, width));
            let _ = writeln!(out, "<text x=\"{x:.1}\" y=\"{y:.1}\"{weight}>{text}</text>");
        }
        out.push_str("</g>\n");
    }
    out.push_str(&labels);
    for (i, line) in drawing.summary.iter().enumerate() {
        let y = height - 44.0 + i as f32 * 20.0;
        let _ = writeln!(out, "<text x=\"{MARGIN}\" y=\"{y:.1}\">{}</text>", escape(line));
    }
    out.push_str("</svg>\n");
    out
}
