//! Reads meshes in Wavefront OBJ. The crates for this format name no lines in their errors; the part that renderers use is
//! vertices, texture coordinates, normals and polygons.

use std::collections::BTreeMap;

use glam::{Vec2, Vec3};

use super::shapes::fan;
use super::triangles::Triangles;

/// Returns the triangles of all groups of a file; polygons become fans. Materials and lines are left out.
///
/// # Errors
/// The error of the file, with its line.
pub(super) fn read(
    text: &str,
    take: impl Fn(usize, usize) -> Result<(), String>,
) -> Result<Triangles, String> {
    let mut file = File::default();
    let mut triangles = Triangles::default();
    let (mut normals, mut uvs) = (Vec::new(), Vec::new());
    let mut vertices = BTreeMap::new();
    let (mut some_normals, mut some_uvs) = (false, false);
    for (number, line) in (1..).zip(text.lines()) {
        let words = line.split('#').next().unwrap_or_default();
        let mut words = words.split_ascii_whitespace();
        let at_line = |problem: String| format!("line {number}: {problem}");
        match words.next() {
            Some("v") => file.positions.push(numbers(words, 3).map_err(at_line)?.into()),
            Some("vn") => file.normals.push(numbers(words, 3).map_err(at_line)?.into()),
            Some("vt") => {
                let [u, v, _] = numbers(words, 2).map_err(at_line)?;
                file.uvs.push(Vec2::new(u, v));
            }
            Some("f") => {
                let mut corners = Vec::new();
                for word in words {
                    let corner = file.corner(word).map_err(at_line)?;
                    let next = vertices.len() as u32;
                    let index = *vertices.entry(corner).or_insert(next);
                    if index == next {
                        let [position, uv, normal] = corner;
                        (some_uvs, some_normals) = (some_uvs | uv.is_some(), some_normals | normal.is_some());
                        triangles.positions.extend(position.map(|i| file.positions[i]));
                        uvs.push(uv.map_or(Vec2::ZERO, |i| file.uvs[i]));
                        normals.push(normal.map_or(Vec3::ZERO, |i| file.normals[i]));
                    }
                    corners.push(index);
                }
                if corners.len() < 3 {
                    return Err(at_line(format!("a face has 3 corners or more; found {}", corners.len())));
                }
                take(corners.len(), 64)?;
                triangles.indices.extend(fan(&corners));
            }
            _ => {}
        }
    }
    if triangles.indices.is_empty() {
        return Err("it has no faces".to_owned());
    }
    triangles.normals = some_normals.then_some(normals);
    triangles.uvs = some_uvs.then_some(uvs);
    Ok(triangles)
}

/// The lists of a file.
#[derive(Default)]
struct File {
    positions: Vec<Vec3>,
    uvs: Vec<Vec2>,
    normals: Vec<Vec3>,
}

impl File {
    /// Returns the indices of a corner, `v`, `v/vt`, `v//vn` or `v/vt/vn`.
    fn corner(&self, word: &str) -> Result<[Option<usize>; 3], String> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let mut corner = [None; 3];
        for (i, part) in word.split('/').enumerate() {
            let Some(count) = counts.get(i) else {
                return Err(format!(
                    "expected `v`, `v/vt`, `v//vn` or `v/vt/vn`, found `{}`",
                    super::report::shortened(word)
                ));
            };
            if !part.is_empty() {
                corner[i] = Some(index(part, *count)?);
            }
        }
        match corner[0] {
            Some(_) => Ok(corner),
            None => Err("a corner has no vertex".to_owned()),
        }
    }
}

/// Returns an index from 0. In the file it is from 1, or negative from the end.
fn index(text: &str, count: usize) -> Result<usize, String> {
    let number = text.parse::<i64>().ok();
    let from_start = number.filter(|number| *number > 0).map(|number| number - 1);
    let from_end = number.filter(|number| *number < 0).map(|number| number.saturating_add(count as i64));
    let index = from_start.or(from_end).and_then(|index| usize::try_from(index).ok());
    index.filter(|index| *index < count).ok_or_else(|| {
        format!("expected an index from 1 to {count}, found `{}`", super::report::shortened(text))
    })
}

/// Returns the first numbers of a line, of which `least` must be there.
fn numbers<'a>(words: impl Iterator<Item = &'a str>, least: usize) -> Result<[f32; 3], String> {
    let mut found = [0.0; 3];
    let mut count = 0;
    for (slot, word) in found.iter_mut().zip(words) {
        *slot = word
            .parse()
            .map_err(|_| format!("expected a number, found `{}`", super::report::shortened(word)))?;
        count += 1;
    }
    match count >= least {
        true => Ok(found),
        false => Err(format!("expected {least} numbers, found {count}")),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn free(_: usize, _: usize) -> Result<(), String> {
        Ok(())
    }

    #[test]
    fn polygons_become_triangles_and_corners_are_shared() {
        let text = "# a square\nv 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 1 1\nvn 0 0 1\no square\ng a\nusemtl b\n\
                    f 1/1/1 2/1/1 3/2/1 -1/2/1\n";
        let square = read(text, free).expect("a mesh");
        assert_eq!(square.indices, [0, 1, 2, 0, 2, 3]);
        assert_eq!(square.positions[3], Vec3::Y);
        assert_eq!(square.normals.expect("normals"), [Vec3::Z; 4]);
        assert_eq!(square.uvs.expect("coordinates")[2], Vec2::ONE);
    }

    #[test]
    fn errors_name_their_lines() {
        for (text, expected) in [
            ("ply\n", "it has no faces"),
            ("v 0 0\n", "line 1: expected 3 numbers, found 2"),
            ("\nv 0 0 x\n", "line 2: expected a number, found `x`"),
            ("v 0 0 0\nf 1 1 2\n", "line 2: expected an index from 1 to 1, found `2`"),
            ("v 0 0 0\nf 1 1 0\n", "line 2: expected an index from 1 to 1, found `0`"),
            ("v 0 0 0\nf 1 1\n", "line 2: a face has 3 corners or more; found 2"),
            ("v 0 0 0\nf 1 1 1/1\n", "line 2: expected an index from 1 to 0, found `1`"),
            ("v 0 0 0\nf 1 1 1/////\n", "line 2: expected `v`, `v/vt`, `v//vn` or `v/vt/vn`, found `1/////`"),
        ] {
            assert_eq!(read(text, free), Err(expected.to_owned()));
        }
    }
}
