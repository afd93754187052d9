//! The table of claims: a row for each claim and scene.

use crate::description::{Claim, Pick, Pins, Relation};
use crate::interval::Interval;
use crate::phase::info_of;
use crate::record::heading;
use crate::report::digest::Digest;
use crate::{Finding, MeasureInfo, Verdict};
use report::{Column, Entry, Measured, Table, number};

/// The greatest number of rows that list also what holds.
const MOST: usize = 200;

/// Returns the table; `None` for a study without claims. Of many claims it has those that do not hold.
pub(in crate::report) fn of_claims(digest: &Digest<'_>) -> Option<Table> {
    let findings = digest.results.findings();
    if findings.is_empty() {
        return None;
    }
    let is_shown = |finding: &&Finding<'_>| findings.len() <= MOST || finding.verdict != Some(Verdict::Holds);
    let mut columns = vec![
        Column::text("Claim", ""),
        Column::text("From", "Where it is said"),
        Column::text(&heading(&digest.results.study.words.case), ""),
        Column::text("Measured", "Means in the order of the claim"),
        Column::text("Result", ""),
    ];
    let has_reasons = findings.iter().any(|finding| finding.reason().is_some());
    if has_reasons {
        columns.push(Column::text("Why", "As the study states it, where a claim does not hold"));
    }
    let row = |finding: &Finding<'_>| {
        let info = info_of(&digest.results.study.measures, &finding.claim.measure.value);
        let info = info.as_ref();
        let mut row = vec![
            Entry::Text(claim_text(finding.claim, info)),
            Entry::Text(finding.claim.says.clone()),
            Entry::Text(match finding.adapter {
                Some(adapter) => format!("{} · {adapter}", scenes_text(&finding.scenes)),
                None => scenes_text(&finding.scenes),
            }),
            Entry::Text(measured_text(finding, info)),
            verdict_entry(finding.verdict),
        ];
        if has_reasons {
            row.push(Entry::Text(finding.reason().unwrap_or_default().to_owned()));
        }
        row
    };
    let count = |verdict| findings.iter().filter(|finding| finding.verdict == verdict).count();
    let mut caption = format!("Claims: {} of {} hold", count(Some(Verdict::Holds)), findings.len());
    for (verdict, what) in [(Some(Verdict::Undecided), "not decided"), (None, "not measured")] {
        if count(verdict) > 0 {
            caption += &format!(", {} are {what}", count(verdict));
        }
    }
    if findings.len() > MOST {
        caption += ", and only the others are listed";
    }
    caption += &format!(
        ". Each is about means over all finished cells of a {}; it is decided where the 95 % interval of the difference, seed by \
         seed, is on one side.",
        digest.results.study.words.case
    );
    let noise = |finding: &Finding<'_>| {
        let study = &digest.results.study;
        finding.scenes.iter().any(|scene| study.noise(scene, &finding.claim.measure.value).is_some())
    };
    if findings.iter().any(noise) {
        caption += " Errors that are both below that of the reference itself decide nothing.";
    }
    if findings.iter().any(|finding| matches!(finding.claim.relation, Relation::Growth { .. })) {
        caption += " An exponent is that of the upper half of its axis, where fixed costs matter least; that over the \
                    whole axis follows.";
    }
    Some(Table {
        name: "claims".to_owned(),
        caption,
        columns,
        rows: findings.iter().filter(is_shown).map(row).collect(),
    })
}

fn verdict_entry(verdict: Option<Verdict>) -> Entry {
    let (text, class) = match verdict {
        Some(Verdict::Holds) => ("holds", ""),
        Some(Verdict::Fails) => ("does not hold", "failed"),
        Some(Verdict::Undecided) => ("not decided", ""),
        None => ("not measured", ""),
    };
    let is_bold = verdict == Some(Verdict::Fails);
    Entry::Marked { text: text.to_owned(), class, tip: String::new(), is_bold }
}

/// Formats a claim: `TID: ism < tcas, lights = 256`.
fn claim_text(claim: &Claim, info: Option<&MeasureInfo>) -> String {
    let label = info.map_or(&claim.measure.value, |info| &info.label);
    let relation = match &claim.relation {
        Relation::Order(rising) => rising.iter().map(pick_text).collect::<Vec<_>>().join(" < "),
        Relation::Ratio { of, to, at_least, at_most } => {
            let (of, to) = (pick_text(of), pick_text(to));
            let bound = |bound: f64| match bound {
                1.0 => to.clone(),
                bound => format!("{} × {to}", number::plain(bound)),
            };
            match (at_least, at_most) {
                (Some(least), Some(most)) => format!("{} ≤ {of} ≤ {}", bound(*least), bound(*most)),
                (Some(least), None) => format!("{of} ≥ {}", bound(*least)),
                (None, Some(most)) => format!("{of} ≤ {}", bound(*most)),
                (None, None) => format!("{of} / {to}"),
            }
        }
        Relation::Bound { of, at_least, at_most } => between(*at_least, &pick_text(of), *at_most),
        Relation::Growth { of, over, at_least, at_most } => {
            let exponent = format!("exponent of {} over {}", pick_text(of), over.value);
            between(*at_least, &exponent, *at_most)
        }
    };
    let at = if claim.at.is_empty() { String::new() } else { format!(", {}", values_text(&claim.at)) };
    format!("{label}: {relation}{at}")
}

/// Formats what lies between bounds: `0.5 ≤ ism ≤ 20`.
fn between(least: Option<f64>, what: &str, most: Option<f64>) -> String {
    let least = least.map(|least| format!("{} ≤ ", number::plain(least))).unwrap_or_default();
    let most = most.map(|most| format!(" ≤ {}", number::plain(most))).unwrap_or_default();
    format!("{least}{what}{most}")
}

/// Formats the scenes of a claim: `hall-1k to hall-1m` for several.
fn scenes_text(scenes: &[&str]) -> String {
    match scenes {
        [first, .., last] => format!("{first} to {last}"),
        scenes => scenes.concat(),
    }
}

fn pick_text(pick: &Pick) -> String {
    let at = if pick.at.is_empty() { String::new() } else { format!(" ({})", values_text(&pick.at)) };
    format!("{}{at}", pick.pipeline.value)
}

/// Formats measurements: `0.012, 0.02 W/(m² sr)`, `1 / 4 ms = 0.25`, `0.9; whole 0.6`; `–` if there are none.
fn measured_text(finding: &Finding<'_>, info: Option<&MeasureInfo>) -> String {
    if finding.means.iter().all(Option::is_none) {
        return "–".to_owned();
    }
    let text =
        |mean: &Option<Interval>| mean.as_ref().map_or_else(|| "–".to_owned(), |mean| mean.measured().text());
    let means: Vec<String> = finding.means.iter().map(text).collect();
    let unit = info.map_or("", |info| &info.unit);
    let unit = if unit.is_empty() { String::new() } else { format!(" {unit}") };
    match &finding.claim.relation {
        Relation::Order(_) | Relation::Bound { .. } => means.join(", ") + &unit,
        Relation::Ratio { .. } => {
            let ratio = finding.ratio().map(|ratio| format!(" = {}", Measured::new(ratio, None).text()));
            format!("{}{unit}{}", means.join(" / "), ratio.unwrap_or_default())
        }
        Relation::Growth { .. } => means.join("; whole "),
    }
}

/// Formats values of axes: `lights = 64, map = 32`.
fn values_text(pins: &Pins) -> String {
    let texts: Vec<String> =
        pins.iter().map(|(axis, value)| format!("{} = {}", axis.value, value.value)).collect();
    texts.join(", ")
}
