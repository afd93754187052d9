//! Shaders that read their uniforms from storage buffers, for drivers that compile a shader again for values of uniforms.

use crate::gpu::Gpu;
use shader_library::{GlobalKind, Shader};
use wgpu::naga::{
    AddressSpace, Expression, Function, GlobalVariable, Handle, Module, Span, Statement, StorageAccess,
};

/// Returns whether a shader reads its uniforms from storage buffers: where its driver is such a one, and it may bind as many.
pub(crate) fn uniforms_are_stored(gpu: &Gpu, shader: &Shader) -> bool {
    let is_buffer =
        |kind: &GlobalKind| matches!(kind, GlobalKind::Uniform { .. } | GlobalKind::Storage { .. });
    let buffers = shader.interface.globals.iter().filter(|global| is_buffer(&global.kind)).count();
    gpu.recompiles_by_uniforms() && buffers <= gpu.limits().max_storage_buffers_per_shader_stage as usize
}

/// Makes storage buffers of the uniforms of a shader. What a uniform may hold has the same layout in storage. Each entry
/// point begins with a copy into a private variable, since a read of storage in each round of a loop takes longer.
pub(crate) fn store_uniforms(shader: &Shader) -> Module {
    let mut module = shader.module.clone();
    let uniforms: Vec<Handle<GlobalVariable>> = module
        .global_variables
        .iter()
        .filter(|(_, global)| global.space == AddressSpace::Uniform)
        .map(|(handle, _)| handle)
        .collect();
    for uniform in uniforms {
        let copy = module.global_variables.get_mut(uniform);
        let mut stored = copy.clone();
        copy.space = AddressSpace::Private;
        copy.binding = None;
        stored.space = AddressSpace::Storage { access: StorageAccess::LOAD };
        stored.name = None;
        let binding = stored.binding;
        let stored = module.global_variables.append(stored, Span::UNDEFINED);
        let global = shader.interface.globals.iter().position(|global| {
            binding.is_some_and(|binding| (binding.group, binding.binding) == (0, global.binding))
        });
        for entry in &mut module.entry_points {
            let known = shader.interface.entries.iter().find(|known| known.name == entry.name);
            if known.zip(global).is_some_and(|(known, global)| known.globals.contains(&global)) {
                begin_with_copy(&mut entry.function, stored, uniform);
            }
        }
    }
    module
}

/// Lets a function begin with `to = from`.
fn begin_with_copy(function: &mut Function, from: Handle<GlobalVariable>, to: Handle<GlobalVariable>) {
    let mut add = |expression| function.expressions.append(expression, Span::UNDEFINED);
    let target = add(Expression::GlobalVariable(to));
    let source = add(Expression::GlobalVariable(from));
    let before = function.expressions.len();
    let value = function.expressions.append(Expression::Load { pointer: source }, Span::UNDEFINED);
    let loaded = function.expressions.range_from(before);
    let copy = [Statement::Emit(loaded), Statement::Store { pointer: target, value }];
    let mut body = wgpu::naga::Block::from_vec(copy.into());
    body.append(&mut function.body);
    function.body = body;
}
