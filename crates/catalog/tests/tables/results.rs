//! The table of findings, made of the claims that the published results of studies decide and of the reasons that the studies state.

use super::{head, row};
use frame_graph::Source;
use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use study::Study;

/// The papers, in the order of the table; studies of others follow.
const PAPERS: [&str; 4] = ["ISM", "TCAS", "ACRSM", "SMC-IR"];

/// The machines that measured, and the folders of their pages.
const MACHINES: [(&str, &str); 2] = [("two cores", "docs/results"), ("H100", "docs/results/h100")];

/// Measurements that a row shows at most; the page has all.
const SHOWN: usize = 3;

/// A row of a table of claims: the verdict on a claim in a scene, in Markdown.
struct Decided {
    claim: String,
    says: String,
    scene: String,
    measured: String,
    verdict: Verdict,
}

#[derive(Clone, Copy, PartialEq)]
enum Verdict {
    Holds,
    Fails,
    Undecided,
    Unmeasured,
}

/// The published claims of a study, and the page that has them.
struct Published {
    study: Study,
    page: String,
    rows: Vec<Decided>,
}

/// Returns the table of findings: a row for each sentence of a paper that a study checks, with a verdict of each machine.
pub(super) fn table(root: &Path, studies: &BTreeMap<String, Study>) -> String {
    let on = MACHINES.map(|(_, folder)| published(root, folder, studies));
    let mut findings: Vec<Finding<'_>> = Vec::new();
    for (machine, pages) in on.iter().enumerate() {
        for (place, says, of, rows) in pages.iter().flat_map(sentences) {
            let known = findings.iter_mut().find(|known| {
                (&known.place, &known.says, &known.study.name) == (&place, &says, &of.study.name)
            });
            match known {
                Some(known) => known.on[machine] = Some((of, rows)),
                None => {
                    let mut on = [const { None }; MACHINES.len()];
                    on[machine] = Some((of, rows));
                    findings.push(Finding { place, says, study: &of.study, on });
                }
            }
        }
    }
    findings.sort_by_key(|finding| place(&finding.place));
    let mut text = String::new();
    for (index, paper) in PAPERS.iter().enumerate() {
        let counts: Vec<String> = (0..MACHINES.len())
            .filter_map(|machine| {
                let of_paper = findings.iter().filter(|finding| place(&finding.place).0 == index);
                let rows: Vec<&Decided> = of_paper.flat_map(|finding| finding.rows(machine)).collect();
                (!rows.is_empty()).then(|| format!("{}: {}", MACHINES[machine].0, counts(&rows)))
            })
            .collect();
        if !counts.is_empty() {
            let _ = writeln!(text, "- {paper}: {}", counts.join("; "));
        }
    }
    text += "\n";
    text += &head(&["where", "finding", MACHINES[0].0, MACHINES[1].0, "measured", "why, and page"]);
    for finding in &findings {
        let Finding { place, says, study, on } = finding;
        let verdict = |machine: usize| on[machine].as_ref().map_or(String::new(), |(_, rows)| counts(rows));
        // The last machine that has measured it: its pages are of the studies' full sizes.
        let last = on.iter().zip(MACHINES).rev().find_map(|(on, (_, folder))| Some((on.as_ref()?, folder)));
        let ((of, shown), folder) = last.expect("a machine has measured what is found");
        let all: Vec<&Decided> = (0..MACHINES.len()).flat_map(|machine| finding.rows(machine)).collect();
        let mut why = reasons(study, &all);
        if !why.is_empty() {
            why += ". ";
        }
        let _ = write!(why, "[{0}]({1}/{0}.md)", of.page, folder.trim_start_matches("docs/"));
        let _ = writeln!(
            text,
            "| {place} | {says} | {} | {} | {} | {why} |",
            verdict(0),
            verdict(1),
            measured(shown)
        );
    }
    text
}

/// Returns the table of studies, in the order of the papers, with the pages of their results.
pub(super) fn studies_table(root: &Path, studies: &BTreeMap<String, Study>) -> String {
    let mut studies: Vec<(&String, &Study)> = studies.iter().collect();
    studies.sort_by_key(|(_, study)| place(&study.paper));
    let mut text = head(&["study", "paper", "shows", "results"]);
    for (name, study) in studies {
        let pages = MACHINES.iter().filter_map(|(machine, folder)| {
            let page = format!("{folder}/{name}.md");
            root.join(&page).exists().then(|| format!("[{machine}](../{page})"))
        });
        let pages = pages.collect::<Vec<_>>().join(", ");
        text += &row(&[&format!("[{name}]({name}.ron)"), &study.paper, &study.about, &pages]);
    }
    text
}

/// A sentence of a paper, or of a study, and the claims that check it, by machine.
struct Finding<'p> {
    place: String,
    says: String,
    study: &'p Study,
    on: [Option<(&'p Published, Vec<&'p Decided>)>; MACHINES.len()],
}

impl<'p> Finding<'p> {
    fn rows(&self, machine: usize) -> impl Iterator<Item = &'p Decided> {
        self.on[machine].iter().flat_map(|(_, rows)| rows.iter().copied())
    }
}

/// Reads the studies of the tree.
pub(super) fn studies(root: &Path) -> BTreeMap<String, Study> {
    files(&root.join("studies"), "ron")
        .iter()
        .map(|path| {
            let source = Source::new(path.display().to_string(), read(path));
            (name(path), study::parse(source).unwrap_or_else(|errors| panic!("{errors}")))
        })
        .collect()
}

/// Reads from the pages of results in a folder the claims of each study.
fn published(root: &Path, folder: &str, studies: &BTreeMap<String, Study>) -> Vec<Published> {
    let mut all = Vec::new();
    for path in files(&root.join(folder), "md") {
        let page = name(&path);
        for section in read(&path).split("<!-- study: ").skip(1) {
            let (of, section) = section.split_once(" -->").expect("the end of a marker");
            let study = studies.get(of).unwrap_or_else(|| panic!("{page}: there is no study `{of}`"));
            let section = section.split("<!-- end -->").next().unwrap_or_default();
            all.push(Published { study: study.clone(), page: page.clone(), rows: decided(section) });
        }
    }
    all
}

pub(super) fn read(path: &Path) -> String {
    std::fs::read_to_string(path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Returns the files of a folder that have an extension, by name.
fn files(folder: &Path, extension: &str) -> Vec<PathBuf> {
    let entries = std::fs::read_dir(folder).unwrap_or_else(|error| panic!("{}: {error}", folder.display()));
    let paths = entries.map(|entry| entry.expect("an entry of a folder").path());
    let mut paths: Vec<_> = paths.filter(|path| path.extension().is_some_and(|e| e == extension)).collect();
    paths.sort();
    paths
}

fn name(path: &Path) -> String {
    path.file_stem().expect("a file").to_string_lossy().into_owned()
}

/// Reads the table of claims of a section that `lightloom study publish` has written.
fn decided(section: &str) -> Vec<Decided> {
    let lines = section.lines().skip_while(|line| !line.starts_with("| Claim | From |")).skip(2);
    let lines = lines.take_while(|line| line.starts_with("| "));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.trim_matches('|').split(" | ").map(str::trim).collect();
            let [claim, says, scene, measured, verdict, ..] = cells[..] else { panic!("{line}") };
            let verdict = match verdict.trim_matches('*') {
                "holds" => Verdict::Holds,
                "does not hold" => Verdict::Fails,
                "not decided" => Verdict::Undecided,
                "not measured" => Verdict::Unmeasured,
                other => panic!("`{other}` is no verdict: {line}"),
            };
            let [claim, says, scene, measured] = [claim, says, scene, measured].map(str::to_owned);
            Decided { claim, says, scene, measured, verdict }
        })
        .collect()
}

/// Returns where a paper says something, as a key to sort by: the paper, whether it is a figure, and the numbers.
fn place(paper: &str) -> (usize, usize, Vec<u32>) {
    let of = paper.split([' ', ';']).next();
    let paper_index = PAPERS.iter().position(|known| Some(*known) == of).unwrap_or(PAPERS.len());
    let rest = paper.split_once(' ').map_or("", |split| split.1);
    let kinds = ["Fig.", "Tab.", "Eq."];
    let kind = kinds.iter().position(|kind| rest.starts_with(kind)).unwrap_or(kinds.len());
    let first = rest.split([',', ';']).next().unwrap_or_default();
    let numbers = first.split(|c: char| !c.is_ascii_digit()).filter_map(|digits| digits.parse().ok());
    (paper_index, kind, numbers.collect())
}

/// Returns the sentences that the claims of a study check, in their order: where each is, what it says, and its claims.
fn sentences(published: &Published) -> Vec<(String, String, &Published, Vec<&Decided>)> {
    let mut sentences: Vec<(String, String, &Published, Vec<&Decided>)> = Vec::new();
    let mut keys: Vec<&str> = Vec::new();
    for row in &published.rows {
        let key = if row.says.is_empty() { &row.claim } else { &row.says };
        if let Some(known) = keys.iter().position(|known| known == key) {
            sentences[known].3.push(row);
            continue;
        }
        let (place, says) = place_and_sentence(&published.study, row);
        sentences.push((place, says, published, vec![row]));
        keys.push(key);
    }
    sentences
}

/// Returns where a claim is made, and what it says: of `Fig. 3: light is stable`, the figure of the study's paper.
fn place_and_sentence(study: &Study, row: &Decided) -> (String, String) {
    let paper = study.paper.split([' ', ';']).next().unwrap_or_default();
    let (before, sentence) = row.says.split_once(": ").unwrap_or(("", &row.says));
    let sentence = if sentence.is_empty() { &row.claim } else { sentence };
    let is_place = |text: &str| ["Fig. ", "Tab. ", "Eq. ", "§"].iter().any(|kind| text.starts_with(kind));
    let of_other =
        before.split_once(' ').is_some_and(|(paper, place)| PAPERS.contains(&paper) && is_place(place));
    match () {
        () if of_other => (before.to_owned(), sentence.to_owned()),
        () if is_place(before) => (format!("{paper} {before}"), sentence.to_owned()),
        () if study.paper.is_empty() => (study.name.clone(), row.says.clone()),
        () => (study.paper.clone(), if row.says.is_empty() { row.claim.clone() } else { row.says.clone() }),
    }
}

/// Formats how many rows hold: `holds`, `fails (3)`, `2 of 5 hold, 1 not decided`.
fn counts(rows: &[&Decided]) -> String {
    let count = |verdict| rows.iter().filter(|row| row.verdict == verdict).count();
    let words = [
        (Verdict::Holds, "holds"),
        (Verdict::Fails, "fails"),
        (Verdict::Undecided, "not decided"),
        (Verdict::Unmeasured, "not measured"),
    ];
    if let Some((_, word)) = words.iter().find(|(verdict, _)| count(*verdict) == rows.len()) {
        return if rows.len() == 1 { (*word).to_owned() } else { format!("{word} ({} of {0})", rows.len()) };
    }
    let mut text = format!("{} of {} hold", count(Verdict::Holds), rows.len());
    for (verdict, word) in &words[2..] {
        if count(*verdict) > 0 {
            let _ = write!(text, ", {} {word}", count(*verdict));
        }
    }
    text
}

/// Formats what was measured; first where a claim does not hold.
fn measured(rows: &[&Decided]) -> String {
    let mut rows = rows.to_vec();
    rows.sort_by_key(|row| row.verdict == Verdict::Holds);
    let one_claim = rows.iter().all(|row| row.claim == rows[0].claim);
    let one_scene = rows.iter().all(|row| row.scene == rows[0].scene);
    let shown = rows.iter().take(SHOWN).map(|row| match (one_claim, one_scene) {
        (true, true) => row.measured.clone(),
        (true, false) => format!("{}: {}", row.scene, row.measured),
        (false, true) => format!("{}: {}", row.claim, row.measured),
        (false, false) => format!("{}, {}: {}", row.claim, row.scene, row.measured),
    });
    let mut text = shown.collect::<Vec<_>>().join("; ");
    if one_claim && !rows[0].says.is_empty() {
        text = format!("{}: {text}", rows[0].claim);
    }
    if rows.len() > SHOWN {
        let _ = write!(text, "; and {} more", rows.len() - SHOWN);
    }
    text
}

/// Returns the reasons that the study states for those of its claims that are in the rows, where one does not hold.
fn reasons(study: &Study, rows: &[&Decided]) -> String {
    let says = |row: &Decided| row.says.replace('\\', "");
    let open = |row: &&&Decided| matches!(row.verdict, Verdict::Fails | Verdict::Undecided);
    let open: Vec<String> = rows.iter().filter(open).map(|row| says(row)).collect();
    let mut reasons: Vec<&str> = Vec::new();
    for claim in &study.claims {
        let because = claim.because.as_str();
        if open.contains(&claim.says) && !because.is_empty() && !reasons.contains(&because) {
            reasons.push(because);
        }
    }
    reasons.join("; ")
}
