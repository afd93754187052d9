//! A figure in LaTeX, whose text is in the font of the paper.

use super::{Area, Column, Composed, FRAME, Layout, WIDTH, color};
use crate::chart::n;
use crate::escape::latex;
use crate::pdf::channels;
use std::fmt::Write;

impl Composed {
    /// Returns the figure for LaTeX, as wide as the line. It names the files of its pictures without folder.
    pub fn tex(&self) -> String {
        let layout = self.layout();
        let mut out = String::from(
            "% Needs \\usepackage{graphicx,color}, and \\graphicspath{{FOLDER/}} with the folder of the pictures.\n\
             \\begingroup\n",
        );
        let _ = writeln!(out, "\\setlength{{\\unitlength}}{{\\dimexpr\\linewidth/{WIDTH}\\relax}}%");
        let _ = writeln!(out, "\\begin{{picture}}({WIDTH},{})%", n(layout.picture.height));
        for (raster, area, crop) in self.placed(&layout) {
            let (x, y) = corner(&layout, area);
            let _ = writeln!(
                out,
                "\\put({x},{y}){{\\includegraphics[width={}\\unitlength,height={}\\unitlength]{{{}}}}}%",
                n(area.width),
                n(area.height),
                raster.file,
            );
            if let Some(crop) = crop {
                frame(&mut out, &layout, area, crop);
            }
        }
        for (crop, area) in layout.frames.iter().enumerate() {
            frame(&mut out, &layout, *area, crop);
        }
        let mut caption = |area: Area, text: &str| {
            let (x, width) = (n(area.left), n(area.width));
            // What begins with a skip hangs below its place.
            let _ = writeln!(
                out,
                "\\put({x},0){{\\parbox[t]{{{width}\\unitlength}}{{\\vskip 2pt\\centering\\scriptsize\\strut {text}}}}}%"
            );
        };
        caption(layout.picture, &latex(&self.name));
        for (column, areas) in self.columns.iter().zip(&layout.columns) {
            caption(areas[0], &text(column));
        }
        // Room for what hangs below, and for a line that is broken.
        let lines = self.columns.iter().map(|column| column.lines().count()).max().unwrap_or(0).max(1) + 1;
        let _ = writeln!(
            out,
            "\\end{{picture}}\\par{{\\scriptsize\\vspace{{{lines}\\baselineskip}}}}%\n\\endgroup"
        );
        out
    }
}

/// Returns the lower left corner, from that of the figure.
fn corner(layout: &Layout, area: Area) -> (String, String) {
    (n(area.left), n(layout.picture.height - area.top - area.height))
}

fn frame(out: &mut String, layout: &Layout, area: Area, crop: usize) {
    let (x, y) = corner(layout, area);
    let [red, green, blue] = channels(color(crop)).map(|channel| n(f64::from(channel)));
    let _ = writeln!(
        out,
        "{{\\color[rgb]{{{red},{green},{blue}}}\\linethickness{{{FRAME}\\unitlength}}\\put({x},{y}){{\\framebox({},{}){{}}}}}}%",
        n(area.width),
        n(area.height),
    );
}

fn text(column: &Column) -> String {
    let line = |(line, is_value): (&str, bool)| match is_value && !column.value.1.is_empty() {
        true => format!("${}$", column.value.1),
        false => latex(line),
    };
    column.lines().map(line).collect::<Vec<_>>().join("\\\\ ")
}

#[cfg(test)]
mod tests {
    use super::super::tests::figure;

    #[test]
    fn texts_are_escaped_and_pictures_are_named() {
        let tex = figure(2, &[(8, 8), (8, 4)]).tex();
        assert_eq!(tex.matches("\\includegraphics").count(), 1 + 2 * 2, "{tex}");
        // The frames of all crops, and those on the picture.
        assert_eq!(tex.matches("\\framebox").count(), 2 * 2 + 2, "{tex}");
        for words in ["{picture.png}", "method\\_1\\\\ $(1.2 \\pm 0.3) \\cdot 10^{-5}$", "\\strut Reference}"]
        {
            assert!(tex.contains(words), "{words}: {tex}");
        }
        // A line's end is a space, by which what follows would be shifted.
        let inner = tex.split("\\begingroup\n").nth(1).and_then(|rest| rest.split("\\end{picture}").next());
        assert!(inner.is_some_and(|inner| inner.lines().all(|line| line.ends_with('%'))), "{tex}");
        assert_eq!(tex.matches('{').count(), tex.matches('}').count(), "{tex}");
    }
}
