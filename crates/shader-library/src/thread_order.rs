//! Compute entry points whose workgroups and threads run in another order.
//!
//! A shader that is correct gives the same result in whatever order the device runs its threads. An entry point is
//! rewritten so that each thread does the work of another one: its parameters are taken over by `let`s of the same names
//! at the start of its body, computed from the thread's own built-ins. They are computed in place, not in a function that
//! is called: what follows from the workgroup's number alone stays uniform, as a barrier behind a branch on it needs.

use crate::scan::find_function;
use naga::common::wgsl::{TryToWgsl, TypeContext};
use naga::{Binding, BuiltIn, EntryPoint, Module, ShaderStage, Type, TypeInner};
use std::collections::BTreeMap;

/// Multipliers of positions: primes below 2^16, so that no product with a number of workgroups, at most 65,535,
/// overflows. The second leaves powers of two up to 4,096 reversed and no more; the others scatter.
const MULTIPLIERS: [u32; 4] = [65_521, 12_289, 49_157, 24_593];

/// Names of the values that every rewritten entry point computes.
const OWN_GROUP: &str = "own_workgroup_id";
const OWN_THREAD: &str = "own_local_invocation_index";
const GROUPS: &str = "given_num_workgroups";
const GROUP: &str = "taken_workgroup_id";
const THREAD: &str = "taken_local_invocation_index";
const LOCAL: &str = "taken_local_invocation_id";

/// Returns `text`, from which `module` was parsed, with every compute entry point's workgroups and threads in another
/// order, which `seed` chooses. Threads of one workgroup stay together. The threads of an entry point whose workgroup
/// size is an `override` keep their order inside the workgroup.
pub(crate) fn permuted(text: &str, module: &Module, seed: u32) -> String {
    let entries = module.entry_points.iter().filter(|entry| entry.stage == ShaderStage::Compute);
    // Where to cut, and what stands there instead.
    let mut changes = BTreeMap::new();
    for entry in entries {
        let Some(found) = find_function(text, &entry.name) else { continue };
        let rewritten = Rewritten::new(module, entry, seed);
        changes.insert(found.parameters.start, (found.parameters.end, rewritten.parameters));
        changes.insert(found.body, (found.body, rewritten.statements));
    }
    let mut permuted = String::with_capacity(text.len() + 1024 * changes.len());
    let mut copied = 0;
    for (start, (end, replacement)) in changes {
        permuted.push_str(&text[copied..start]);
        permuted.push_str(&replacement);
        copied = end;
    }
    permuted.push_str(&text[copied..]);
    permuted
}

/// An entry point's new parameters, and the statements with which its body begins.
struct Rewritten {
    parameters: String,
    statements: String,
}

impl Rewritten {
    fn new(module: &Module, entry: &EntryPoint, seed: u32) -> Rewritten {
        let multiplier = MULTIPLIERS[seed as usize % MULTIPLIERS.len()];
        let [x, y, z] = entry.workgroup_size;
        let threads = x * y * z;
        let taken_thread = if entry.workgroup_size_overrides.is_some() {
            OWN_THREAD.to_owned()
        } else {
            let multiplier = if threads.is_multiple_of(multiplier) { 1 } else { multiplier };
            format!("{}u - {OWN_THREAD} * {multiplier}u % {threads}u", threads - 1)
        };
        let mut rewritten = Rewritten {
            parameters: format!(
                "@builtin(workgroup_id) {OWN_GROUP}: vec3<u32>, @builtin(num_workgroups) {GROUPS}: vec3<u32>, \
                 @builtin(local_invocation_index) {OWN_THREAD}: u32"
            ),
            statements: format!(
                "let {GROUP} = {GROUPS} - 1u - {OWN_GROUP} * select(vec3<u32>({multiplier}u), vec3<u32>(1u), \
                 {GROUPS} % {multiplier}u == vec3<u32>(0u)) % {GROUPS}; \
                 let {THREAD} = {taken_thread}; \
                 let {LOCAL} = vec3<u32>({THREAD} % {x}u, {THREAD} / {x}u % {y}u, {THREAD} / {}u); ",
                x * y
            ),
        };
        for argument in &entry.function.arguments {
            let Some(name) = &argument.name else { continue };
            let ty = &module.types[argument.ty];
            let value = match (&argument.binding, &ty.inner) {
                (Some(Binding::BuiltIn(built_in)), _) => {
                    rewritten.built_in(module, entry, *built_in, argument.ty)
                }
                (_, TypeInner::Struct { members, .. }) => {
                    let members: Vec<String> = members
                        .iter()
                        .filter_map(|member| match member.binding {
                            Some(Binding::BuiltIn(built_in)) => {
                                Some(rewritten.built_in(module, entry, built_in, member.ty))
                            }
                            _ => None,
                        })
                        .collect();
                    format!("{}({})", ty.name.as_deref().unwrap_or_default(), members.join(", "))
                }
                _ => continue,
            };
            rewritten.statements.push_str(&format!("let {name} = {value}; "));
        }
        rewritten
    }

    /// The value of a built-in for the thread whose work is taken over. What is the hardware's own, as a thread's
    /// place in its subgroup, becomes a parameter and stays.
    fn built_in(
        &mut self,
        module: &Module,
        entry: &EntryPoint,
        built_in: BuiltIn,
        ty: naga::Handle<Type>,
    ) -> String {
        let [x, y, z] = entry.workgroup_size;
        match built_in {
            BuiltIn::WorkGroupId => GROUP.to_owned(),
            BuiltIn::NumWorkGroups => GROUPS.to_owned(),
            BuiltIn::LocalInvocationIndex => THREAD.to_owned(),
            BuiltIn::LocalInvocationId => LOCAL.to_owned(),
            BuiltIn::GlobalInvocationId => format!("({GROUP} * vec3<u32>({x}u, {y}u, {z}u) + {LOCAL})"),
            other => {
                let word = other.to_wgsl_for_diagnostics();
                let name = format!("own_{word}");
                let ty = module.to_ctx().type_to_string(ty);
                self.parameters.push_str(&format!(", @builtin({word}) {name}: {ty}"));
                name
            }
        }
    }
}
