//! The bytes of a buffer as a table, by the type that a shader gives the buffer.

use crate::interface::{ShaderInterface, TypeLayout};
use std::fmt;

/// The most columns that nested structs are taken apart into. What is left is shown as words.
const MAX_COLUMNS: usize = 512;
/// The deepest nesting of structs and arrays that is taken apart.
const MAX_DEPTH: usize = 16;
/// The most numbers of a cell.
pub const MAX_NUMBERS: usize = 256;

/// The layout of a buffer that is read as a table.
///
/// An array gives the rows: that of a `var<storage> lights: array<Light>`, or the one that ends a struct. The members
/// of the struct before it are the header. A struct without an array at its end is a header alone.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct BufferLayout {
    /// The type of the whole as WGSL writes it: `array<Light>`.
    pub ty: String,
    /// The columns of the header, before the rows.
    pub header: Vec<Column>,
    /// The columns of a row: the members of its struct. Members of structs within it have dotted names,
    /// `hit.position`.
    pub columns: Vec<Column>,
    /// Bytes before the first row.
    start: usize,
    /// Bytes from one row to the next; 0 where there are none.
    stride: usize,
    /// Number of rows, where the type fixes it.
    count: Option<usize>,
}

/// A column of a table, or a field of its header: a scalar, a vector, a matrix, or an array of these.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Column {
    /// Its name: `position`, `hit.position` or `corners[2].uv`; `value` for an array of plain numbers.
    pub name: String,
    /// The type as WGSL writes it: `vec3<f32>`.
    pub ty: String,
    /// Bytes from the start of the row, or of the buffer for the header.
    pub offset: usize,
    shape: Shape,
}

/// Where the numbers of a column are, from its offset.
#[derive(Clone, Debug, PartialEq, Eq)]
struct Shape {
    scalar: Scalar,
    /// Number and distance in bytes of what each dimension repeats, outermost first.
    dimensions: Vec<(usize, usize)>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Scalar {
    F32,
    U32,
    I32,
}

/// One number of a buffer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Number {
    /// `f32`
    F32(f32),
    /// `u32`, and any word of another type
    U32(u32),
    /// `i32`
    I32(i32),
}

/// The value of a column in a row: one number, those of a vector, or those of a matrix column by column.
///
/// An array has at most the first [`MAX_NUMBERS`] of its numbers here. What the buffer is too short for is missing.
#[derive(Clone, Debug, PartialEq)]
pub struct Cell(pub Vec<Number>);

/// The bytes of a buffer as a table, whose rows are decoded when they are asked for.
#[derive(Clone, Copy, Debug)]
pub struct Table<'a> {
    layout: &'a BufferLayout,
    bytes: &'a [u8],
}

impl BufferLayout {
    /// Returns the layout of a buffer that a shader declares as this type: that of a
    /// [`GlobalKind::Storage`](crate::GlobalKind::Storage).
    pub fn new(interface: &ShaderInterface, layout: &TypeLayout) -> BufferLayout {
        let ty = layout.ty.clone();
        let members = interface.layout(&ty).map_or(&[][..], |layout| &layout.members);
        // A struct of which the last member is an array.
        let tail = members.split_last().and_then(|(last, before)| {
            let (element, count) = array(&last.ty)?;
            let stride = match (count, &layout.element) {
                (Some(count), _) => last.size as usize / count.max(1),
                (None, Some((_, stride))) => *stride as usize,
                (None, None) => return None,
            };
            Some((last, before, element, count, stride))
        });
        let mut columns = Flattened { interface, columns: Vec::new() };
        let mut header = Flattened { interface, columns: Vec::new() };
        let (start, stride, count) = if let Some((last, before, element, count, stride)) = tail {
            for member in before {
                header.add(&member.name, &member.ty, member.offset as usize, member.size as usize, 0);
            }
            columns.element(&last.name, element, stride);
            (last.offset as usize, stride, count)
        } else if let Some((element, stride)) = &layout.element {
            let stride = *stride as usize;
            columns.element("value", element, stride);
            let count = (!layout.runtime_sized).then_some(layout.size as usize / stride.max(1));
            (0, stride, count)
        } else {
            header.element("value", &ty, layout.size as usize);
            (layout.size as usize, 0, Some(0))
        };
        BufferLayout { ty, header: header.columns, columns: columns.columns, start, stride, count }
    }

    /// Returns the bytes before the first row.
    pub fn start(&self) -> usize {
        self.start
    }

    /// Returns the bytes from one row to the next; 0 where there are no rows.
    pub fn stride(&self) -> usize {
        self.stride
    }

    /// Returns the bytes of a buffer as a table. They may be fewer or more than whole rows.
    pub fn table<'a>(&'a self, bytes: &'a [u8]) -> Table<'a> {
        Table { layout: self, bytes }
    }
}

impl<'a> Table<'a> {
    /// Returns what comes before the rows, in the order of the type.
    pub fn header(&self) -> impl Iterator<Item = (&'a Column, Cell)> {
        let Table { layout, bytes } = *self;
        layout.header.iter().map(move |column| (column, column.cell(bytes)))
    }

    /// Returns the columns of its rows.
    pub fn columns(&self) -> &'a [Column] {
        &self.layout.columns
    }

    /// Returns the number of whole rows.
    pub fn len(&self) -> usize {
        let BufferLayout { start, stride, count, .. } = *self.layout;
        let held = self.bytes.len().saturating_sub(start).checked_div(stride).unwrap_or(0);
        count.map_or(held, |count| held.min(count))
    }

    /// Returns whether there is no whole row.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Returns the cells of a row, one for each column; none for a row that there is not.
    pub fn row(&self, index: usize) -> Vec<Cell> {
        if index >= self.len() {
            return Vec::new();
        }
        let BufferLayout { start, stride, .. } = *self.layout;
        let at = start + index * stride;
        let row = &self.bytes[at..at + stride];
        self.layout.columns.iter().map(|column| column.cell(row)).collect()
    }

    /// Returns how many bytes at the end belong to no whole row.
    pub fn rest(&self) -> usize {
        let rows = self.layout.start + self.len() * self.layout.stride;
        self.bytes.len().saturating_sub(rows)
    }
}

impl Column {
    /// Returns how its numbers are held: their type as NumPy names it, `<f4`, `<u4` or `<i4`, and how many each dimension
    /// repeats, outermost first; none for one number. A column of a matrix of three rows has four, as it has in the buffer.
    pub fn held(&self) -> (&'static str, Vec<usize>) {
        let scalar = match self.shape.scalar {
            Scalar::F32 => "<f4",
            Scalar::U32 => "<u4",
            Scalar::I32 => "<i4",
        };
        let dimensions = &self.shape.dimensions;
        // What one of a dimension takes beyond the numbers in it is padding.
        let held = dimensions.iter().enumerate().map(|(i, (count, stride))| match i.checked_sub(1) {
            Some(outer) => dimensions[outer].1 / stride,
            None => *count,
        });
        (scalar, held.collect())
    }

    /// The value in these bytes, which begin with the row or the header.
    fn cell(&self, bytes: &[u8]) -> Cell {
        let mut numbers = Vec::new();
        self.shape.read(bytes.get(self.offset..).unwrap_or_default(), 0, 0, &mut numbers);
        Cell(numbers)
    }
}

impl Shape {
    /// Appends the numbers of a dimension, from the bytes at `at`.
    fn read(&self, bytes: &[u8], dimension: usize, at: usize, numbers: &mut Vec<Number>) {
        if let Some(&(count, stride)) = self.dimensions.get(dimension) {
            for i in 0..count {
                let at = at.saturating_add(stride.saturating_mul(i));
                if numbers.len() >= MAX_NUMBERS || at >= bytes.len() {
                    return;
                }
                self.read(bytes, dimension + 1, at, numbers);
            }
        } else if let Some(word) = bytes.get(at..).and_then(<[u8]>::first_chunk) {
            numbers.push(match self.scalar {
                Scalar::F32 => Number::F32(f32::from_le_bytes(*word)),
                Scalar::U32 => Number::U32(u32::from_le_bytes(*word)),
                Scalar::I32 => Number::I32(i32::from_le_bytes(*word)),
            });
        }
    }

    /// The shape of a type of plain numbers that takes `size` bytes; `None` for a struct or an array of structs.
    fn of(ty: &str, size: usize) -> Option<Shape> {
        let scalar = |ty: &str| match ty {
            "f32" => Some(Scalar::F32),
            "u32" => Some(Scalar::U32),
            "i32" => Some(Scalar::I32),
            _ => None,
        };
        if let Some(scalar) = scalar(ty) {
            return Some(Shape { scalar, dimensions: Vec::new() });
        }
        if let Some((element, Some(count))) = array(ty) {
            let stride = size / count.max(1);
            let mut shape = Shape::of(element, stride)?;
            shape.dimensions.insert(0, (count, stride));
            return Some(shape);
        }
        let (form, inner) = ty.strip_suffix('>')?.split_once('<')?;
        let scalar = scalar(inner)?;
        let dimensions = match (form, form.strip_prefix("vec"), form.strip_prefix("mat")) {
            ("atomic", ..) => Vec::new(),
            (_, Some(count), _) => vec![(count.parse().ok()?, 4)],
            (_, _, Some(sides)) => {
                let (columns, rows) = sides.split_once('x')?;
                let (columns, rows): (usize, usize) = (columns.parse().ok()?, rows.parse().ok()?);
                // A column is aligned as a vector is: one of three numbers takes the place of four.
                vec![(columns, if rows == 2 { 8 } else { 16 }), (rows, 4)]
            }
            _ => return None,
        };
        Some(Shape { scalar, dimensions })
    }
}

/// The type of the elements of an array, and their number where it is fixed.
fn array(ty: &str) -> Option<(&str, Option<usize>)> {
    let inner = ty.strip_prefix("array<")?.strip_suffix('>')?;
    // The number comes last; a comma before it belongs to the element.
    match inner.rsplit_once(',') {
        Some((element, count)) if !count.contains('>') => Some((element, Some(count.trim().parse().ok()?))),
        _ => Some((inner, None)),
    }
}

/// Columns that nested types are taken apart into.
struct Flattened<'a> {
    interface: &'a ShaderInterface,
    columns: Vec<Column>,
}

impl Flattened<'_> {
    /// Adds what makes a row: the members of a struct by their own names, or one value.
    fn element(&mut self, name: &str, ty: &str, size: usize) {
        let is_struct = self.interface.layout(ty).is_some();
        self.add(if is_struct { "" } else { name }, ty, 0, size, 0);
    }

    fn add(&mut self, name: &str, ty: &str, offset: usize, size: usize, depth: usize) {
        if let Some(shape) = Shape::of(ty, size) {
            self.columns.push(Column { name: name.to_owned(), ty: ty.to_owned(), offset, shape });
            return;
        }
        let room = depth < MAX_DEPTH && self.columns.len() < MAX_COLUMNS;
        if let Some(layout) = self.interface.layout(ty).filter(|_| room) {
            for member in &layout.members {
                let dot = if name.is_empty() { "" } else { "." };
                let (at, size) = (offset + member.offset as usize, member.size as usize);
                self.add(&format!("{name}{dot}{}", member.name), &member.ty, at, size, depth + 1);
            }
            return;
        }
        if let Some((element, Some(count))) = array(ty).filter(|_| room) {
            let stride = size / count.max(1);
            for i in 0..count {
                if self.columns.len() >= MAX_COLUMNS {
                    let (name, at) = (format!("{name}[{i}..]"), offset + i * stride);
                    self.words(name, ty, at, size - i * stride);
                    return;
                }
                self.add(&format!("{name}[{i}]"), element, offset + i * stride, stride, depth + 1);
            }
            return;
        }
        self.words(name.to_owned(), ty, offset, size);
    }

    /// Adds bytes of a type that is not taken apart, as words.
    fn words(&mut self, name: String, ty: &str, offset: usize, size: usize) {
        let shape = Shape { scalar: Scalar::U32, dimensions: vec![(size / 4, 4)] };
        self.columns.push(Column { name, ty: ty.to_owned(), offset, shape });
    }
}

impl fmt::Display for Number {
    /// Writes the number as Rust does.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Number::F32(x) => fmt::Display::fmt(x, f),
            Number::U32(n) => fmt::Display::fmt(n, f),
            Number::I32(n) => fmt::Display::fmt(n, f),
        }
    }
}

impl fmt::Display for Cell {
    /// Writes one number as it is, and several in parentheses: `(1, 0.5, 0)`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if let [number] = &self.0[..] {
            return number.fmt(f);
        }
        f.write_str("(")?;
        for (i, number) in self.0.iter().enumerate() {
            f.write_str(if i == 0 { "" } else { ", " })?;
            number.fmt(f)?;
        }
        f.write_str(")")
    }
}
