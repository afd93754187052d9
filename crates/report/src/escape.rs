//! Escapes text for HTML, Markdown and LaTeX.

/// Escapes for HTML and SVG, in text and in quoted attributes.
pub use frame_graph::xml::escape as html;

/// Escapes for a cell of a Markdown table.
pub fn markdown(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' | '|' | '*' | '_' | '`' | '[' | ']' | '<' | '>' | '#' | '~' => out.extend(['\\', c]),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Escapes for LaTeX's text mode. Symbols in units and names of measures become commands, since pdfTeX's
/// fonts lack some of them.
pub fn latex(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '\\' => out.push_str("\\textbackslash{}"),
            '{' | '}' | '$' | '&' | '#' | '_' | '%' => out.extend(['\\', c]),
            '^' => out.push_str("\\textasciicircum{}"),
            '~' => out.push_str("\\textasciitilde{}"),
            '<' => out.push_str("\\textless{}"),
            '>' => out.push_str("\\textgreater{}"),
            '|' => out.push_str("\\textbar{}"),
            // OT1 fonts have no straight quotation mark.
            '"' => out.push_str("''"),
            'ꟻ' => out.push_str("\\reflectbox{F}"),
            '²' => out.push_str("$^2$"),
            '³' => out.push_str("$^3$"),
            '⁰' => out.push_str("$^0$"),
            '¹' => out.push_str("$^1$"),
            '⁴'..='⁹' => out.push_str(&format!("$^{}$", u32::from(c) - u32::from('⁰'))),
            '⁻' => out.push_str("$^-$"),
            '·' => out.push_str("$\\cdot$"),
            '×' => out.push_str("$\\times$"),
            '±' => out.push_str("$\\pm$"),
            '−' => out.push_str("$-$"),
            '′' => out.push_str("$'$"),
            'µ' | 'μ' => out.push_str("$\\mu$"),
            'σ' => out.push_str("$\\sigma$"),
            'δ' => out.push_str("$\\delta$"),
            'ε' => out.push_str("$\\varepsilon$"),
            '≤' => out.push_str("$\\le$"),
            '≥' => out.push_str("$\\ge$"),
            '≈' => out.push_str("$\\approx$"),
            '√' => out.push_str("$\\surd$"),
            '∞' => out.push_str("$\\infty$"),
            'Δ' => out.push_str("$\\Delta$"),
            '→' => out.push_str("$\\to$"),
            '–' => out.push_str("--"),
            c if c.is_control() => out.push(' '),
            c => out.push(c),
        }
    }
    out
}

/// Returns text that can be part of a file name: letters, digits, `-` and `.`; never empty, never hidden.
pub fn file_name(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        let c = if c.is_ascii_alphanumeric() || c == '.' { c } else { '-' };
        if c != '-' || !out.ends_with('-') {
            out.push(c);
        }
    }
    let out = out.trim_matches(['-', '.']);
    if out.is_empty() { "unnamed".to_owned() } else { out.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_of_a_name_becomes_markup() {
        assert_eq!(markdown("a|b_c\n<i>"), "a\\|b\\_c \\<i\\>");
        assert_eq!(latex("50% of $x_1 & {\\a}"), "50\\% of \\$x\\_1 \\& \\{\\textbackslash{}a\\}");
        assert_eq!(latex("ꟻLIP [m²]"), "\\reflectbox{F}LIP [m$^2$]");
    }

    #[test]
    fn file_names_stay_in_their_folder() {
        assert_eq!(file_name("../../etc/passwd"), "etc-passwd");
        assert_eq!(file_name("<>&"), "unnamed");
        assert_eq!(file_name("ISM (256) v1.2"), "ISM-256-v1.2");
    }
}
