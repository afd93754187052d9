//! The template of all pages.

use crate::chart::style_sheet;
use crate::escape::html;

const TEMPLATE: &str = include_str!("page.html");
const STYLE: &str = include_str!("page.css");

/// A page of HTML that contains everything it needs.
#[derive(Clone, Copy, Debug, Default)]
pub struct Page<'a> {
    /// The title, as text.
    pub title: &'a str,
    /// CSS in addition to that of all pages.
    pub style: &'a str,
    /// The content of `body`: HTML.
    pub body: &'a str,
    /// The script; a page without one allows none.
    pub script: &'a str,
}

impl Page<'_> {
    /// Returns the text of the file.
    pub fn html(&self) -> String {
        let (policy, script) = match self.script {
            "" => ("", String::new()),
            script => ("; script-src 'unsafe-inline'", format!("<script>\n{script}\n</script>\n")),
        };
        let mut parts = TEMPLATE.split("<!--");
        let mut out = parts.next().unwrap_or_default().to_owned();
        for part in parts {
            // Inserted text is not scanned for further placeholders.
            let (name, after) = part.split_once("-->").unwrap_or((part, ""));
            out += &match name {
                "title" => html(self.title),
                "policy" => policy.to_owned(),
                "style" => style_sheet() + STYLE + self.style,
                "body" => self.body.to_owned(),
                "script" => script.clone(),
                other => unreachable!("page.html has no placeholder `{other}`"),
            };
            out += after;
        }
        out
    }
}
