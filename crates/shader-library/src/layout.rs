//! Structs as both sides see them: the layout, a check that they agree, and bytes from named values.

use data_file::Value;
use std::fmt::Write as _;

/// A struct in memory.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct StructLayout {
    /// The struct's name.
    pub name: String,
    /// The members, in order.
    pub members: Vec<MemberLayout>,
    /// Size in bytes, with the padding at the end; of an array at the end that is sized at run time, nothing.
    pub size: u32,
}

/// A member of a struct.
#[derive(Clone, Debug, PartialEq, Eq, Hash)]
pub struct MemberLayout {
    /// The member's name.
    pub name: String,
    /// The type as WGSL writes it, without short names: `vec3<f32>`.
    pub ty: String,
    /// Bytes from the start of the struct.
    pub offset: u32,
    /// Size in bytes, without padding.
    pub size: u32,
}

impl StructLayout {
    /// Creates a layout from the name, type, offset and size of each member.
    pub fn new(name: &str, size: u32, members: &[(&str, &str, u32, u32)]) -> StructLayout {
        let member = |&(name, ty, offset, size): &(&str, &str, u32, u32)| MemberLayout {
            name: name.to_owned(),
            ty: ty.to_owned(),
            offset,
            size,
        };
        StructLayout { name: name.to_owned(), members: members.iter().map(member).collect(), size }
    }
}

/// The two declarations side by side, with a mark where they differ.
pub(crate) fn side_by_side(shader: &StructLayout, cpu: &StructLayout) -> String {
    let cell = |layout: &StructLayout, i: usize| -> String {
        layout
            .members
            .get(i)
            .map_or(String::new(), |m| format!("{:>4} {:>4}  {}: {}", m.offset, m.size, m.name, m.ty))
    };
    let rows = shader.members.len().max(cpu.members.len());
    let left: Vec<String> = (0..rows).map(|i| cell(shader, i)).collect();
    let width = left.iter().map(|cell| cell.chars().count()).max().unwrap_or(0).max(24);
    let heads = [("the shader", "the CPU"), ("  at size  member", "  at size  member")];
    let mut table = heads.map(|(left, right)| format!("  {left:<width$} | {right}\n")).concat();
    for (i, left) in left.iter().enumerate() {
        let same = shader.members.get(i) == cpu.members.get(i);
        let row = format!("{} {left:<width$} | {}", if same { ' ' } else { '>' }, cell(cpu, i));
        let _ = writeln!(table, "{}", row.trim_end());
    }
    let mark = if shader.size == cpu.size { ' ' } else { '>' };
    let total = |layout: &StructLayout| format!("     {:>4}  in all", layout.size);
    let _ = write!(table, "{mark} {:<width$} | {}", total(shader), total(cpu));
    table
}

/// Why a struct could not be filled.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("the struct `{name}` cannot be filled:{}", .problems.iter().map(|p| format!("\n  {p}")).collect::<String>())]
pub struct WriteError {
    /// The struct.
    pub name: String,
    /// Members for which there is no value.
    pub missing: Vec<String>,
    /// One line for each member that has no value, or one of another type.
    pub problems: Vec<String>,
}

/// Returns the bytes of a uniform, filled member by member with the values of the members' names. Booleans are 0 and 1 in
/// integers; integers fit into floats. Padding is zero.
///
/// # Errors
/// All members that have no value, a value of another type, or a type that no value has.
pub fn write_struct(
    layout: &StructLayout,
    get: &dyn Fn(&str) -> Option<Value>,
) -> Result<Vec<u8>, WriteError> {
    let mut bytes = vec![0; layout.size as usize];
    let (mut missing, mut problems) = (Vec::new(), Vec::new());
    for member in &layout.members {
        let Some(value) = get(&member.name) else {
            missing.push(member.name.clone());
            problems.push(format!("`{}: {}` has no value", member.name, member.ty));
            continue;
        };
        let written = words(&member.ty, &value).filter(|words| words.len() * 4 == member.size as usize);
        let start = member.offset as usize;
        let place = bytes.get_mut(start..start.saturating_add(member.size as usize));
        match (written, place) {
            (Some(words), Some(place)) => {
                for (to, word) in place.chunks_exact_mut(4).zip(words) {
                    to.copy_from_slice(&word);
                }
            }
            _ => problems.push(format!("`{}: {}` cannot hold {value}", member.name, member.ty)),
        }
    }
    if problems.is_empty() {
        Ok(bytes)
    } else {
        Err(WriteError { name: layout.name.clone(), missing, problems })
    }
}

/// A value as 32-bit words of a WGSL type; `None` where it is not one of the type.
fn words(ty: &str, value: &Value) -> Option<Vec<[u8; 4]>> {
    let (scalar, count) =
        match ty.strip_prefix("vec").and_then(|rest| rest.strip_suffix('>')?.split_once('<')) {
            Some((count, scalar)) => (scalar, count.parse::<usize>().ok()?),
            None => (ty, 1),
        };
    let word = |value: &Value| -> Option<[u8; 4]> {
        Some(match (scalar, value) {
            ("f32", value) => value.as_f32()?.to_le_bytes(),
            ("u32" | "i32", Value::Bool(b)) => u32::from(*b).to_le_bytes(),
            ("u32", value) => value.as_u32()?.to_le_bytes(),
            ("i32", Value::I32(n)) => n.to_le_bytes(),
            ("i32", Value::U32(n)) => i32::try_from(*n).ok()?.to_le_bytes(),
            _ => return None,
        })
    };
    match value {
        Value::Vector(components) if count > 1 && components.len() == count => {
            components.iter().map(|&x| word(&component(scalar, x)?)).collect()
        }
        _ if count == 1 => Some(vec![word(value)?]),
        _ => None,
    }
}

/// A component of a vector in the type of the vector's components; `None` where it is none of them.
fn component(scalar: &str, x: f32) -> Option<Value> {
    match scalar {
        "f32" => Some(Value::F32(x)),
        "u32" => (x.fract() == 0.0 && (0.0..4294967296.0).contains(&x)).then_some(Value::U32(x as u32)),
        _ => (x.fract() == 0.0 && (-2147483648.0..2147483648.0).contains(&x)).then_some(Value::I32(x as i32)),
    }
}
