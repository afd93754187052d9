//! The page: the table of shares, and the picture colored by whom its error is owed to.

use crate::map::Map;
use crate::player::Player;
use crate::shares::{Estimate, Row, Shares};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use metrics::{Display, Image};
use report::escape::html;
use report::{Column, Entry, Measured, Page, Table};
use std::fmt::Write as _;

/// Colors of players in the map, as sRGB: Okabe and Ito 2008, then Tol's muted scheme (2021).
const COLORS: [[u8; 3]; 9] = [
    [0xd5, 0x5e, 0x00],
    [0x00, 0x72, 0xb2],
    [0x00, 0x9e, 0x73],
    [0xcc, 0x79, 0xa7],
    [0xe6, 0x9f, 0x00],
    [0x56, 0xb4, 0xe9],
    [0x88, 0x22, 0x55],
    [0x99, 0x99, 0x33],
    [0x33, 0x22, 0x88],
];
/// What is owed to no approximation.
const REST: [u8; 3] = [0x80, 0x80, 0x80];
/// Root of the relative squared error that is drawn in full color.
const FULL: f32 = 0.5;
/// The mean luminance at which pictures are shown, before tone mapping.
const SHOWN_MEAN: f64 = 0.3;
const STYLE: &str = include_str!("page.css");

/// What was measured, in words.
#[derive(Clone, Copy, Debug)]
pub struct Heading<'a> {
    /// The pipeline and the scene.
    pub title: &'a str,
    /// Everything else that a reader needs to repeat it, each with a name.
    pub facts: &'a [(&'a str, String)],
}

/// Returns the table of shares; with `docs`, it says what is exact.
pub fn rows(shares: &Shares, docs: bool) -> Table {
    let mut columns = vec![
        Column::text("approximation", ""),
        Column::text("passes", "The passes that owe it."),
        Column::number("of the error", "Its share of the relative squared error of the picture."),
        Column::number("bias²", "Its part of the error that any number of frames keeps."),
        Column::number("variance", "Its part of the error that is noise from frame to frame."),
        Column::number("energy", "Its part of the energy, in percent of the reference's: −5 takes 5 % away."),
        Column::number("saves ms", "The GPU time that it saves in a frame."),
    ];
    if docs {
        columns.push(Column::text("exact in its place", ""));
    }
    let whole = &shares.whole;
    let row = |row: &Row| {
        let percent = |estimate: Estimate| Estimate {
            mean: estimate.mean * 100.0,
            half: estimate.half.map(|half| half * 100.0),
        };
        let share = Estimate {
            mean: row.error.mean / whole.error.mean,
            half: row.error.half.map(|half| half / whole.error.mean),
        };
        let is_picture = std::ptr::eq(row, whole);
        let measured = |estimate: Estimate, unit: &str| measured(estimate.or_zero(whole.error.mean), unit);
        let mut entries = vec![
            Entry::Text(row.name.clone()),
            passes(&row.passes),
            if is_picture { Entry::Text("100 %".to_owned()) } else { measured(percent(share), " %") },
            measured(row.bias_squared, ""),
            measured(row.variance, ""),
            measured(percent(row.energy), " %"),
            row.saves.map_or(Entry::Absent, |saves| {
                let is_sum = is_picture || std::ptr::eq(row, &shares.rest);
                if is_sum { Entry::Text(format!("takes {}", text(saves))) } else { measured(saves, "") }
            }),
        ];
        if docs {
            entries.push(Entry::Text(row.exact.clone()));
        }
        entries
    };
    Table {
        name: "shares".to_owned(),
        caption: "The shares of the error; they add up to the last row.".to_owned(),
        columns,
        rows: shares.rows.iter().chain([&shares.rest, whole]).map(row).collect(),
    }
}

/// The most passes that a row names.
const NAMED: usize = 4;

/// Returns the names of passes, of many the first and how many others there are, with all as a tip.
fn passes(names: &[String]) -> Entry {
    match names.len().saturating_sub(NAMED) {
        0 | 1 => Entry::Text(names.join(", ")),
        others => {
            let text = format!("{} and {others} more", names[..NAMED].join(", "));
            Entry::marked(text, "", names.join(", "))
        }
    }
}

fn text(estimate: Estimate) -> String {
    Measured::new(estimate.mean, estimate.half).text()
}

fn measured(estimate: Estimate, unit: &str) -> Entry {
    let is_known = estimate.half.is_none() || estimate.is_decided();
    let class = if is_known { "" } else { "open" };
    Entry::marked(format!("{}{unit}", text(estimate)), class, "")
}

impl Estimate {
    /// The same, or 0 where it is nothing beside the whole but rounding.
    fn or_zero(self, whole: f64) -> Estimate {
        if self.mean.abs().max(self.half.unwrap_or(0.0)) < 1e-9 * whole { Estimate::default() } else { self }
    }
}

/// Returns the page. `pictures` are shown with the exposure of the last, which is the reference, each with its name.
pub fn page(
    heading: Heading<'_>,
    shares: &Shares,
    players: &[Player],
    map: &Map,
    pictures: &[(&str, &Image)],
) -> String {
    let facts = heading.facts.iter().fold(String::new(), |mut text, (name, value)| {
        let _ = write!(text, "<div><dt>{}</dt><dd>{}</dd></div>", html(name), html(value));
        text
    });
    let mut figures = String::new();
    let picture = map_picture(map);
    let maps = [("The error, colored by whom it is owed to", &picture, Display::AS_IS)];
    // All of them as bright as makes the reference, which is the last, well seen.
    let mean = pictures.last().map_or(0.0, |(_, image)| image.glance().mean);
    let exposure = if mean > 0.0 { (SHOWN_MEAN / mean).log2() as f32 } else { 0.0 };
    let display = Display { exposure, ..Display::default() };
    let shown = pictures.iter().map(|(name, image)| (*name, *image, display));
    for (name, image, display) in maps.into_iter().chain(shown) {
        let png = image.png(display).unwrap_or_default();
        let _ = writeln!(
            figures,
            "<figure><img alt=\"{0}\" src=\"data:image/png;base64,{1}\"><figcaption>{0}</figcaption></figure>",
            html(name),
            STANDARD.encode(png)
        );
    }
    let mut legend = String::new();
    let names = players.iter().enumerate().map(|(at, player)| (color(Some(at)), player.name.as_str()));
    let owns = |player: Option<usize>| {
        let pixels = map.owner.iter().filter(|owner| **owner == player).count();
        100.0 * pixels as f64 / map.owner.len().max(1) as f64
    };
    let rest = (color(None), "the rest");
    for (at, ([r, g, b], name)) in names.chain([rest]).enumerate() {
        let pixels = owns((at < players.len()).then_some(at));
        let name = html(name);
        let _ = writeln!(
            legend,
            "<li><span style=\"background: rgb({r} {g} {b})\"></span>{name}: {pixels:.0} % of the pixels</li>"
        );
    }
    let sampled = if shares.sampled {
        " Shares are means over orders that were drawn; intervals include that."
    } else {
        ""
    };
    let body = format!(
        "<header><h1>{}</h1><p class=lead>Who owes the error of the picture</p><dl class=facts>{facts}</dl></header>\n<main>\n\
         <section><h2>Shares</h2><div class=scroll>{}</div><p class=note>Shares are Shapley values: the mean, over all orders \
         in which approximations can be made exact, of what the error falls by at each one’s turn. Intervals are of 95 % over \
         seeds; what is in grey may be 0.{sampled}</p></section>\n\
         <section><h2>Pictures</h2><ul class=legend>{legend}</ul><p class=note>A pixel has the color of the approximation that \
         owes most of the error around it, and is the brighter the greater that error is: full at {:.0} %.</p>\
         <div class=pictures>{figures}</div></section>\n</main>",
        html(heading.title),
        rows(shares, true).html(false),
        FULL * 100.0,
    );
    Page { title: heading.title, style: STYLE, body: &body, script: "" }.html()
}

fn color(player: Option<usize>) -> [u8; 3] {
    player.map_or(REST, |player| COLORS[player % COLORS.len()])
}

/// Returns the map as display light.
fn map_picture(map: &Map) -> Image {
    Image::from_fn(map.size.0, map.size.1, |x, y| {
        let at = y * map.size.0 + x;
        let strength = (map.error[at] / FULL).clamp(0.0, 1.0);
        let linear = color(map.owner[at]).map(|value| (f32::from(value) / 255.0).powf(2.2) * strength);
        [linear[0], linear[1], linear[2], 1.0]
    })
    .expect("a map has as many pixels as its size says")
}
