//! Which names a position of a half-typed pipeline file takes: for editors.

use data_file::grammar::{Cursor, Frame, entries, unquoted};

/// The names that a position takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Wanted {
    /// Passes of the file and of those that it extends.
    Pass,
    /// What a link reads: `pass`, `pass.port`, `in.input`.
    Link,
    /// The end of a link: `pass.input`, `out.output`.
    LinkEnd,
    /// `parameter`, `pass.setting`
    Path,
    /// Pass types.
    PassType,
    /// Inputs of the pass.
    InputPort,
    /// Outputs of the pass.
    OutputPort,
    /// Settings of the pass.
    Setting,
    /// A value of a setting, or of the path that a `Set` begins with.
    Value,
    /// Parameters, in an expression.
    Parameter,
    /// Parameters of the files that this one extends.
    InheritedParameter,
    /// Outputs of the files that this one extends.
    InheritedOutput,
    /// Interfaces.
    Interface,
    /// Formats of textures.
    Format,
    /// Pipeline files.
    File,
    /// WGSL files.
    Shader,
}

/// A pass that is being typed.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct TypedPass<'t> {
    /// Its name.
    pub name: &'t str,
    /// The pass type.
    pub kind: &'t str,
    /// The shader of its pass type.
    pub shader: Option<&'t str>,
    /// The file of a sub-graph.
    pub file: Option<&'t str>,
    /// The inputs that are linked.
    pub inputs: Vec<&'t str>,
    /// The settings that are given.
    pub settings: Vec<&'t str>,
    /// The link that it is put into.
    pub from: Option<&'t str>,
}

/// Returns which names a position takes; none where it takes forms, numbers or any text.
pub fn wanted(cursor: &Cursor<'_>, text: &str) -> Option<Wanted> {
    let frame = cursor.frame(0)?;
    let at_key = cursor.at_key(text);
    match (frame.name, frame.key, frame.index) {
        (Some("Replace" | "Remove"), None, 0) => return Some(Wanted::Pass),
        (Some("Set"), None, 0) => return Some(Wanted::Path),
        (Some("Set"), None, 1) => return Some(Wanted::Value),
        (Some("Input"), None, 0) => return Some(Wanted::InputPort),
        (Some("Pass"), Some("kind"), _) => return Some(Wanted::PassType),
        (Some("Pass"), Some("shader"), _) => return Some(Wanted::Shader),
        (Some("Pass" | "Sub"), Some("when"), _) => return Some(Wanted::Parameter),
        (Some("Pass" | "Sub"), Some("off"), _) => return Some(Wanted::Link),
        (Some("Sub"), Some("file"), _) | (Some("Pipeline"), Some("extends"), _) => return Some(Wanted::File),
        (Some("Out"), Some("interface"), _) => return Some(Wanted::Interface),
        (Some("Out"), Some("format"), _) => return Some(Wanted::Format),
        (Some("Out"), Some("count" | "size"), _) => return Some(Wanted::Parameter),
        (Some(_), ..) => return None,
        _ => {}
    }
    let outer = cursor.frame(1)?;
    let is_pipeline = outer.name == Some("Pipeline");
    match (outer.name?, outer.key?, at_key) {
        ("Pass" | "Sub", "in", true) => Some(Wanted::InputPort),
        ("Pass" | "Sub", "in", false) | ("Pipeline" | "Sub", "outputs", false) => Some(Wanted::Link),
        ("Pass" | "Sub", "set", true) => Some(Wanted::Setting),
        ("Pass" | "Sub", "set", false) => Some(Wanted::Value),
        ("Pass", "out", true) => Some(Wanted::OutputPort),
        ("Pipeline" | "Sub", "inputs", false) => Some(Wanted::Interface),
        ("Pipeline", "parameters", true) => Some(Wanted::InheritedParameter),
        ("Pipeline", "outputs", true) if is_pipeline => Some(Wanted::InheritedOutput),
        ("Insert", "between", _) if frame.index == 0 => Some(Wanted::Link),
        ("Insert", "between", _) => Some(Wanted::LinkEnd),
        ("Out", "size", _) => Some(Wanted::Parameter),
        _ => None,
    }
}

/// Returns the innermost pass or sub-graph around a position.
pub fn typed_pass<'t>(cursor: &Cursor<'t>, text: &'t str) -> Option<TypedPass<'t>> {
    let is_pass = |frame: &Frame<'_>| matches!(frame.name, Some("Pass" | "Sub"));
    let index = cursor.frames.iter().rposition(is_pass)?;
    let fields = entries(text, cursor.frames[index].open);
    let field = |name: &str| fields.iter().find(|(key, _)| *key == name).map(|(_, value)| *value);
    let keys = |name: &str| -> Vec<&'t str> {
        let map = field(name).filter(|value| value.starts_with('{'));
        map.map_or(Vec::new(), |map| entries(map, 0).into_iter().map(|(key, _)| key).collect())
    };
    let around = index.checked_sub(1).map(|around| &cursor.frames[around]);
    let (name, from) = match around {
        Some(Frame { name: Some("Replace"), open, .. }) => (first(text, *open), None),
        Some(Frame { name: Some("Insert"), open, .. }) => {
            let insert = entries(text, *open);
            let find = |name: &str| insert.iter().find(|(key, _)| *key == name).map(|(_, value)| *value);
            (find("name").map(unquoted), find("between").and_then(|between| first(between, 0)))
        }
        Some(frame) => (frame.key, None),
        None => (None, None),
    };
    Some(TypedPass {
        name: name.unwrap_or_default(),
        kind: field("kind").map(unquoted).unwrap_or_default(),
        shader: field("shader").map(unquoted),
        file: field("file").map(unquoted),
        inputs: keys("in"),
        settings: keys("set"),
        from,
    })
}

/// Returns the text with which a bracket begins.
pub fn first(text: &str, open: usize) -> Option<&str> {
    let rest = text.get(open + 1..)?.trim_start();
    let end = rest.strip_prefix('"')?.find(['"', '\n'])?;
    rest.get(1..end + 1)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_position_takes_names_by_what_is_around_it() {
        use Wanted::*;
        let cases = [
            ("Pipeline(patch: [Replace(\"|", Some(Pass)),
            ("Pipeline(patch: [Set(\"a|", Some(Path)),
            ("Pipeline(patch: [Set(\"a\", |", Some(Value)),
            ("Pipeline(passes: {\"a\": Pass(kind: \"|", Some(PassType)),
            ("Pipeline(passes: {\"a\": Pass(in: {\"|", Some(InputPort)),
            ("Pipeline(passes: {\"a\": Pass(in: {\"x\": \"|", Some(Link)),
            ("Pipeline(passes: {\"a\": Pass(set: { |", Some(Setting)),
            ("Pipeline(passes: {\"a\": Pass(set: {\"x\": |", Some(Value)),
            ("Pipeline(passes: {\"a\": Sub(file: \"|", Some(File)),
            ("Pipeline(extends: \"|", Some(File)),
            ("Pipeline(outputs: {\"o\": \"|", Some(Link)),
            ("Pipeline(patch: [Insert(name: \"n\", between: (\"a\", \"|", Some(LinkEnd)),
            ("Pipeline(about: \"|", None),
            ("|", None),
        ];
        for (marked, expected) in cases {
            let at = marked.find('|').unwrap();
            let text = marked.replacen('|', "", 1);
            assert_eq!(wanted(&Cursor::new(&text, at), &text), expected, "{marked}");
        }
    }

    #[test]
    fn the_pass_around_a_position_is_read_on_both_sides_of_it() {
        let text = "P(patch: [Insert(name: \"n\", pass: Pass(in: {\"a\": \"\"}, set: {\"\n }, kind: \"k\"), between: (\"f\", \"t\"))])";
        let at = text.find("{\"\n").unwrap() + 2;
        let pass = typed_pass(&Cursor::new(text, at), text).unwrap();
        assert_eq!((pass.name, pass.kind, pass.from), ("n", "k", Some("f")));
        assert_eq!(pass.inputs, ["a"]);
    }
}
