//! Reads meshes in PLY: as text, and as binary of both byte orders.

use std::io::Cursor;

use glam::{Vec2, Vec3};
use ply_rs_bw::parser::{Parser, Reader};
use ply_rs_bw::ply::{Property, PropertyAccess, PropertyAccessResult};

use super::shapes::fan;
use super::triangles::Triangles;

/// A vertex or a face: the properties that are read.
struct Element {
    position: Vec3,
    normal: Vec3,
    uv: Vec2,
    /// The vertices of a face.
    corners: Option<Vec<u32>>,
}

impl PropertyAccess for Element {
    fn new() -> Element {
        Element { position: Vec3::NAN, normal: Vec3::NAN, uv: Vec2::NAN, corners: None }
    }

    fn set_property(&mut self, name: &str, property: Property) -> PropertyAccessResult {
        let slot = match name {
            "x" => &mut self.position.x,
            "y" => &mut self.position.y,
            "z" => &mut self.position.z,
            "nx" => &mut self.normal.x,
            "ny" => &mut self.normal.y,
            "nz" => &mut self.normal.z,
            "u" | "s" | "texture_u" | "texture_s" => &mut self.uv.x,
            "v" | "t" | "texture_v" | "texture_t" => &mut self.uv.y,
            "vertex_indices" | "vertex_index" => {
                self.corners = property.to_u32_list();
                return PropertyAccessResult::Set;
            }
            _ => return PropertyAccessResult::Ignored,
        };
        match property.to_f32_lossy() {
            Some(value) => {
                *slot = value;
                PropertyAccessResult::Set
            }
            None => PropertyAccessResult::Ignored,
        }
    }
}

/// Returns the triangles of a file; polygons become fans. `take` counts bytes before they are allocated.
///
/// # Errors
/// The error of the file, with its line where that is known.
pub(super) fn read(
    bytes: &[u8],
    take: impl Fn(usize, usize) -> Result<(), String>,
) -> Result<Triangles, String> {
    let parser = Parser::<Element>::new();
    let mut reader = Reader::new(Cursor::new(bytes));
    let header = parser.read_header(&mut reader).map_err(|error| error.to_string())?;
    let mut elements = 0_usize;
    for element in header.elements.values() {
        if element.properties.is_empty() {
            return Err(format!("the element `{}` has no properties", element.name));
        }
        elements = elements.saturating_add(element.count);
    }
    // Each property takes a byte at least.
    if elements > bytes.len() {
        return Err(format!("the header states {elements} elements; the file has {} bytes", bytes.len()));
    }
    take(elements, 2 * size_of::<Element>())?;
    let mut triangles = Triangles::default();
    let (mut normals, mut uvs, mut polygons) = (Vec::new(), Vec::new(), None);
    for element in header.elements.values() {
        let of_file = parser
            .read_payload_for_element(&mut reader, element, &header)
            .map_err(|error| error.to_string())?;
        match element.name.as_str() {
            "vertex" => {
                for Element { position, normal, uv, .. } in of_file {
                    triangles.positions.push(position);
                    normals.push(normal);
                    uvs.push(uv);
                }
            }
            "face" => polygons = Some(of_file),
            _ => {}
        }
    }
    let count = triangles.positions.len();
    let polygons = polygons.ok_or("it has no element `face`")?;
    for (number, polygon) in polygons.iter().enumerate() {
        let corners = polygon.corners.as_deref();
        let corners = corners.ok_or("its faces have no list `vertex_indices` of integers")?;
        if let Some(corner) = corners.iter().find(|corner| **corner as usize >= count) {
            return Err(format!("face {number} names vertex {corner}; there are {count}"));
        }
        take(corners.len(), 12)?;
        triangles.indices.extend(fan(corners));
    }
    let has =
        |name: &str| header.elements.get("vertex").is_some_and(|vertex| vertex.properties.contains_key(name));
    if !["x", "y", "z"].iter().all(|name| has(name)) {
        return Err("its vertices have no position `x`, `y`, `z`".to_owned());
    }
    triangles.normals = has("nx").then_some(normals);
    triangles.uvs = uvs.first().is_some_and(|uv| !uv.is_nan()).then_some(uvs);
    Ok(triangles)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEADER: &str = "ply\nformat FORMAT 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty double y\n\
                          property float z\nproperty float u\nproperty float v\nelement face 1\n\
                          property list uchar int vertex_indices\nend_header\n";
    const SQUARE: [[f32; 5]; 4] = [
        [0.0, 0.0, 0.5, 0.0, 0.0],
        [1.0, 0.0, 0.5, 1.0, 0.0],
        [1.0, 1.0, 0.5, 1.0, 1.0],
        [0.0, 1.0, 0.5, 0.0, 1.0],
    ];

    fn header(format: &str) -> Vec<u8> {
        HEADER.replace("FORMAT", format).into_bytes()
    }

    /// The square as binary: `of` and `wide` return the bytes of numbers.
    fn binary(
        format: &str,
        of: fn(f32) -> [u8; 4],
        wide: fn(f64) -> [u8; 8],
        int: fn(i32) -> [u8; 4],
    ) -> Vec<u8> {
        let mut file = header(format);
        for [x, y, z, u, v] in SQUARE {
            file.extend(of(x));
            file.extend(wide(y.into()));
            [z, u, v].map(of).iter().for_each(|bytes| file.extend(bytes));
        }
        file.push(4);
        [0, 1, 2, 3].map(int).iter().for_each(|bytes| file.extend(bytes));
        file
    }

    fn free(_: usize, _: usize) -> Result<(), String> {
        Ok(())
    }

    #[test]
    fn text_and_both_byte_orders_are_the_same_square() {
        let mut text = header("ascii");
        text.extend(
            SQUARE.iter().flat_map(|row| format!("{row:?}\n").replace(['[', ']', ','], "").into_bytes()),
        );
        text.extend(b"4 0 1 2 3\n");
        let square = read(&text, free).expect("a mesh");
        assert_eq!(square.positions[2], Vec3::new(1.0, 1.0, 0.5));
        assert_eq!(square.indices, [0, 1, 2, 0, 2, 3]);
        assert_eq!(square.uvs.as_ref().expect("coordinates")[3], Vec2::Y);
        assert_eq!(square.normals, None);
        let little = binary("binary_little_endian", f32::to_le_bytes, f64::to_le_bytes, i32::to_le_bytes);
        assert_eq!(read(&little, free).as_ref(), Ok(&square));
        let big = binary("binary_big_endian", f32::to_be_bytes, f64::to_be_bytes, i32::to_be_bytes);
        assert_eq!(read(&big, free).as_ref(), Ok(&square));
        for end in 0..little.len() {
            assert!(read(&little[..end], free).is_err(), "cut off at {end}");
        }
    }

    #[test]
    fn what_asks_for_more_than_it_holds_is_refused() {
        let of = |from: &str, to: &str| {
            let text = HEADER.replace("FORMAT", "binary_little_endian").replace(from, to);
            read(text.as_bytes(), free).expect_err("it holds nothing")
        };
        assert!(of("vertex 4", "vertex 4000000000").contains("states 4000000001 elements"));
        assert!(of("property list uchar int vertex_indices\n", "").contains("no properties"));
        assert!(read(b"solid", free).is_err());
        let mut text = header("ascii");
        text.extend(b"0 0 0 0 0\n".repeat(4));
        text.extend(b"3 0 1 4\n");
        assert_eq!(read(&text, free), Err("face 0 names vertex 4; there are 4".to_owned()));
        assert_eq!(read(&text, |_, _| Err("too much".to_owned())), Err("too much".to_owned()));
    }
}
