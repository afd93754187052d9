//! Probes: WGSL files that call functions of the library with inputs of one magnitude.

use crate::float::Float;
use crate::interpret::{Fault, Interpreter};
use crate::value::{Scalar, Value};
use data_file::Diagnostics;
use naga::{AddressSpace, Function, Module, Type, TypeInner};
use shader_library::{Define, Library, Request, Shader, naga};
use std::sync::Arc;

/// The folder of probes.
pub const FOLDER: &str = "shaders/precision/";

/// The function that makes inputs.
pub(crate) const GIVEN: &str = "given";
/// The function that is measured.
pub(crate) const PROBE: &str = "probe";

/// How two results are compared.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Compared {
    /// The greatest error of the four components, each relative to itself.
    Components,
    /// The length of the difference, relative to the length of the result.
    Vector,
}

/// The default of [`Probe::bound`].
pub(crate) const BOUND: f64 = 4.0;

/// A file that says how a piece of the library is called, and how exact it has to be. The README describes such files.
#[derive(Clone, Debug)]
pub struct Probe {
    /// The stem of the file's name.
    pub name: String,
    /// The comment at the top of the file.
    pub about: String,
    /// The least and the greatest magnitude.
    pub range: (f64, f64),
    /// The meaning of the magnitude, with its unit.
    pub magnitude: String,
    /// How results are compared.
    pub compared: Compared,
    /// The greatest error that is allowed, as a multiple of the unavoidable one.
    pub bound: f64,
    /// The most samples of a magnitude: few where a call takes long.
    pub most_samples: usize,
    pub(crate) shader: Arc<Shader>,
    /// Members of `Given` that are values of uniforms: index and name.
    uniforms: Vec<(usize, String)>,
}

/// The error of a probe that cannot be used.
#[derive(Debug, thiserror::Error)]
pub enum ProbeError {
    /// The file or what it imports is no valid shader.
    #[error(transparent)]
    Shader(#[from] Diagnostics),
    /// The shader is no probe.
    #[error("{place}: {message}")]
    NoProbe {
        /// The file, and the line where there is one.
        place: String,
        /// The error.
        message: String,
    },
}

/// Returns the paths of the probes of a library, in order of their names.
pub fn paths(library: &Library) -> Vec<String> {
    let mut paths = library.files().list();
    paths.retain(|path| is_probe(path));
    paths.sort();
    paths
}

/// Whether it lies in the folder itself: what lies deeper is what probes import.
fn is_probe(path: &str) -> bool {
    path.strip_prefix(FOLDER).is_some_and(|file| file.ends_with(".wgsl") && !file.contains('/'))
}

impl Probe {
    /// Loads the probe at `path`.
    ///
    /// # Errors
    /// Fails if the shader is invalid, lacks one of the two functions, or has a malformed declaration.
    pub fn load(library: &Library, path: &str) -> Result<Probe, ProbeError> {
        let text = library.files().read(path).map_or_else(String::new, |source| source.text.clone());
        let declared = Declared::read(&text).map_err(|(line, message)| {
            let place = if line == 0 { path.to_owned() } else { format!("{path}:{line}") };
            ProbeError::NoProbe { place, message }
        });
        let mut request = Request::new(path);
        for (name, value) in declared.iter().flat_map(|declared| &declared.options) {
            request = request.define(name.clone(), value.clone());
        }
        // Errors of the WGSL come first: the file may be missing.
        let shader = library.load(&request)?;
        let declared = declared?;
        let refuse = |message: String| ProbeError::NoProbe { place: path.to_owned(), message };
        let uniforms = uniforms(&shader.module).map_err(refuse)?;
        let name = path.rsplit('/').next().unwrap_or(path).trim_end_matches(".wgsl").to_owned();
        Ok(Probe {
            name,
            about: about(&text),
            range: declared.range,
            magnitude: declared.magnitude,
            compared: declared.compared,
            bound: declared.bound,
            most_samples: declared.most_samples,
            shader,
            uniforms,
        })
    }

    /// Returns the inputs for a magnitude and four random numbers in [0, 1), computed in `f64` and rounded to `f32`.
    ///
    /// # Errors
    /// Fails if the function `given` cannot be interpreted.
    pub fn given(&self, magnitude: f64, random: [f64; 4]) -> Result<Value<f32>, Fault> {
        let mut interpreter = Interpreter::<f64>::new(&self.shader, &[])?;
        let given = interpreter.call(GIVEN, vec![Value::float(magnitude), Value::floats(random)])?;
        Ok(given.map_floats(&mut |x| x as f32))
    }

    /// Returns the results of the probe in this type of floats.
    ///
    /// # Errors
    /// Fails if the function `probe` cannot be interpreted.
    pub fn interpret<F: Float>(&self, given: &Value<F>) -> Result<[f64; 4], Fault> {
        let named = self.uniforms.iter();
        let uniforms: Vec<(&str, Value<F>)> =
            named.filter_map(|(index, name)| Some((name.as_str(), given.part(*index)?))).collect();
        let result = Interpreter::new(&self.shader, &uniforms)?.call(PROBE, vec![given.clone()])?;
        let mut components = [0.0; 4];
        let mut index = 0;
        result.each_scalar(&mut |scalar| {
            if let (Scalar::Float(x), Some(component)) = (scalar, components.get_mut(index)) {
                *component = x.f64();
                index += 1;
            }
        });
        Ok(components)
    }

    /// The names of the uniforms that `Given` has values for.
    pub(crate) fn uniforms(&self) -> impl Iterator<Item = &str> {
        self.uniforms.iter().map(|(_, name)| name.as_str())
    }
}

/// The declarations in the doc comment of `fn probe`.
struct Declared {
    range: (f64, f64),
    magnitude: String,
    compared: Compared,
    bound: f64,
    most_samples: usize,
    options: Vec<(String, Define)>,
}

impl Declared {
    /// Reads `[magnitude: 1e-6 to 1, what it is]` and so on, each on a line of its own. An error has its line, from 1; 0
    /// is the whole file.
    fn read(text: &str) -> Result<Declared, (usize, String)> {
        let lines: Vec<&str> = text.lines().map(str::trim_start).collect();
        let function = lines.iter().position(|line| line.starts_with("fn probe("));
        let Some(function) = function else {
            return Err((0, "there is no `fn probe(given: Given)`".to_owned()));
        };
        let mut found = Declared {
            range: (0.0, 0.0),
            magnitude: String::new(),
            compared: Compared::Components,
            bound: BOUND,
            most_samples: usize::MAX,
            options: Vec::new(),
        };
        for (i, line) in lines[..function].iter().enumerate().rev() {
            let Some(doc) = line.strip_prefix("///").map(str::trim) else { break };
            let Some((key, value)) =
                doc.strip_prefix('[').and_then(|doc| doc.strip_suffix(']')?.split_once(':'))
            else {
                continue;
            };
            found.set(key.trim(), value.trim()).map_err(|message| (i + 1, message))?;
        }
        if found.magnitude.is_empty() {
            let message = "the comment of `fn probe` has no `[magnitude: 1e-6 to 1, what it is]`".to_owned();
            return Err((function + 1, message));
        }
        Ok(found)
    }

    fn set(&mut self, key: &str, value: &str) -> Result<(), String> {
        match key {
            "magnitude" => {
                let parts = value.split_once(',').and_then(|(range, what)| {
                    let (low, high) = range.split_once(" to ")?;
                    let (low, high): (f64, f64) = (low.trim().parse().ok()?, high.trim().parse().ok()?);
                    (0.0 < low && low < high && high.is_finite()).then_some(((low, high), what.trim()))
                });
                let (range, what) = parts.ok_or("expected `LEAST to GREATEST, what it is`, both above 0")?;
                (self.range, self.magnitude) = (range, what.to_owned());
            }
            "compared" => {
                self.compared = match value {
                    "components" => Compared::Components,
                    "vector" => Compared::Vector,
                    _ => return Err(format!("`{value}` is neither `components` nor `vector`")),
                }
            }
            "bound" => {
                let bound = value.parse().ok().filter(|bound: &f64| bound.is_finite() && *bound >= 1.0);
                self.bound =
                    bound.ok_or("expected a number of at least 1, of times the unavoidable error")?;
            }
            "samples" => {
                let samples = value.parse().ok().filter(|samples| *samples >= 1);
                self.most_samples = samples.ok_or("expected a whole number of at least 1")?;
            }
            "option" => {
                let (name, value) =
                    value.split_once(' ').ok_or("expected the name of an option and its value")?;
                let value = match (value.trim().parse::<bool>(), value.trim().parse::<u32>()) {
                    (Ok(on), _) => Define::from(on),
                    (_, Ok(number)) => Define::from(number),
                    _ => Define::from(value.trim()),
                };
                self.options.push((name.to_owned(), value));
            }
            _ => return Err(format!("`{key}` is none of magnitude, compared, bound, samples, option")),
        }
        Ok(())
    }
}

/// The comment at the top of a file, in one line.
fn about(text: &str) -> String {
    let lines = text.lines().map_while(|line| line.strip_prefix("//"));
    lines.map(str::trim).collect::<Vec<_>>().join(" ")
}

/// The members of `Given` that have the name and type of a uniform. An error where the functions are not those of a probe.
fn uniforms(module: &Module) -> Result<Vec<(usize, String)>, String> {
    let structure =
        |ty: &Type| matches!(ty.inner, TypeInner::Struct { .. }) && ty.name.as_deref() == Some("Given");
    let (given, ty) =
        module.types.iter().find(|(_, ty)| structure(ty)).ok_or("there is no `struct Given`")?;
    let function = |name: &str| {
        let mut functions = module.functions.iter().map(|(_, function)| function);
        functions.find(|function| function.name.as_deref() == Some(name))
    };
    let shape = |function: &Function| {
        let of = |ty| match &module.types[ty].inner {
            TypeInner::Scalar(naga::Scalar::F32) => "f32".to_owned(),
            TypeInner::Vector { size: naga::VectorSize::Quad, scalar: naga::Scalar::F32 } => {
                "vec4<f32>".to_owned()
            }
            _ if ty == given => "Given".to_owned(),
            _ => "another type".to_owned(),
        };
        let arguments: Vec<String> = function.arguments.iter().map(|argument| of(argument.ty)).collect();
        format!(
            "({}) -> {}",
            arguments.join(", "),
            function.result.as_ref().map_or_else(String::new, |r| of(r.ty))
        )
    };
    for (name, wanted) in [(GIVEN, "(f32, vec4<f32>) -> Given"), (PROBE, "(Given) -> vec4<f32>")] {
        let found = function(name).ok_or_else(|| format!("there is no `fn {name}`"))?;
        let found = shape(found);
        if found != wanted {
            return Err(format!("`fn {name}` is {found}, expected {wanted}"));
        }
    }
    let TypeInner::Struct { members, .. } = &ty.inner else { return Ok(Vec::new()) };
    let uniform = |name: &str| {
        module
            .global_variables
            .iter()
            .any(|(_, global)| global.space == AddressSpace::Uniform && global.name.as_deref() == Some(name))
    };
    let named = members.iter().enumerate().filter_map(|(i, member)| Some((i, member.name.clone()?)));
    Ok(named.filter(|(_, name)| uniform(name)).collect())
}
