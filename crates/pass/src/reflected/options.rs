//! Variants of a shader of a user's: its options as settings, and stand-ins for the modules of interfaces.

use super::{UserShader, list, member_of};
use crate::{
    Define, InputPort, Interface, Library, PassTypeError, Request, Setting, Settings, Traits, UseContext,
    scene_bindings,
};
use frame_graph::codes::shader::MISSING_FILE;
use shader_library::ShaderOption;

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
        global == self.port || member_of(global, &self.port).is_some()
    }
}

/// The request with a stand-in for each interface that the shader imports.
pub(super) fn stand_in(
    cx: &UseContext<'_>,
    user: &UserShader<'_>,
) -> Result<(Request, Vec<Imported>), PassTypeError> {
    let library = cx.shaders;
    let refused = |errors| PassTypeError::new(format!("`{}` is refused\n{errors}", user.path));
    let outline = library
        .outline(&user.request)
        .map_err(|errors| not_there(library, user.path).unwrap_or_else(|| refused(errors)))?;
    let mut request = user.request.clone();
    let mut imported = Vec::new();
    for port in outline.interfaces {
        if request.modules.contains_key(&port) {
            continue;
        }
        // `camera_visibility` is of the interface Visibility, `lit_points` of Points.
        let named = |interface: &str| {
            let name = snake_case(interface);
            port == name || port.strip_suffix(&name).is_some_and(|rest| rest.ends_with('_'))
        };
        let with_modules = || {
            let stand_in = |known: &Interface| Some((known.name, known.stand_in?));
            cx.interfaces.iter().filter_map(stand_in)
        };
        let Some((interface, module)) = with_modules().find(|(interface, _)| named(interface)) else {
            let message = format!(
                "`{}` imports the interface \"{port}\", and no producer has such a module",
                user.path
            );
            let names: Vec<String> = with_modules().map(|(name, _)| snake_case(name)).collect();
            let quoted = list(names.iter().map(|name| format!("\"{name}\"")));
            let suffixes = list(names.iter().map(|name| format!("`_{name}`")));
            return Err(PassTypeError::new(message)
                .help(format!("there are {quoted}, and names that end in {suffixes}")));
        };
        request.modules.insert(port.clone(), module.to_owned());
        imported.push(Imported { port, interface });
    }
    Ok((request, imported))
}

/// The error that there is no such file; `None` where there is one.
fn not_there(library: &Library, path: &str) -> Option<PassTypeError> {
    let errors = library.outline(&crate::request(path, &[])).err()?;
    // An import that is missing is told at its line; the file itself has none.
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

/// The settings that the options and `struct Settings` of all variants declare.
pub(super) fn settings(cx: &UseContext<'_>, user: &UserShader<'_>) -> Result<Vec<Setting>, PassTypeError> {
    let (library, (request, _)) = (cx.shaders, stand_in(cx, user)?);
    let refused = |errors| PassTypeError::new(format!("`{}` is refused\n{errors}", user.path));
    let shader = library.load(&request).map_err(refused)?;
    let mut all: Vec<Setting> = shader
        .outline()
        .options
        .iter()
        .filter(|option| !is_trait(option))
        .map(ShaderOption::setting)
        .collect();
    let options = all.len();
    let mut declared = shader.settings().map_err(|errors| PassTypeError::new(errors.to_string()))?;
    // What only other variants declare. Whatever else is wrong with them is told where they are used.
    let variants = if shader.outline().options.is_empty() {
        Vec::new()
    } else {
        library.variants(&request).unwrap_or_default()
    };
    for variant in variants {
        let more = library.load(&variant).and_then(|shader| shader.settings()).unwrap_or_default();
        for setting in more {
            if !declared.iter().any(|known| known.name == setting.name) {
                declared.push(setting);
            }
        }
    }
    if let Some(twice) = declared.iter().find(|setting| all.iter().any(|option| option.name == setting.name))
    {
        let message =
            format!("`{}` is an option and a member of `Settings`: one name for two settings", twice.name);
        return Err(PassTypeError::new(message));
    }
    all.append(&mut declared);
    // What is set most is told first.
    all.rotate_left(options);
    Ok(all)
}

/// The variant that settings select.
pub(super) fn select(library: &Library, mut request: Request, settings: &Settings) -> Request {
    // Options may stand within `#if`: each that is given can bring more.
    loop {
        let options = library.outline(&request).map(|outline| outline.options).unwrap_or_default();
        let before = request.defines.len();
        for option in options {
            let value = settings.0.get(&setting_name(&option)).and_then(|value| Define::try_from(value).ok());
            if let Some(value) = value.filter(|value| fits(&option, value)) {
                request.defines.insert(option.name, value);
            }
        }
        if request.defines.len() == before {
            return request;
        }
    }
}

/// The variant for a scene: options that are named as its traits have their values.
pub(super) fn select_for_scene(library: &Library, mut request: Request, traits: &Traits) -> Request {
    for option in library.outline(&request).map(|outline| outline.options).unwrap_or_default() {
        let value = traits.0.get(&setting_name(&option)).and_then(|value| Define::try_from(value).ok());
        if let Some(value) = value.filter(|value| fits(&option, value)) {
            request.defines.insert(option.name, value);
        }
    }
    request
}

fn fits(option: &ShaderOption, value: &Define) -> bool {
    std::mem::discriminant(value) == std::mem::discriminant(&option.default)
}

/// Options are named in capitals, settings and traits are not.
fn setting_name(option: &ShaderOption) -> String {
    option.name.to_lowercase()
}

fn is_trait(option: &ShaderOption) -> bool {
    scene_bindings::TRAITS.contains(&&*setting_name(option))
}
