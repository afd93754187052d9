//! Variants of the shaders of a pass: options as settings, what decides the others, and stand-ins for the modules of
//! interfaces.

use super::{MainShader, begins, instead, list};
use crate::{
    Define, InputPort, Interface, Library, PassTypeError, Request, Setting, Settings, Traits, UseContext,
    Value, lights, request, scene_bindings,
};
use shader_library::codes::MISSING_FILE;
use shader_library::{AUTO, DeclaredPort, Outline, ShaderOption};
use std::sync::Arc;

/// The values that decide the options of a pass's shaders.
#[derive(Clone, Copy)]
pub(crate) struct Known<'a> {
    /// The settings of the use.
    pub(crate) settings: &'a Settings,
    /// The traits of the scene, once they are known.
    pub(crate) traits: Option<&'a Traits>,
    /// Whether an input is linked.
    pub(crate) linked: &'a dyn Fn(&str) -> bool,
    /// Whether an output is read.
    pub(crate) read: &'a dyn Fn(&str) -> bool,
    /// Whether an input has a member.
    pub(crate) member: &'a dyn Fn(&str, &str) -> Option<bool>,
    /// The value that the producer of a module gave one of its options: it goes before all others.
    pub(crate) of_module: &'a dyn Fn(&str) -> Option<Define>,
}

/// The meaning of an option of a pass, by its name.
enum Meaning<'a> {
    /// Whether an input is linked.
    Linked(&'a str),
    /// Whether an output is read.
    Read(&'a str),
    /// Whether an input has a member.
    Member(&'a str, &'a str),
    /// A trait of the scene.
    Trait,
    /// Only the pass sets it.
    Internal,
    Setting,
}

/// Returns what an option means in a pass that declares these ports.
fn meaning<'a>(option: &ShaderOption, name: &'a str, declared: &'a Outline) -> Meaning<'a> {
    let is_in = |ports: &[DeclaredPort]| ports.iter().any(|port| port.name == name);
    if option.internal {
        return Meaning::Internal;
    }
    if is_in(&declared.inputs) {
        return Meaning::Linked(name);
    }
    if is_in(&declared.outputs) {
        return Meaning::Read(name);
    }
    let member = |port: &'a DeclaredPort| Some((&*port.name, super::member_of(name, &port.name)?));
    if let Some((port, member)) = declared.inputs.iter().filter_map(member).max_by_key(|(port, _)| port.len())
    {
        return Meaning::Member(port, member);
    }
    if scene_bindings::TRAITS.contains(&name) { Meaning::Trait } else { Meaning::Setting }
}

impl<'a> Known<'a> {
    /// Returns what decides which ports and entry points a pass has. Those of a user's file are the same for each scene.
    pub(super) fn of(&self, main: &MainShader) -> Known<'a> {
        Known { traits: self.traits.filter(|_| main.folder.is_some()), ..*self }
    }

    /// Returns the variant that is selected of a shader of a pass that declares these ports. Options that the request gives
    /// stay.
    pub(crate) fn select(&self, library: &Library, mut request: Request, declared: &Outline) -> Request {
        // Options and imports may stand within `#if`: each option that is given can bring more.
        loop {
            let Ok(outline) = library.outline(&request) else { return request };
            let before = request.defines.len();
            for option in &outline.options {
                if !request.defines.contains_key(&option.name)
                    && let Some(value) =
                        (self.of_module)(&option.name).or_else(|| self.value(option, declared))
                {
                    request.defines.insert(option.name.clone(), value);
                }
            }
            if request.defines.len() == before {
                return request;
            }
        }
    }

    /// Returns the value of an option; `None` where nothing decides it, and for one of another type.
    pub(crate) fn value(&self, option: &ShaderOption, declared: &Outline) -> Option<Define> {
        let name = option.name.to_lowercase();
        let of = |value| Define::try_from(value).ok();
        let value = match meaning(option, &name, declared) {
            Meaning::Internal => None,
            Meaning::Linked(port) => Some(Define::Bool((self.linked)(port))),
            Meaning::Read(port) => Some(Define::Bool((self.read)(port))),
            Meaning::Member(port, member) => (self.member)(port, member).map(Define::Bool),
            Meaning::Trait => self.traits?.values.get(&name).and_then(of),
            Meaning::Setting => match (&option.auto, self.settings.0.get(&name)) {
                (Some((value, name)), Some(Value::Text(said))) if said == AUTO => {
                    let has = self.traits.and_then(|traits| traits.values.get(name)).and_then(Value::as_bool);
                    Some(if has == Some(true) { value } else { &option.default }.clone())
                }
                (_, said) => said.and_then(of),
            },
        };
        value.filter(|value| std::mem::discriminant(value) == std::mem::discriminant(&option.default))
    }

    /// Returns what the selected variant of a shader declares.
    pub(super) fn outline(
        &self,
        library: &Library,
        request: &Request,
        declared: &Outline,
    ) -> Option<Arc<Outline>> {
        library.outline(&self.select(library, request.clone(), declared)).ok()
    }
}

/// Returns what the main shader declares with its options at their defaults.
///
/// # Errors
/// A file that is not there, or cannot be composed.
pub(super) fn declared(cx: &UseContext<'_>, main: &MainShader) -> Result<Arc<Outline>, PassTypeError> {
    let outline = cx.shaders.outline(&main.request);
    outline.map_err(|errors| not_there(cx.shaders, &main.path).unwrap_or_else(|| main.refused(errors)))
}

/// Returns the shaders of a pass beside the main one: the files of its folder that have entry points, of their own or of an
/// algorithm that they import.
pub(super) fn others(
    cx: &UseContext<'_>,
    main: &MainShader,
    declared: &Outline,
) -> Result<Vec<Request>, PassTypeError> {
    let Some(folder) = &main.folder else { return Ok(Vec::new()) };
    let mut others = Vec::new();
    for file in cx.shaders.folder(folder).iter().filter(|file| file.path != main.path) {
        let (request, _) = stand_in(cx, main, &Request::new(file.path.as_str()), declared)?;
        let has_entries =
            || cx.shaders.load(&request).is_ok_and(|shader| !shader.interface.entries.is_empty());
        if file.has_entries || has_entries() {
            others.push(request);
        }
    }
    Ok(others)
}

/// An `#import interface`, which is an input.
#[derive(Clone, Debug)]
pub(super) struct Imported {
    /// The name in the import.
    pub(super) port: String,
    interface: &'static str,
}

impl Imported {
    pub(super) fn input(&self) -> InputPort {
        InputPort {
            name: self.port.clone(),
            interface: self.interface.into(),
            optional: false,
            doc: format!("Read through the module of its producer: `#import interface \"{}\"`.", self.port),
        }
    }

    /// Whether the module reads a global of this name.
    pub(super) fn fills(&self, global: &str) -> bool {
        begins(global, &self.port)
    }
}

/// The request with a stand-in for each interface that the shader imports.
pub(super) fn stand_in(
    cx: &UseContext<'_>,
    main: &MainShader,
    request: &Request,
    declared: &Outline,
) -> Result<(Request, Vec<Imported>), PassTypeError> {
    let outline = cx.shaders.outline(request).map_err(|errors| main.refused(errors))?;
    let mut request = request.clone();
    let mut imported = Vec::new();
    // Imports may stand within `#if`, which a variant may open: all inputs with a module have one.
    let of_inputs = declared.inputs.iter().map(|input| &input.name);
    for port in outline.interfaces.iter().chain(of_inputs) {
        if request.modules.contains_key(port) {
            continue;
        }
        let by_declaration = declared.inputs.iter().find(|input| input.name == *port);
        // `camera_visibility` is of the interface Visibility, `lit_points` of Points.
        let named = |interface: &str| match by_declaration {
            Some(declared) => declared.interface == interface,
            None => {
                let name = snake_case(interface);
                *port == name || port.strip_suffix(&name).is_some_and(|rest| rest.ends_with('_'))
            }
        };
        let with_modules = || {
            let stand_in = |known: &Interface| Some((known.name, known.stand_in?));
            cx.interfaces.iter().filter_map(stand_in)
        };
        if let Some((interface, module)) = with_modules().find(|(interface, _)| named(interface)) {
            request.modules.insert(port.clone(), module.to_owned());
            imported.push(Imported { port: port.clone(), interface });
            continue;
        }
        if !outline.interfaces.contains(port) {
            continue;
        }
        let message =
            format!("`{}` imports the interface \"{port}\", and no producer has such a module", main.path);
        let names: Vec<String> = with_modules().map(|(name, _)| snake_case(name)).collect();
        let quoted = list(names.iter().map(|name| format!("\"{name}\"")));
        let suffixes = list(names.iter().map(|name| format!("`_{name}`")));
        let help = format!("there are {quoted}, and names that end in {suffixes}");
        return Err(PassTypeError::new(message).help(help));
    }
    Ok((request, imported))
}

/// The error that there is no such file; `None` where there is one.
fn not_there(library: &Library, path: &str) -> Option<PassTypeError> {
    let errors = library.outline(&crate::request(path, &[])).err()?;
    // A missing import is reported at its line; the file itself has none.
    let missing =
        errors.0.into_iter().find(|error| error.code == MISSING_FILE.code && error.labels.is_empty())?;
    let looked = |note: String| match note.strip_prefix("looked in ") {
        Some(folders) => format!("looked beside the file that names it, then in {folders}"),
        None => note,
    };
    let help: Vec<String> = missing.notes.into_iter().map(looked).collect();
    Some(PassTypeError::shader(missing.message).help(help.join("; ")))
}

/// The name of an interface as a port is named: `DepthAtlas` is `depth_atlas`.
fn snake_case(interface: &str) -> String {
    let mut name = String::new();
    for letter in interface.chars() {
        if letter.is_uppercase() && !name.is_empty() {
            name.push('_');
        }
        name.extend(letter.to_lowercase());
    }
    name
}

/// The settings that the options and `struct Settings` of all variants of a user's file declare.
pub(super) fn settings_of_file(
    cx: &UseContext<'_>,
    main: &MainShader,
) -> Result<Vec<Setting>, PassTypeError> {
    let (library, declared) = (cx.shaders, declared(cx, main)?);
    let (request, _) = stand_in(cx, main, &main.request, &declared)?;
    let shader = library.load(&request).map_err(|errors| main.refused(errors))?;
    let mut options = settings_of_options(&shader.outline().options, &declared)?;
    options.extend(declared.lights.as_deref().map(lights::setting));
    let mut members = shader.settings().map_err(|errors| PassTypeError::new(errors.to_string()))?;
    // Settings that only other variants declare. Other errors in these are reported where they are used.
    let variants = if shader.outline().options.is_empty() {
        Vec::new()
    } else {
        library.variants(&request).unwrap_or_default()
    };
    for variant in variants {
        let more = library.load(&variant).and_then(|shader| shader.settings()).unwrap_or_default();
        for setting in more {
            if !members.iter().any(|known| known.name == setting.name) {
                members.push(setting);
            }
        }
    }
    check_apart(&members, &options)?;
    members.append(&mut options);
    Ok(members)
}

/// The settings that the options and `struct Settings` declare in the files of a pass's folder, and the options of the
/// modules that it provides.
pub(super) fn settings_of_folder(
    cx: &UseContext<'_>,
    main: &MainShader,
    folder: &str,
) -> Result<Vec<Setting>, PassTypeError> {
    let (library, declared) = (cx.shaders, declared(cx, main)?);
    let (mut members, mut options): (Vec<Setting>, Vec<Setting>) = Default::default();
    let files = library.folder(folder);
    let paths = files.iter().map(|file| file.path.clone()).filter(|path| *path != main.path);
    let modules = declared
        .outputs
        .iter()
        .filter_map(|output| Some(module_path(library, folder, output.module.as_ref()?)));
    for path in std::iter::once(main.path.clone()).chain(paths).chain(modules) {
        let of_file = request(&path, &[]);
        let outline = library.outline(&of_file).map_err(|errors| main.refused(errors))?;
        for setting in settings_of_options(&outline.options, &declared)? {
            if !options.iter().any(|known| known.name == setting.name) {
                options.push(setting);
            }
        }
        for setting in library.settings(&of_file).map_err(|errors| main.refused(errors))?.iter() {
            match members.iter().find(|known| known.name == setting.name) {
                None => members.push(setting.clone()),
                Some(known) if known.declared == setting.declared => {}
                Some(known) => {
                    let (name, places) = (&setting.name, (&known.declared, &setting.declared));
                    let message = format!("{}: the setting `{name}` is declared twice", places.1);
                    return Err(PassTypeError::new(message).help(format!("it is declared at {}", places.0)));
                }
            }
        }
    }
    options.extend(declared.lights.as_deref().map(lights::setting));
    check_apart(&members, &options)?;
    members.append(&mut options);
    Ok(members)
}

/// The path of a module that a directive names: beside the main file, or among the shared files.
pub(super) fn module_path(library: &Library, folder: &str, name: &str) -> String {
    let beside = format!("{folder}/{name}");
    if library.folder(folder).iter().any(|file| file.path == beside) {
        beside
    } else if name.contains('/') {
        name.to_owned()
    } else {
        format!("shaders/{name}")
    }
}

/// The settings among the options, whose `auto` may ask only for traits that scenes have.
fn settings_of_options(options: &[ShaderOption], declared: &Outline) -> Result<Vec<Setting>, PassTypeError> {
    let is_setting = |option: &&ShaderOption| {
        matches!(meaning(option, &option.name.to_lowercase(), declared), Meaning::Setting)
    };
    let setting = |option: &ShaderOption| match &option.auto {
        Some((_, name)) if !scene_bindings::TRAITS.contains(&&**name) => {
            let message = format!("{}: scenes have no trait `{name}`", option.place);
            Err(PassTypeError::new(message).help(instead(name, "there are", scene_bindings::TRAITS)))
        }
        _ => Ok(option.setting()),
    };
    options.iter().filter(is_setting).map(setting).collect()
}

fn check_apart(members: &[Setting], options: &[Setting]) -> Result<(), PassTypeError> {
    match members.iter().find(|setting| options.iter().any(|option| option.name == setting.name)) {
        Some(twice) => Err(PassTypeError::new(format!(
            "`{}` is an option and a member of `Settings`: one name for two settings",
            twice.name
        ))),
        None => Ok(()),
    }
}
