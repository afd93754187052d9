//! Reads a [`ShaderInterface`] from a validated module.

use crate::interface::{
    Access, Dimension, Entry, Global, GlobalKind, Location, Sample, ShaderInterface, Stage, TypeLayout,
};
use crate::layout::{MemberLayout, StructLayout};
use data_file::Value;
use naga::common::wgsl::{ToWgsl, TypeContext};
use naga::proc::Layouter;
use naga::{
    AddressSpace, ArraySize, Binding, Expression, Handle, ImageClass, ImageDimension, Literal, Module,
    ScalarKind, ShaderStage, StorageAccess, Type, TypeInner, UnaryOperator,
};

/// Resource variables in the order of their names, which is the order of bindings.
pub(crate) fn resources(module: &Module) -> Vec<Handle<naga::GlobalVariable>> {
    let mut handles: Vec<_> = module
        .global_variables
        .iter()
        .filter(|(_, variable)| {
            matches!(
                variable.space,
                AddressSpace::Uniform | AddressSpace::Storage { .. } | AddressSpace::Handle
            )
        })
        .map(|(handle, _)| handle)
        .collect();
    handles.sort_by(|a, b| module.global_variables[*a].name.cmp(&module.global_variables[*b].name));
    handles
}

/// Reads the interface of a valid module. The error says what no pass can bind.
pub(crate) fn reflect(
    module: &Module,
    info: &naga::valid::ModuleInfo,
) -> Result<ShaderInterface, (naga::Span, String)> {
    let mut layouter = Layouter::default();
    // A valid module has been laid out before; an error here would be naga's own.
    layouter.update(module.to_ctx()).map_err(|error| (module.types.get_span(error.ty), error.to_string()))?;
    let reflector = Reflector { module, layouter };
    let handles = resources(module);
    let sampled = |handle| {
        (0..module.entry_points.len())
            .any(|i| info.get_entry_point(i).sampling_set.iter().any(|key| key.image == handle))
    };
    let mut globals = Vec::with_capacity(handles.len());
    for (binding, &handle) in handles.iter().enumerate() {
        let variable = &module.global_variables[handle];
        let kind = reflector
            .kind(variable, sampled(handle))
            .map_err(|message| (module.global_variables.get_span(handle), message))?;
        globals.push(Global {
            name: variable.name.clone().unwrap_or_default(),
            binding: binding as u32,
            kind,
        });
    }
    let mut entries = Vec::with_capacity(module.entry_points.len());
    for (i, entry) in module.entry_points.iter().enumerate() {
        let stage = match entry.stage {
            ShaderStage::Compute => Stage::Compute,
            ShaderStage::Vertex => Stage::Vertex,
            ShaderStage::Fragment => Stage::Fragment,
            other => {
                return Err((
                    naga::Span::UNDEFINED,
                    format!("`{}` is of the stage {other:?}, which no pass runs", entry.name),
                ));
            }
        };
        let uses = info.get_entry_point(i);
        let used = |handle: &Handle<naga::GlobalVariable>| !uses[*handle].is_empty();
        let globals =
            handles.iter().enumerate().filter(|(_, handle)| used(handle)).map(|(index, _)| index).collect();
        entries.push(reflector.entry(entry, stage, globals));
    }
    let structs: Vec<StructLayout> =
        module.types.iter().filter_map(|(handle, ty)| reflector.struct_layout(handle, ty)).collect();
    let contents = module
        .types
        .iter()
        .filter(|(_, ty)| matches!(ty.inner, TypeInner::Struct { .. }))
        .map(|(handle, _)| reflector.type_layout(handle))
        .collect();
    let constants = module
        .constants
        .iter()
        .filter_map(|(_, constant)| Some((constant.name.clone()?, reflector.evaluate(constant.init)?)));
    let constants = constants.collect();
    let settings = structs.iter().find(|layout| layout.name == crate::settings::STRUCT).cloned();
    Ok(ShaderInterface { globals, entries, settings, structs, contents, constants })
}

struct Reflector<'a> {
    module: &'a Module,
    layouter: Layouter,
}

impl Reflector<'_> {
    fn type_name(&self, ty: Handle<Type>) -> String {
        self.module.to_ctx().type_to_string(ty)
    }

    fn kind(&self, variable: &naga::GlobalVariable, sampled: bool) -> Result<GlobalKind, String> {
        let ty = &self.module.types[variable.ty];
        Ok(match (variable.space, &ty.inner) {
            (AddressSpace::Uniform, _) => GlobalKind::Uniform { layout: self.type_layout(variable.ty) },
            (AddressSpace::Storage { access }, _) => GlobalKind::Storage {
                writable: access.contains(StorageAccess::STORE),
                layout: self.type_layout(variable.ty),
            },
            (_, TypeInner::Sampler { comparison }) => GlobalKind::Sampler { comparison: *comparison },
            (_, TypeInner::AccelerationStructure { .. }) => GlobalKind::AccelerationStructure,
            (_, TypeInner::Image { dim, arrayed, class }) => {
                let dimension = match (dim, arrayed) {
                    (ImageDimension::D1, _) => Dimension::D1,
                    (ImageDimension::D2, false) => Dimension::D2,
                    (ImageDimension::D2, true) => Dimension::D2Array,
                    (ImageDimension::D3, _) => Dimension::D3,
                    (ImageDimension::Cube, false) => Dimension::Cube,
                    (ImageDimension::Cube, true) => Dimension::CubeArray,
                };
                match *class {
                    ImageClass::Sampled { kind, multi } => {
                        let sample = match kind {
                            ScalarKind::Uint => Sample::Uint,
                            ScalarKind::Sint => Sample::Sint,
                            _ => Sample::Float { sampled },
                        };
                        GlobalKind::Texture { dimension, sample, multisampled: multi }
                    }
                    ImageClass::Depth { multi } => {
                        GlobalKind::Texture { dimension, sample: Sample::Depth, multisampled: multi }
                    }
                    ImageClass::Storage { format, access } => {
                        let reads = access.contains(StorageAccess::LOAD);
                        let writes = access.contains(StorageAccess::STORE);
                        let access = match (reads, writes) {
                            _ if access.contains(StorageAccess::ATOMIC) => Access::Atomic,
                            (true, true) => Access::ReadWrite,
                            (true, false) => Access::Read,
                            _ => Access::Write,
                        };
                        GlobalKind::StorageTexture { dimension, format: format.to_wgsl(), access }
                    }
                    ImageClass::External => return Err("external textures cannot be bound".to_owned()),
                }
            }
            _ => return Err(format!("a resource of type `{}` cannot be bound", self.type_name(variable.ty))),
        })
    }

    fn type_layout(&self, ty: Handle<Type>) -> TypeLayout {
        let name = self.type_name(ty);
        let element = |base: Handle<Type>, stride: u32| Some((self.type_name(base), stride));
        let size = self.layouter[ty].size;
        match &self.module.types[ty].inner {
            TypeInner::Array { base, size: ArraySize::Dynamic, stride } => {
                TypeLayout { ty: name, size: 0, element: element(*base, *stride), runtime_sized: true }
            }
            TypeInner::Array { base, stride, .. } => {
                TypeLayout { ty: name, size, element: element(*base, *stride), runtime_sized: false }
            }
            TypeInner::Struct { members, .. } => {
                let last = members.last();
                let tail = last.and_then(|member| match self.module.types[member.ty].inner {
                    TypeInner::Array { base, size: ArraySize::Dynamic, stride } => {
                        Some((member.offset, base, stride))
                    }
                    _ => None,
                });
                match tail {
                    Some((offset, base, stride)) => TypeLayout {
                        ty: name,
                        size: offset,
                        element: element(base, stride),
                        runtime_sized: true,
                    },
                    None => TypeLayout { ty: name, size, element: None, runtime_sized: false },
                }
            }
            _ => TypeLayout { ty: name, size, element: None, runtime_sized: false },
        }
    }

    fn struct_layout(&self, handle: Handle<Type>, ty: &Type) -> Option<StructLayout> {
        let TypeInner::Struct { members, span } = &ty.inner else { return None };
        let tail = self.type_layout(handle);
        let size = if tail.runtime_sized { tail.size } else { *span };
        let members = members
            .iter()
            .map(|member| {
                let inner = &self.module.types[member.ty].inner;
                let unsized_ = matches!(inner, TypeInner::Array { size: ArraySize::Dynamic, .. });
                MemberLayout {
                    name: member.name.clone().unwrap_or_default(),
                    ty: self.type_name(member.ty),
                    offset: member.offset,
                    size: if unsized_ { 0 } else { self.layouter[member.ty].size },
                }
            })
            .collect();
        Some(StructLayout { name: ty.name.clone()?, members, size })
    }

    fn entry(&self, entry: &naga::EntryPoint, stage: Stage, globals: Vec<usize>) -> Entry {
        let mut workgroup_size = if stage == Stage::Compute { entry.workgroup_size } else { [0; 3] };
        for (size, expression) in
            workgroup_size.iter_mut().zip(entry.workgroup_size_overrides.unwrap_or_default())
        {
            if let Some(expression) = expression {
                *size = self.evaluate(expression).and_then(|value| value.as_u32()).unwrap_or(0);
            }
        }
        let mut inputs = Vec::new();
        for argument in &entry.function.arguments {
            self.locations(argument.name.as_deref(), argument.ty, argument.binding.as_ref(), &mut inputs);
        }
        let mut outputs = Vec::new();
        if let Some(result) = &entry.function.result {
            self.locations(None, result.ty, result.binding.as_ref(), &mut outputs);
        }
        Entry { name: entry.name.clone(), stage, workgroup_size, globals, inputs, outputs }
    }

    fn locations(
        &self,
        name: Option<&str>,
        ty: Handle<Type>,
        binding: Option<&Binding>,
        found: &mut Vec<Location>,
    ) {
        match (binding, &self.module.types[ty].inner) {
            (Some(Binding::Location { location, .. }), _) => {
                let name = name.unwrap_or_default().to_owned();
                found.push(Location { location: *location, name, ty: self.type_name(ty) });
            }
            (None, TypeInner::Struct { members, .. }) => {
                for member in members {
                    // Only what is bound: structs do not nest in what a stage takes or gives.
                    if member.binding.is_some() {
                        self.locations(member.name.as_deref(), member.ty, member.binding.as_ref(), found);
                    }
                }
            }
            _ => {}
        }
    }

    /// The value of an expression of literals, constants, the defaults of overrides, and arithmetic.
    fn evaluate(&self, expression: Handle<Expression>) -> Option<Value> {
        match self.module.global_expressions[expression] {
            Expression::Literal(Literal::Bool(b)) => Some(Value::Bool(b)),
            Expression::Literal(Literal::U32(n)) => Some(Value::U32(n)),
            Expression::Literal(Literal::I32(n)) => Some(Value::I32(n)),
            Expression::Literal(Literal::F32(x)) => Some(Value::F32(x)),
            Expression::Constant(constant) => self.evaluate(self.module.constants[constant].init),
            Expression::Override(handle) => self.evaluate(self.module.overrides[handle].init?),
            Expression::Unary { op: UnaryOperator::Negate, expr } => match self.evaluate(expr)? {
                Value::I32(n) => n.checked_neg().map(Value::I32),
                Value::F32(x) => Some(Value::F32(-x)),
                _ => None,
            },
            Expression::Binary { op, left, right } => {
                arithmetic(op, self.evaluate(left)?, self.evaluate(right)?)
            }
            _ => None,
        }
    }
}

/// `a op b`; `None` where it overflows or is not arithmetic.
fn arithmetic(op: naga::BinaryOperator, a: Value, b: Value) -> Option<Value> {
    use naga::BinaryOperator as Op;
    match (a, b) {
        (Value::U32(a), Value::U32(b)) => match op {
            Op::Add => a.checked_add(b),
            Op::Subtract => a.checked_sub(b),
            Op::Multiply => a.checked_mul(b),
            Op::Divide => a.checked_div(b),
            _ => None,
        }
        .map(Value::U32),
        (Value::I32(a), Value::I32(b)) => match op {
            Op::Add => a.checked_add(b),
            Op::Subtract => a.checked_sub(b),
            Op::Multiply => a.checked_mul(b),
            Op::Divide => a.checked_div(b),
            _ => None,
        }
        .map(Value::I32),
        (Value::F32(a), Value::F32(b)) => match op {
            Op::Add => Some(a + b),
            Op::Subtract => Some(a - b),
            Op::Multiply => Some(a * b),
            Op::Divide => Some(a / b),
            _ => None,
        }
        .map(Value::F32),
        _ => None,
    }
}
