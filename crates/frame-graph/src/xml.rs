//! Foreign text inside XML.

/// Escapes text for XML and HTML, outside of tags and in quoted attributes. Characters that XML 1.0 excludes, even as
/// references, become U+FFFD; so do the control characters that it discourages.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\'' => out.push_str("&#39;"),
            '\t' | '\n' | '\r' => out.push(c),
            '\u{fffe}' | '\u{ffff}' => out.push('\u{fffd}'),
            c if c.is_control() => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    use super::escape;

    #[test]
    fn nothing_of_a_text_becomes_markup() {
        assert_eq!(escape("a<b>&\"c'"), "a&lt;b&gt;&amp;&quot;c&#39;");
        assert_eq!(escape("ꟻLIP [m²]\t1\r\n"), "ꟻLIP [m²]\t1\r\n");
    }

    #[test]
    fn what_xml_has_no_place_for_is_replaced() {
        // Char of XML 1.0 §2.2, which leaves out the surrogates that a `str` does not hold either.
        let allowed = |c: char| matches!(c, '\t' | '\n' | '\r' | '\u{20}'..='\u{fffd}' | '\u{10000}'..);
        for c in '\0'..=char::MAX {
            let escaped = escape(&c.to_string());
            assert!(escaped.chars().all(allowed), "{c:?}");
            assert!(allowed(c) || escaped == "\u{fffd}", "{c:?}");
        }
    }
}
