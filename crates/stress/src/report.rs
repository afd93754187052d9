//! What the study of a run has beside its cells: claims of their energy and faults, and the tables of its page.

use crate::case::Case;
use crate::cell::{Cell, SHARE, Verdict};
use crate::isolated::Details;
use report::{Column, Entry, Table};
use serde_json::json;
use study::{Better, Claim, MeasureInfo, Outcome, Pick, Relation, Results};

const ALL: [Verdict; 8] = [
    Verdict::Held,
    Verdict::Refused,
    Verdict::TimedOut,
    Verdict::Off,
    Verdict::Unsteady,
    Verdict::Negative,
    Verdict::NotFinite,
    Verdict::Crashed,
];

const FAULTS: &str = "faults";

/// Adds to the results of a run what is said of its cells: the verdict and the command as details, the share of the expected
/// energy and the number of faulty pixels as measures, and what is claimed of these.
pub fn add(results: &mut Results, cells: &[Cell]) {
    let share = "The energy of the indirect light as a share of the expected one";
    let faults = "Pixels that are not finite or negative, of indirect light and image";
    results.study.measures.extend([
        MeasureInfo { better: Better::One, ..MeasureInfo::new(SHARE, "share", share) },
        MeasureInfo { better: Better::Lower, ..MeasureInfo::new(FAULTS, "faulty pixels", faults) },
    ]);
    for cell in cells {
        let is_of = |known: &&mut study::Cell| known.pipeline == cell.pipeline && known.scene == cell.case;
        for (place, known) in results.cells.iter_mut().filter(is_of).enumerate() {
            let own = cell.by_seed.iter().find(|(seed, _)| *seed == known.seed);
            known.measures.insert(SHARE.to_owned(), own.map(|(_, share)| *share));
            let faults = (cell.details.not_finite + cell.details.negative) as f64;
            let is_judged = place == 0 && known.outcome == Outcome::Done;
            known.measures.insert(FAULTS.to_owned(), is_judged.then_some(faults));
            if place == 0 {
                known.details = json!(cell);
            }
        }
        let bound = |measure: &str, at_least, at_most| {
            let relation = Relation::Bound { of: Pick::all(&cell.pipeline), at_least, at_most };
            Claim::new(measure, relation, &cell.case, "")
        };
        results.study.claims.push(bound(FAULTS, None, Some(0.0)));
        // Where both are black there is no share.
        let expected =
            cell.expected.as_ref().filter(|(measure, _)| *measure != SHARE || cell.energy.is_some());
        let claim = expected.map(|(measure, range)| bound(measure, Some(*range.start()), Some(*range.end())));
        results.study.claims.extend(claim);
    }
}

/// Returns the tables that are not empty: cases and pipelines, long runs, settings at the ends of their ranges, and the cells
/// that did not hold, each with the command that renders it again.
pub fn tables(cells: &[Cell], cases: &[Case]) -> Vec<Table> {
    let mut pipelines: Vec<&str> = Vec::new();
    for cell in cells {
        if !pipelines.contains(&cell.pipeline.as_str()) {
            pipelines.push(&cell.pipeline);
        }
    }
    let of_table = |cell: &&Cell| cases.iter().any(|case| case.name == cell.case);
    let by_case = cases.iter().map(|case| {
        let found = |pipeline: &&str| {
            let cell = cells.iter().find(|cell| cell.pipeline == *pipeline && cell.case == case.name);
            cell.map_or(Entry::Absent, entry)
        };
        let names = [Entry::Named(case.name.clone(), case.about.clone()), Entry::Text(case.group.clone())];
        names.into_iter().chain(pipelines.iter().map(found)).collect()
    });
    let by_setting = pipelines.iter().map(|pipeline| {
        let count = |verdict: Verdict| {
            let is = |cell: &&Cell| cell.pipeline == *pipeline && cell.verdict == verdict && !of_table(cell);
            Entry::marked(cells.iter().filter(is).count().to_string(), class(verdict), "")
        };
        std::iter::once(Entry::Text((*pipeline).to_owned())).chain(ALL.map(count)).collect()
    });
    let has_settings = !cells.iter().all(|cell| of_table(&cell));
    let failed = cells.iter().filter(|cell| cell.verdict != Verdict::Held).map(|cell| {
        let why =
            if cell.message.is_empty() { why(cell) } else { format!("{}; {}", cell.message, why(cell)) };
        let verdict = Entry::marked(cell.verdict.word(), class(cell.verdict), "");
        let texts = [&cell.case, &cell.pipeline].map(|text| Entry::Text(text.clone()));
        texts.into_iter().chain([verdict, Entry::Text(why), Entry::Text(cell.command.clone())]).collect()
    });
    let words = ALL.map(Verdict::word);
    let titles = ["frames", "energy", "memory", "objects", "time of a frame", "the same from frame"];
    let tables = [
        table(
            "Cases",
            "A number is the energy of the indirect light as a share of the expected energy: that of the plain scene where \
             only units or the place differ, else that of the path tracer, over the same share in the plain scene. Where that \
             is off, it is the mean over further seeds.",
            (&["case", "group"], &pipelines),
            by_case.collect(),
        ),
        table(
            "Long runs",
            "The last tenth of the frames against the second.",
            (&["pipeline", "case"], &titles),
            cells.iter().filter_map(long_run).collect(),
        ),
        table(
            "Settings at the ends of their ranges",
            "Cells by their verdicts.",
            (&["pipeline"], &words),
            if has_settings { by_setting.collect() } else { Vec::new() },
        ),
        table(
            "Cells that did not hold",
            "Each with the command that renders it again.",
            (&["case", "pipeline", "verdict", "why", "command"], &[]),
            failed.collect(),
        ),
    ];
    tables.into_iter().filter(|table| !table.is_empty()).collect()
}

fn table(name: &str, caption: &str, (texts, numbers): (&[&str], &[&str]), rows: Vec<Vec<Entry>>) -> Table {
    let texts = texts.iter().map(|title| Column::text(title, ""));
    let columns = texts.chain(numbers.iter().map(|title| Column::number(*title, ""))).collect();
    Table { name: name.to_owned(), caption: caption.to_owned(), columns, rows }
}

/// Returns the row of a long run.
fn long_run(cell: &Cell) -> Option<Vec<Entry>> {
    let long = cell.details.long.as_ref()?;
    let known = |value: Option<f64>, unit: &str, digits| {
        value.map_or_else(|| "not known".to_owned(), |value| format!("{value:+.digits$}{unit}"))
    };
    let numbers = [
        long.frames.to_string(),
        format!("{:.4}", long.energy),
        known(long.growth.map(|bytes| bytes / (1024.0 * 1024.0)), " MiB", 2),
        known(long.objects, "", 0),
        format!("×{:.2}", long.time),
        long.same_from.map_or_else(|| "none".to_owned(), |from| from.to_string()),
    ];
    let case = Entry::marked(&*cell.case, class(cell.verdict), "");
    Some([Entry::Text(cell.pipeline.clone()), case].into_iter().chain(numbers.map(Entry::Text)).collect())
}

fn class(verdict: Verdict) -> &'static str {
    match verdict {
        Verdict::Held => "held",
        Verdict::Refused | Verdict::TimedOut => "refused",
        _ => "exceeds",
    }
}

fn entry(cell: &Cell) -> Entry {
    let text = match (cell.verdict, cell.energy) {
        (Verdict::Held | Verdict::Off | Verdict::Unsteady, Some(energy)) => format!("{energy:.2}"),
        (verdict, _) => verdict.word().to_owned(),
    };
    Entry::marked(text, class(cell.verdict), why(cell))
}

/// Returns what is known of a cell, in a line.
fn why(cell: &Cell) -> String {
    let mut parts = vec![cell.verdict.word().to_owned()];
    parts.extend(cell.energy.map(|energy| format!("{energy:.3} of the energy expected")));
    if let (Some(mean), Some(first)) = (cell.seeds, cell.first) {
        let (count, half) = (mean.seeds, mean.half.unwrap_or(0.0));
        parts.push(format!(
            "the mean of {count} seeds ± {half:.3} (95 % interval), where the first has {first:.3}"
        ));
    }
    parts.extend(cell.error.map(|error| format!("relMSE {error:.1e}")));
    let Details { not_finite, negative, guards, .. } = &cell.details;
    if not_finite + negative > 0 {
        parts.push(format!("{not_finite} pixels not finite, {negative} negative"));
    }
    parts.extend(guards.iter().cloned());
    parts.join("; ")
}
