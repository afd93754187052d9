//! Interfaces: the types of ports, with their resources and facts.

use crate::port::Facts;
use crate::resource::Format;
use data_file::{Value, ValueType};
use std::marker::PhantomData;

/// The type of a port: a set of resources that one link joins. Passes with the same interface can replace each other.
#[derive(Clone, Debug, PartialEq)]
pub struct Interface {
    /// The name, in CamelCase: `GBuffer`.
    pub name: &'static str,
    /// What it holds, with units.
    pub doc: &'static str,
    /// Its resources, in order.
    pub members: &'static [Member],
    /// The facts that its producers give.
    pub facts: &'static [FactDecl],
    /// The folder of its WGSL, from the root of the tree: shaders import the files there by their names alone. `None`
    /// where the interface has no WGSL.
    pub folder: Option<&'static str>,
    /// For an interface whose producers have a [`Module`](crate::Module): the module with which a consumer's shader is
    /// reflected before its producer is known.
    pub stand_in: Option<&'static str>,
    /// Numbers at the beginning of its first member, a struct, that report on a frame to a user.
    pub figures: &'static [Figure],
    /// The outputs of a pipeline that hold it, by their names: an output of such a name holds nothing else.
    pub outputs: &'static [&'static str],
}

impl Interface {
    /// Declares an interface without facts and without WGSL.
    pub const fn new(name: &'static str, doc: &'static str, members: &'static [Member]) -> Interface {
        Interface { name, doc, members, facts: &[], folder: None, stand_in: None, figures: &[], outputs: &[] }
    }

    /// Returns the same with these facts.
    pub const fn with_facts(self, facts: &'static [FactDecl]) -> Interface {
        Interface { facts, ..self }
    }

    /// Returns the same with the folder of its WGSL.
    pub const fn with_folder(self, folder: &'static str) -> Interface {
        Interface { folder: Some(folder), ..self }
    }

    /// Returns the same with the module that stands in for those of its producers.
    pub const fn with_stand_in(self, module: &'static str) -> Interface {
        Interface { stand_in: Some(module), ..self }
    }

    /// Returns the same with these figures.
    pub const fn with_figures(self, figures: &'static [Figure]) -> Interface {
        Interface { figures, ..self }
    }

    /// Returns the same with the names of outputs of pipelines that hold it.
    pub const fn with_outputs(self, outputs: &'static [&'static str]) -> Interface {
        Interface { outputs, ..self }
    }

    /// Returns the member of that name; `""` for the only one.
    pub fn member(&self, name: &str) -> Option<&'static Member> {
        self.members.iter().find(|member| member.name == name)
    }

    /// Returns the declaration of the fact of that name.
    pub fn fact(&self, name: &str) -> Option<&'static FactDecl> {
        self.facts.iter().find(|fact| fact.name == name)
    }
}

/// A number that a pass reports about a frame: a scalar of the struct that an interface's first member holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Figure {
    /// The name of the struct's member, a `u32` or an `f32`.
    pub name: &'static str,
    /// What it counts or measures.
    pub doc: &'static str,
    /// The unit; empty for none.
    pub unit: &'static str,
}

impl Figure {
    /// Declares a figure.
    pub const fn new(name: &'static str, doc: &'static str, unit: &'static str) -> Figure {
        Figure { name, doc, unit }
    }
}

/// One resource of an [`Interface`].
#[derive(Clone, Debug, PartialEq)]
pub struct Member {
    /// Name, unique within the interface; empty for the only resource of an interface with one.
    pub name: &'static str,
    /// Whether a producer may leave it out.
    pub optional: bool,
    /// What sort of resource it is.
    pub content: Content,
    /// What it holds: shape and unit.
    pub doc: &'static str,
}

impl Member {
    /// Declares a resource that every producer has.
    pub const fn required(name: &'static str, content: Content, doc: &'static str) -> Member {
        Member { name, optional: false, content, doc }
    }

    /// Declares a resource that a producer may leave out.
    pub const fn optional(name: &'static str, content: Content, doc: &'static str) -> Member {
        Member { name, optional: true, content, doc }
    }
}

/// What sort of resource a [`Member`] is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Content {
    /// A texture. The passes of the tree write it in this format, and a pass in WGSL alone that names no format for a
    /// target gets it. Consumers read any format of the same sort.
    Texture(Format),
    /// The same with layers.
    TextureArray(Format),
    /// A buffer that holds this struct.
    Struct(Struct),
    /// A buffer that holds an array of this type: `u32`.
    Array(&'static str),
    /// A buffer whose content the producer's module alone reads.
    Buffer,
}

impl Content {
    /// Returns the format of a texture.
    pub fn format(self) -> Option<Format> {
        match self {
            Content::Texture(format) | Content::TextureArray(format) => Some(format),
            Content::Struct(_) | Content::Array(_) | Content::Buffer => None,
        }
    }
}

/// A struct of a WGSL file, whose layout in memory is found by reflection of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Struct {
    /// The file, from the root of the tree.
    pub file: &'static str,
    /// The name of the struct.
    pub name: &'static str,
}

impl Struct {
    /// Names a struct.
    pub const fn new(file: &'static str, name: &'static str) -> Struct {
        Struct { file, name }
    }
}

/// The type of a fact's value: `u32`, `f32` or `bool`.
pub trait FactValue: Copy + Into<Value> {
    /// The type.
    const TYPE: ValueType;

    /// Reads a value of this type; `None` where it is of another one.
    fn read(value: &Value) -> Option<Self>;
}

impl FactValue for u32 {
    const TYPE: ValueType = ValueType::U32;

    fn read(value: &Value) -> Option<u32> {
        value.as_u32()
    }
}

impl FactValue for f32 {
    const TYPE: ValueType = ValueType::F32;

    fn read(value: &Value) -> Option<f32> {
        value.as_f32()
    }
}

impl FactValue for bool {
    const TYPE: ValueType = ValueType::Bool;

    fn read(value: &Value) -> Option<bool> {
        value.as_bool()
    }
}

/// A fact that the producers of an interface give and its consumers read: the one place where its name and its type
/// are written, so that a misspelt one does not compile.
///
/// Linking checks every producer against the [`FactDecl`]s of its interface.
pub struct Fact<T> {
    /// The name: a member `name` of a module's uniform `PORT_facts`, and `PORT_name` of a pass's `settings`.
    pub name: &'static str,
    /// Whether a producer may leave it out.
    pub optional: bool,
    /// Its meaning, with the unit.
    pub doc: &'static str,
    ty: PhantomData<fn() -> T>,
}

impl<T> Clone for Fact<T> {
    fn clone(&self) -> Fact<T> {
        *self
    }
}

impl<T> Copy for Fact<T> {}

impl<T: FactValue> Fact<T> {
    /// Declares a fact that every producer gives.
    pub const fn required(name: &'static str, doc: &'static str) -> Fact<T> {
        Fact { name, optional: false, doc, ty: PhantomData }
    }

    /// Declares a fact that a producer may leave out.
    pub const fn optional(name: &'static str, doc: &'static str) -> Fact<T> {
        Fact { name, optional: true, doc, ty: PhantomData }
    }

    /// Returns the declaration for [`Interface::facts`].
    pub const fn decl(self) -> FactDecl {
        FactDecl { name: self.name, ty: T::TYPE, optional: self.optional, doc: self.doc }
    }

    /// Returns the value among the facts of a port.
    pub fn of(self, facts: &Facts) -> Option<T> {
        facts.get(self.name).and_then(T::read)
    }
}

/// A [`Fact`] as an [`Interface`] lists it: its type is a value here.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FactDecl {
    /// The name.
    pub name: &'static str,
    /// The type of its values.
    pub ty: ValueType,
    /// Whether a producer may leave it out.
    pub optional: bool,
    /// Its meaning, with the unit.
    pub doc: &'static str,
}

/// Compares the facts that a producer gives with those that the interface declares. The error says what is wrong, as
/// a clause whose subject is the pass type.
pub(crate) fn check_facts(interface: &Interface, port: &str, facts: &Facts) -> Result<(), String> {
    let name = interface.name;
    for (fact, value) in facts.iter() {
        let Some(declared) = interface.fact(fact) else {
            let near = crate::nearest(fact, interface.facts.iter().map(|declared| declared.name));
            let near = near.map_or_else(String::new, |near| format!("; did you mean `{near}`?"));
            return Err(format!(
                "gives the fact `{fact}` with its output `{port}`, which the interface `{name}` does not declare{near}"
            ));
        };
        if value.ty() != declared.ty {
            return Err(format!(
                "gives the fact `{fact}` of its output `{port}` as {}; the interface `{name}` declares it as {}",
                value.ty().with_article(),
                declared.ty.with_article()
            ));
        }
    }
    match interface.facts.iter().find(|declared| !declared.optional && facts.get(declared.name).is_none()) {
        Some(missing) => Err(format!(
            "does not give the fact `{}` with its output `{port}`, which the interface `{name}` promises: {}",
            missing.name, missing.doc
        )),
        None => Ok(()),
    }
}
