//! The tables of a study.

mod claims;

use super::best::best;
use super::digest::{Digest, Row, distinct, label_with_unit};
use crate::claim::Seeds;
use crate::record::heading;
use crate::{Better, MeasureInfo};
pub(super) use claims::of_claims;
use report::{Column, Entry, Table, number};

/// Returns the table of a scene: a row for each pipeline and combination of values, and a column for each measure.
pub(super) fn of_scene(digest: &Digest<'_>, scene: usize) -> Table {
    let study = &digest.results.study;
    let varied = digest.varied();
    let rows: Vec<&Row<'_>> = digest.of_scene(scene).collect();
    let chosen = distinct(rows.iter().flat_map(|row| row.done()).flat_map(|cell| cell.chosen.keys()));
    let measures: Vec<&MeasureInfo> = digest.measured_in(&rows).collect();
    let best_of = |measure: &&MeasureInfo| {
        // Times are compared among the rows of one adapter.
        let mut is_best = vec![false; rows.len()];
        for group in digest.comparable(&rows, &measure.key) {
            let values: Vec<Option<Seeds>> = group.iter().map(|row| rows[*row].seeds(&measure.key)).collect();
            for (row, best) in group.iter().zip(best(measure.better, &values, digest.noise(scene, measure))) {
                is_best[*row] = best;
            }
        }
        is_best
    };
    let bests: Vec<Vec<bool>> = measures.iter().map(best_of).collect();

    let mut columns = vec![Column::text(&heading(&study.words.subject), "")];
    columns.extend(varied.iter().map(|&axis| {
        let axis = &study.axes[axis];
        let unit = if axis.unit.is_empty() { String::new() } else { format!(" [{}]", axis.unit) };
        Column::number(format!("{}{unit}", axis.name), &axis.doc)
    }));
    columns.extend(chosen.iter().map(|name| Column::number(format!("{name}*"), "Chosen by the budget")));
    columns.push(Column::number("Seeds", "Finished cells"));
    columns.extend(measures.iter().map(|measure| Column::number(label_with_unit(measure), &measure.doc)));

    let entries = |(place, row): (usize, &&Row<'_>)| {
        let mut entries = vec![Entry::Text(digest.pipelines[row.pipeline].clone())];
        let values = varied.iter().map(|&axis| row.values[axis].map(ToString::to_string));
        let budget = chosen.iter().map(|name| row.chosen(name));
        entries.extend(values.chain(budget).map(|text| text.map_or(Entry::Absent, Entry::Text)));
        let (done, failure) = (row.done().count(), row.failure());
        if let (0, Some((error, count))) = (done, failure) {
            entries.push(Entry::Text(format!("0 of {count}")));
            entries.push(Entry::Failed(error.to_owned()));
            return entries;
        }
        entries.push(Entry::Text(match failure {
            Some(_) => format!("{done} of {}", row.cells.len()),
            None => done.to_string(),
        }));
        entries.extend(measures.iter().zip(&bests).map(|(measure, best)| match row.summary(&measure.key) {
            Some(summary) => {
                Entry::Measured { value: summary.measured(), mean: summary.mean, is_best: best[place] }
            }
            None => Entry::Absent,
        }));
        entries
    };
    let what = if study.seeds.is_empty() { "" } else { ": means over seeds" };
    let mut caption = format!("{}{what}", digest.scenes[scene]);
    if study.seeds.len() > 1 {
        caption += " and half the width of their 95 % intervals (Student’s t; none where all seeds agree)";
    }
    caption += match (study.seeds.len() > 1, measures.iter().any(|measure| measure.better != Better::Neither))
    {
        (_, false) => ".",
        (true, _) => {
            "; in bold, the best of each column and all that are not worse (95 %, seed by seed), unless that is all of them, and none whose \
             interval is wider than its mean."
        }
        (false, _) => "; in bold, the best of each column. One seed has no interval.",
    };
    for measure in &measures {
        if let Some(noise) = digest.noise(scene, measure) {
            caption += &format!(
                " {} below {}, the reference’s own, is no gain, and counts as alike.",
                measure.label,
                number::short(noise, 2)
            );
        }
    }
    if digest.adapters > 1 {
        caption += &format!(" Times are those of the adapter in each row, and {}.", digest.errors_are_of());
    }
    if !chosen.is_empty() {
        caption += " Columns with * are what the budget chose.";
    }
    let rows = rows.iter().enumerate().map(entries).collect();
    Table { name: digest.scenes[scene].to_owned(), caption, columns, rows }
}
