//! The shader interface: what a shader binds, takes and gives, which is all that a pass and an executor need to know of it.

use crate::layout::{MemberLayout, StructLayout};
use data_file::Value;

/// The shader interface that reflection finds: resources, entry points, structs and constants.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ShaderInterface {
    /// The resources, in the order of their names, which is that of their bindings.
    pub globals: Vec<Global>,
    /// The entry points, in the order of the text.
    pub entries: Vec<Entry>,
    /// The struct named `Settings`, if there is one.
    pub settings: Option<StructLayout>,
    /// All structs that have a layout in memory, in the order of the text.
    pub structs: Vec<StructLayout>,
    /// The same structs, each as the content of a buffer.
    pub contents: Vec<TypeLayout>,
    /// The named constants that are single numbers or booleans, in the order of the text.
    pub constants: Vec<(String, Value)>,
}

impl ShaderInterface {
    /// Returns the resource of this name, with its index.
    pub fn global(&self, name: &str) -> Option<(usize, &Global)> {
        self.globals.iter().enumerate().find(|(_, global)| global.name == name)
    }

    /// Returns the entry point of this name.
    pub fn entry(&self, name: &str) -> Option<&Entry> {
        self.entries.iter().find(|entry| entry.name == name)
    }

    /// Returns the struct of this name.
    pub fn layout(&self, name: &str) -> Option<&StructLayout> {
        self.structs.iter().find(|layout| layout.name == name)
    }

    /// Returns the member of this name in a struct, or in a struct that is its member; its offset is that in the outer one.
    pub fn member(&self, structure: &str, name: &str) -> Option<MemberLayout> {
        let members = &self.layout(structure)?.members;
        let own = members.iter().find(|member| member.name == name).cloned();
        own.or_else(|| {
            members.iter().find_map(|outer| {
                let inner = self.member(&outer.ty, name)?;
                Some(MemberLayout { offset: outer.offset + inner.offset, ..inner })
            })
        })
    }

    /// Returns the value of the constant of this name.
    pub fn constant(&self, name: &str) -> Option<&Value> {
        self.constants.iter().find(|(constant, _)| constant == name).map(|(_, value)| value)
    }
}

/// A resource that a shader declares.
#[derive(Clone, Debug, PartialEq)]
pub struct Global {
    /// The name of the variable, by which it is bound.
    pub name: String,
    /// The binding in group 0: the position among the sorted names.
    pub binding: u32,
    /// The kind of resource.
    pub kind: GlobalKind,
}

/// The kind of a resource.
#[derive(Clone, Debug, PartialEq)]
pub enum GlobalKind {
    /// `var<uniform>`
    Uniform {
        /// The type of the content.
        layout: TypeLayout,
    },
    /// `var<storage>`
    Storage {
        /// Declared `read_write`.
        writable: bool,
        /// The type of the content.
        layout: TypeLayout,
    },
    /// A texture to sample or load from.
    Texture {
        /// Its dimension.
        dimension: Dimension,
        /// The type of a texel.
        sample: Sample,
        /// With several samples a texel.
        multisampled: bool,
    },
    /// A texture to store to, load from, or both.
    StorageTexture {
        /// Its dimension.
        dimension: Dimension,
        /// The format as WGSL writes it: `rgba16float`.
        format: &'static str,
        /// Loads, stores, or both.
        access: Access,
    },
    /// A sampler.
    Sampler {
        /// `sampler_comparison`
        comparison: bool,
    },
    /// An acceleration structure for ray queries.
    AccelerationStructure,
}

/// The dimension of a texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are WebGPU's")]
pub enum Dimension {
    D1,
    D2,
    D2Array,
    D3,
    Cube,
    CubeArray,
}

/// The type of a texel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Sample {
    /// `texture_…<f32>`
    Float {
        /// Some entry point samples it with a sampler, so its format must be filterable if that sampler is.
        sampled: bool,
    },
    /// `texture_…<u32>`
    Uint,
    /// `texture_…<i32>`
    Sint,
    /// `texture_depth_…`
    Depth,
}

/// The access of a shader to a storage texture.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Access {
    /// `read`
    Read,
    /// `write`
    Write,
    /// `read_write`
    ReadWrite,
    /// `atomic`
    Atomic,
}

/// The type of the content of a buffer.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TypeLayout {
    /// The type as WGSL writes it: `array<Light>`.
    pub ty: String,
    /// Bytes of the part whose size is fixed; 0 for an array sized at run time.
    pub size: u32,
    /// For an array, or the array sized at run time that ends the struct: an element's type, and the bytes
    /// from one to the next.
    pub element: Option<(String, u32)>,
    /// The number of elements is that of the buffer.
    pub runtime_sized: bool,
}

impl TypeLayout {
    /// Returns the size in bytes of a buffer with `count` elements in the array sized at run time; of a type of fixed
    /// size, the size of `count` of them one after the other.
    pub fn bytes(&self, count: u64) -> u64 {
        match self.element.as_ref().filter(|_| self.runtime_sized) {
            Some((_, stride)) => u64::from(self.size) + u64::from(*stride) * count,
            None => u64::from(self.size) * count,
        }
    }
}

/// The stage of an entry point.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
#[allow(missing_docs, reason = "the names are WebGPU's")]
pub enum Stage {
    Compute,
    Vertex,
    Fragment,
}

/// An entry point.
#[derive(Clone, Debug, PartialEq)]
pub struct Entry {
    /// The function's name.
    pub name: String,
    /// The stage.
    pub stage: Stage,
    /// Invocations of a workgroup, with pipeline-overridable constants at their defaults; zeros outside of compute, and
    /// where such a constant has no default.
    pub workgroup_size: [u32; 3],
    /// Indices of the resources that it or what it calls uses, in order.
    pub globals: Vec<usize>,
    /// The attributes of a vertex shader, or what a fragment shader takes from the vertex shader.
    pub inputs: Vec<Location>,
    /// The colors of a fragment shader, or what a vertex shader hands on.
    pub outputs: Vec<Location>,
}

/// A value at a `@location`.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Location {
    /// The number.
    pub location: u32,
    /// The name of the parameter or member; empty for a result without one.
    pub name: String,
    /// The type as WGSL writes it: `vec4<f32>`.
    pub ty: String,
}
