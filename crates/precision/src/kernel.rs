//! A probe as a compute shader.

use crate::interpret::Fault;
use crate::probe::{PROBE, Probe};
use crate::value::{Scalar, Value};
use naga::proc::Alignment;
use naga::valid::{Capabilities, ValidationFlags, Validator};
use naga::{Handle, Module, ResourceBinding, Type, TypeInner};
use shader_library::naga;

/// Inputs that a workgroup takes.
pub const GROUP: u32 = 64;

/// A compute shader of one entry point, [`Kernel::ENTRY`], with two buffers in group 0: the inputs in binding 0, and the
/// results, `vec4<f32>`, in binding 1. Each thread takes one input, and those beyond the last none.
#[derive(Debug)]
pub struct Kernel {
    /// The shader.
    pub module: Module,
    given: Handle<Type>,
    /// Bytes from an input to the next.
    stride: usize,
}

/// The buffers and the entry point.
const WRAPPER: &str = "
var<storage, read> precision_given: array<Given>;
var<storage, read_write> precision_results: array<vec4<f32>>;
@compute @workgroup_size(64)
fn precision_probe(@builtin(global_invocation_id) id: vec3<u32>) {
    if id.x >= arrayLength(&precision_results) {
        return;
    }
";

impl Kernel {
    /// The name of the entry point.
    pub const ENTRY: &str = "precision_probe";

    /// Makes the compute shader of a probe. Uniforms that its inputs have values for become private variables.
    ///
    /// # Errors
    /// Fails if inputs have types that no buffer holds.
    pub fn new(probe: &Probe) -> Result<Kernel, Fault> {
        let shader = &probe.shader;
        let mut text = shader.text().to_owned();
        let mut places = Vec::new();
        for (handle, global) in shader.module.global_variables.iter() {
            let is_given = probe.uniforms().any(|name| global.name.as_deref() == Some(name));
            if let Some(range) =
                shader.module.global_variables.get_span(handle).to_range().filter(|_| is_given)
            {
                places.push(range.start);
            }
        }
        // From the last, so that those before stay where they are.
        places.sort_unstable();
        for place in places.into_iter().rev() {
            let rest = text.split_off(place);
            text += &rest.replacen("<uniform>", "<private>", 1);
        }
        text += WRAPPER;
        for name in probe.uniforms() {
            text += &format!("    {name} = precision_given[id.x].{name};\n");
        }
        text += &format!("    precision_results[id.x] = {PROBE}(precision_given[id.x]);\n}}\n");

        let invalid = |error: String| Fault::new(format!("`{}` is no compute shader: {error}", probe.name));
        let mut module =
            naga::front::wgsl::parse_str(&text).map_err(|error| invalid(error.emit_to_string(&text)))?;
        module.entry_points.retain(|entry| entry.name == Self::ENTRY);
        naga::compact::compact(&mut module, naga::compact::KeepUnused::No);
        for (_, global) in module.global_variables.iter_mut() {
            let binding = match global.name.as_deref() {
                Some("precision_given") => 0,
                Some("precision_results") => 1,
                _ => continue,
            };
            global.binding = Some(ResourceBinding { group: 0, binding });
        }
        let checked = Validator::new(ValidationFlags::all(), Capabilities::empty()).validate(&module);
        checked.map_err(|error| invalid(error.emit_to_string(&text)))?;
        let given = module.types.iter().find(|(_, ty)| ty.name.as_deref() == Some("Given"));
        let (given, ty) = given.ok_or_else(|| invalid("it has no inputs".to_owned()))?;
        // A struct that a buffer holds has the alignment of its widest member, and a span that is a multiple of it.
        let size = ty.inner.size(module.to_ctx()) as usize;
        let stride = module.types.iter().find_map(|(_, ty)| match ty.inner {
            TypeInner::Array { base, stride, .. } if base == given => Some(stride as usize),
            _ => None,
        });
        Ok(Kernel { given, stride: stride.unwrap_or(size), module })
    }

    /// Returns the content of the buffer of inputs.
    ///
    /// # Errors
    /// Fails if they are not inputs of the probe.
    pub fn bytes(&self, given: &[Value<f32>]) -> Result<Vec<u8>, Fault> {
        let mut bytes = vec![0; given.len() * self.stride];
        for (place, given) in bytes.chunks_exact_mut(self.stride).zip(given) {
            self.write(self.given, given, place)
                .ok_or_else(|| Fault::new("the inputs are not the probe's"))?;
        }
        Ok(bytes)
    }

    fn write(&self, ty: Handle<Type>, value: &Value<f32>, place: &mut [u8]) -> Option<()> {
        let types = &self.module.types;
        match (&types[ty].inner, value) {
            (TypeInner::Scalar(_), Value::Scalar(scalar)) => put(place, *scalar),
            (TypeInner::Vector { .. }, Value::Vector(vector)) => {
                vector.components().iter().enumerate().try_for_each(|(i, x)| put(place.get_mut(4 * i..)?, *x))
            }
            (TypeInner::Matrix { rows, .. }, Value::Matrix(columns)) => {
                let stride = (Alignment::from(*rows) * 4) as usize;
                columns.iter().enumerate().try_for_each(|(i, column)| {
                    let rows = column.components().iter().enumerate();
                    rows.into_iter().try_for_each(|(row, x)| put(place.get_mut(stride * i + 4 * row..)?, *x))
                })
            }
            (TypeInner::Array { base, stride, .. }, Value::Composite(elements)) => {
                elements.iter().enumerate().try_for_each(|(i, element)| {
                    self.write(*base, element, place.get_mut(i * *stride as usize..)?)
                })
            }
            (TypeInner::Struct { members, .. }, Value::Composite(values)) => {
                members.iter().zip(values).try_for_each(|(member, value)| {
                    self.write(member.ty, value, place.get_mut(member.offset as usize..)?)
                })
            }
            _ => None,
        }
    }
}

fn put(place: &mut [u8], scalar: Scalar<f32>) -> Option<()> {
    let bits = match scalar {
        Scalar::I32(x) => x as u32,
        Scalar::U32(x) => x,
        Scalar::Float(x) => x.to_bits(),
        Scalar::Bool(_) => return None,
    };
    place.get_mut(..4)?.copy_from_slice(&bits.to_le_bytes());
    Some(())
}
