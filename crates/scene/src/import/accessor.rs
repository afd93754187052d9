//! Reads accessors, checking every range.

use gltf::json::accessor::{ComponentType, Type};
use gltf::json::validation::Checked;

use super::Importer;
use crate::error::SceneError;

/// The elements of an accessor, packed.
struct Elements {
    bytes: Vec<u8>,
    component: ComponentType,
    kind: Type,
    normalized: bool,
}

impl Importer<'_> {
    /// Returns the elements of an accessor with `N` components each, as floats; normalised integers are
    /// scaled to 0..1 or −1..1.
    pub(super) fn floats<const N: usize>(
        &self,
        index: usize,
        place: &str,
    ) -> Result<Vec<[f32; N]>, SceneError> {
        let elements = self.elements(index, place)?;
        if elements.kind.multiplicity() != N {
            let problem = format!("expected {N} components, found {:?} (for {place})", elements.kind);
            return Err(self.wrong(format!("accessor {index}"), problem));
        }
        let size = elements.component.size();
        let read = |bytes: &[u8]| component(bytes, elements.component, elements.normalized);
        let element = |bytes: &[u8]| std::array::from_fn(|i| read(&bytes[i * size..(i + 1) * size]));
        Ok(elements.bytes.chunks_exact(N * size).map(element).collect())
    }

    /// Returns the elements of an accessor of indices.
    pub(super) fn indices(&self, index: usize, place: &str) -> Result<Vec<u32>, SceneError> {
        let elements = self.elements(index, place)?;
        let unsigned =
            matches!(elements.component, ComponentType::U8 | ComponentType::U16 | ComponentType::U32);
        if elements.kind != Type::Scalar || !unsigned {
            let (kind, component) = (elements.kind, elements.component);
            let problem = format!(
                "expected unsigned scalars for indices, found {kind:?} of {component:?} (for {place})"
            );
            return Err(self.wrong(format!("accessor {index}"), problem));
        }
        // Each can be a corner of three triangles, of a strip.
        let place = format!("accessor {index}");
        self.take((elements.bytes.len() / elements.component.size()) as u64, 12, &place)?;
        Ok(unsigned_integers(&elements.bytes, elements.component))
    }

    /// Returns the elements of an accessor of joints, four each.
    pub(super) fn joints(&self, index: usize, place: &str) -> Result<Vec<[u32; 4]>, SceneError> {
        let elements = self.elements(index, place)?;
        let unsigned = matches!(elements.component, ComponentType::U8 | ComponentType::U16);
        if elements.kind != Type::Vec4 || !unsigned {
            let (kind, component) = (elements.kind, elements.component);
            let problem = format!(
                "expected Vec4 of U8 or U16 for joints, found {kind:?} of {component:?} (for {place})"
            );
            return Err(self.wrong(format!("accessor {index}"), problem));
        }
        let joints = unsigned_integers(&elements.bytes, elements.component);
        Ok(joints.chunks_exact(4).map(|four| std::array::from_fn(|i| four[i])).collect())
    }

    /// Returns an error unless a list has as many entries as there are positions.
    pub(super) fn same_count(
        &self,
        positions: usize,
        found: usize,
        what: &str,
        place: &str,
    ) -> Result<(), SceneError> {
        if found == positions {
            return Ok(());
        }
        Err(self.wrong(place, format!("{positions} positions, but {found} {what}")))
    }

    fn elements(&self, index: usize, used_by: &str) -> Result<Elements, SceneError> {
        let accessor = self.get(&self.root.accessors, index, "accessor", used_by)?;
        let place = format!("accessor {index}");
        let Checked::Valid(component) = accessor.component_type else {
            return Err(self.wrong(place, "its componentType is none of 5120 to 5123, 5125, 5126"));
        };
        let Checked::Valid(kind) = accessor.type_ else {
            return Err(self.wrong(place, "its type is none of SCALAR, VEC2 to VEC4, MAT2 to MAT4"));
        };
        let size = component.0.size() * kind.multiplicity();
        let count = accessor.count.0;
        // As they are in the file, and as the numbers that they become.
        let asked = size + 4 * kind.multiplicity();
        self.take(count, asked, &place)?;
        let mut bytes = match accessor.buffer_view {
            Some(view) => {
                self.packed(view.value(), accessor.byte_offset.unwrap_or_default().0, count, size, &place)?
            }
            // The base of a sparse accessor.
            None => vec![0; count as usize * size],
        };
        if let Some(sparse) = &accessor.sparse {
            let Checked::Valid(index_type) = sparse.indices.component_type else {
                return Err(self.wrong(place, "the componentType of its sparse indices is not unsigned"));
            };
            let (indices, values) = (&sparse.indices, &sparse.values);
            let n = sparse.count.0;
            self.take(n, asked + 8, &place)?;
            let offset = indices.byte_offset.0;
            let at = self.packed(indices.buffer_view.value(), offset, n, index_type.0.size(), &place)?;
            let values = self.packed(values.buffer_view.value(), values.byte_offset.0, n, size, &place)?;
            for (at, value) in unsigned_integers(&at, index_type.0).into_iter().zip(values.chunks_exact(size))
            {
                let start = at as usize * size;
                match bytes.get_mut(start..start + size) {
                    Some(element) => element.copy_from_slice(value),
                    None => return Err(self.wrong(place, format!("sparse index {at} is not below {count}"))),
                }
            }
        }
        Ok(Elements { bytes, component: component.0, kind, normalized: accessor.normalized })
    }

    /// Returns `count` elements of `size` bytes from a buffer view, without the gaps of its stride.
    fn packed(
        &self,
        view: usize,
        offset: u64,
        count: u64,
        size: usize,
        place: &str,
    ) -> Result<Vec<u8>, SceneError> {
        let bytes = self.view(view, place)?;
        let stride = self.root.buffer_views.get(view).and_then(|v| v.byte_stride).map_or(size, |s| s.0);
        if count == 0 {
            return Ok(Vec::new());
        }
        if stride < size {
            return Err(
                self.wrong(place, format!("buffer view {view} has a stride of {stride} for {size} bytes"))
            );
        }
        let end = (count - 1)
            .checked_mul(stride as u64)
            .and_then(|n| n.checked_add(size as u64)?.checked_add(offset))
            .filter(|end| *end <= bytes.len() as u64);
        let Some(end) = end else {
            let problem = format!(
                "{count} elements of {size} bytes at offset {offset}, stride {stride}, reach beyond buffer view {view} of {} bytes",
                bytes.len()
            );
            return Err(self.wrong(place, problem));
        };
        let bytes = &bytes[offset as usize..end as usize];
        if stride == size {
            return Ok(bytes.to_vec());
        }
        Ok(bytes.chunks(stride).flat_map(|element| &element[..size]).copied().collect())
    }
}

/// Converts one component from exactly its bytes, little-endian.
fn component(bytes: &[u8], component: ComponentType, normalized: bool) -> f32 {
    let (value, max) = match (component, bytes) {
        (ComponentType::I8, &[a]) => (f32::from(a as i8), 127.0),
        (ComponentType::U8, &[a]) => (f32::from(a), 255.0),
        (ComponentType::I16, &[a, b]) => (f32::from(i16::from_le_bytes([a, b])), 32767.0),
        (ComponentType::U16, &[a, b]) => (f32::from(u16::from_le_bytes([a, b])), 65535.0),
        (ComponentType::U32, &[a, b, c, d]) => (u32::from_le_bytes([a, b, c, d]) as f32, 4_294_967_295.0),
        (_, &[a, b, c, d]) => return f32::from_le_bytes([a, b, c, d]),
        _ => unreachable!("callers hand in as many bytes as the component has"),
    };
    if normalized { (value / max).max(-1.0) } else { value }
}

fn unsigned_integers(bytes: &[u8], component: ComponentType) -> Vec<u32> {
    let size = component.size();
    bytes.chunks_exact(size).map(|b| b.iter().rev().fold(0, |n, byte| n << 8 | u32::from(*byte))).collect()
}
