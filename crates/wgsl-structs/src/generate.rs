//! Rust text of declarations.

use crate::wgsl::{Constant, Member, Struct};
use std::fmt::Write as _;
use std::path::Path;

/// A declaration to generate.
pub(crate) struct Item {
    /// `pub`, `pub(crate)` or nothing.
    pub(crate) visibility: String,
    /// `struct`, `use`, `const` or `fn`.
    pub(crate) keyword: String,
    /// The name in WGSL.
    pub(crate) wgsl: String,
    /// The name in Rust, of a struct that is used with its path.
    pub(crate) rust: String,
}

/// Returns an item that has the compiler run again when the file changes.
pub(crate) fn dependency(path: &Path) -> String {
    format!("const _: &[u8] = ::core::include_bytes!({path:?});\n")
}

/// Returns the struct in Rust.
pub(crate) fn structure(file: &str, structure: &Struct, item: &Item) -> String {
    let Item { visibility, rust: name, .. } = item;
    let mut docs = structure.docs.clone();
    let what = if structure.rows.is_some() { "The members before the array in `struct" } else { "`struct" };
    docs.extend([String::new(), format!("{what} {}` of {}.", item.wgsl, file_name(file))]);
    let mut code = doc_attributes(&docs);
    code += "#[repr(C)]\n#[derive(Clone, Copy, Debug, Default, PartialEq, ::bytemuck::Pod, ::bytemuck::Zeroable)]\n";
    let _ = writeln!(code, "{visibility} struct {name} {{");
    let (mut end, mut gaps) = (0, 0);
    let mut fill_to = |offset: u32, end: u32, code: &mut String| {
        if offset > end {
            let _ =
                writeln!(code, "/// Padding.\n{visibility} padding_{gaps}: [u32; {}],", (offset - end) / 4);
            gaps += 1;
        }
    };
    for member in &structure.members {
        fill_to(member.offset, end, &mut code);
        end = member.offset + member.ty.size;
        let is_padding = member.docs.is_empty() && member.name.starts_with("pad");
        let padding = ["Padding.".to_owned()];
        code += &doc_attributes(if is_padding { &padding } else { &member.docs });
        let _ = writeln!(code, "{visibility} r#{}: {},", member.name, member.ty.rust);
    }
    fill_to(structure.size, end, &mut code);
    code + "}\n" + &checks(structure, name)
}

/// Returns assertions that a struct in Rust has the layout of the WGSL.
pub(crate) fn checks(structure: &Struct, name: &str) -> String {
    let mut code =
        format!("const _: () = {{\nassert!(::core::mem::size_of::<{name}>() == {});\n", structure.size);
    for Member { name: member, offset, .. } in &structure.members {
        let of = format!("::core::mem::offset_of!({name}, r#{member})");
        let _ = writeln!(code, "assert!({of} == {offset});");
    }
    code + "};\n"
}

/// Returns the constant in Rust.
pub(crate) fn constant(file: &str, constant: &Constant, item: &Item) -> String {
    let mut docs = constant.docs.clone();
    docs.extend([String::new(), format!("`{}` of {}.", item.wgsl, file_name(file))]);
    let Constant { ty, value, .. } = constant;
    format!("{}{} const {}: {ty} = {value};\n", doc_attributes(&docs), item.visibility, item.rust)
}

/// Returns the function that returns the layouts of structs.
pub(crate) fn layouts(structs: &[Struct], item: &Item) -> String {
    let mut code = format!(
        "/// Returns the layouts of the structs that Rust and WGSL share.\n{} fn {}() -> \
         ::std::vec::Vec<::shader_library::StructLayout> {{\n::std::vec![\n",
        item.visibility, item.rust
    );
    for structure in structs {
        let _ = writeln!(
            code,
            "::shader_library::StructLayout::new({:?}, {}, &[",
            structure.name, structure.size
        );
        for member in structure.members.iter().chain(&structure.rows) {
            let _ = writeln!(
                code,
                "({:?}, {:?}, {}, {}),",
                member.name, member.ty.wgsl, member.offset, member.ty.size
            );
        }
        code += "]),\n";
    }
    code + "]\n}\n"
}

fn file_name(file: &str) -> &str {
    file.rsplit('/').next().unwrap_or(file)
}

/// Returns documentation as attributes; what is in brackets is no link.
fn doc_attributes(lines: &[String]) -> String {
    let escaped = |line: &String| {
        let parts = line.split('`').enumerate().map(|(i, part)| match i % 2 {
            0 => part.replace('[', "\\[").replace(']', "\\]").replace('<', "\\<"),
            _ => part.to_owned(),
        });
        parts.collect::<Vec<_>>().join("`")
    };
    let lines = lines.iter().skip_while(|line| line.is_empty());
    lines.map(|line| format!("#[doc = {:?}]\n", escaped(line))).collect()
}
