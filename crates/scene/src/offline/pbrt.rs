//! Reads scenes of pbrt-v4.
//!
//! What concerns how pbrt renders (the film but for its shape, samplers, filters, integrators, accelerators, options) is
//! skipped. Scenes of pbrt are left-handed; see the collector for how their world becomes right-handed.

mod camera;
mod lights;
mod materials;
mod parameters;
mod shapes;
mod textures;
mod tokens;
mod transforms;

use std::collections::BTreeMap;
use std::rc::Rc;
use std::sync::Arc;

use data_file::{Diagnostic, Source, Span};
use glam::DMat4;

use super::collector::Collector;
use super::paint::Paint;
use super::report::{MAX_DEPTH, error, located, shortened, unknown};
use super::surface::Surface;
use crate::codes;
use crate::error::SceneError;
use lights::AreaLight;
use parameters::{Parameters, Space, Textures};
use tokens::{Token, Tokens};

/// The directives of pbrt-v4.
const DIRECTIVES: [&str; 41] = [
    "Accelerator",
    "ActiveTransform",
    "AreaLightSource",
    "Attribute",
    "AttributeBegin",
    "AttributeEnd",
    "Camera",
    "ColorSpace",
    "ConcatTransform",
    "CoordSysTransform",
    "CoordinateSystem",
    "Film",
    "Identity",
    "Import",
    "Include",
    "Integrator",
    "LightSource",
    "LookAt",
    "MakeNamedMaterial",
    "MakeNamedMedium",
    "Material",
    "MediumInterface",
    "NamedMaterial",
    "ObjectBegin",
    "ObjectEnd",
    "ObjectInstance",
    "Option",
    "PixelFilter",
    "ReverseOrientation",
    "Rotate",
    "Sampler",
    "Scale",
    "Shape",
    "Texture",
    "Transform",
    "TransformBegin",
    "TransformEnd",
    "TransformTimes",
    "Translate",
    "WorldBegin",
    "WorldEnd",
];

/// The most blocks within each other.
const MAX_BLOCKS: usize = 10_000;

/// What blocks restore.
#[derive(Clone)]
struct State {
    /// To the world from the space of what follows; of the camera, from the world.
    transform: DMat4,
    /// Whether transforms change the start of the exposure.
    at_start: bool,
    reversed: bool,
    /// The surface of what follows; `None` if it is left out.
    surface: Option<Rc<Surface>>,
    area_light: Option<Rc<AreaLight>>,
    space: Space,
}

/// A block that is open.
#[derive(PartialEq)]
enum Block {
    Attributes,
    Transform,
    Object,
}

/// The shapes of an object: meshes, and their transforms.
type Object = Vec<(usize, DMat4)>;

/// A scene that is being read.
pub(super) struct Scene<'a> {
    collector: Collector<'a>,
    state: State,
    blocks: Vec<(Block, State, Span)>,
    materials: BTreeMap<String, Option<Rc<Surface>>>,
    textures: Textures,
    systems: BTreeMap<String, DMat4>,
    objects: BTreeMap<String, Object>,
    /// The object whose shapes are read.
    object: Option<(String, Object)>,
    /// The camera, which depends on the film.
    camera: Option<(Parameters, String, DMat4)>,
    /// Width and height of the film.
    film: [f64; 2],
}

/// Reads a scene into a collector.
pub(super) fn read<'a>(source: Arc<Source>, collector: Collector<'a>) -> Result<Collector<'a>, SceneError> {
    let surface = Rc::new(Surface::diffuse("default", Paint::number(0.5)));
    let state = State {
        transform: DMat4::IDENTITY,
        at_start: true,
        reversed: false,
        surface: Some(surface),
        area_light: None,
        space: Space::Srgb,
    };
    let mut scene = Scene {
        collector,
        state,
        blocks: Vec::new(),
        materials: BTreeMap::new(),
        textures: Textures::default(),
        systems: BTreeMap::new(),
        objects: BTreeMap::new(),
        object: None,
        camera: None,
        film: [1280.0, 720.0],
    };
    scene.file(source, 0)?;
    if let Some((_, _, span)) = scene.blocks.last() {
        return Err(error(&codes::FORMAT, span, "the file ends in a block", "the block begins here"));
    }
    scene.finish_camera()?;
    Ok(scene.collector)
}

impl Scene<'_> {
    fn file(&mut self, source: Arc<Source>, depth: usize) -> Result<(), SceneError> {
        let mut tokens = Tokens::new(source);
        while let Some((token, span)) = tokens.take()? {
            match token {
                Token::Word(directive) => self.directive(&directive, &span, &mut tokens, depth)?,
                _ => return Err(error(&codes::FORMAT, &span, "expected a directive", "no directive")),
            }
        }
        Ok(())
    }

    fn directive(
        &mut self,
        directive: &str,
        span: &Span,
        tokens: &mut Tokens,
        depth: usize,
    ) -> Result<(), SceneError> {
        match directive {
            "Accelerator" | "Integrator" | "PixelFilter" | "Sampler" => {
                self.named(directive, span, tokens)?;
            }
            "Film" => {
                let (_, parameters) = self.named(directive, span, tokens)?;
                let size = ["xresolution", "yresolution"].map(|name| parameters.number(name));
                for (side, given) in self.film.iter_mut().zip(size) {
                    *side = given?.unwrap_or(*side);
                }
                if self.film.iter().any(|side| *side < 1.0) {
                    return Err(error(
                        &codes::VALUE,
                        span,
                        "a film has a pixel at least each way",
                        "this film",
                    ));
                }
            }
            "Option" => drop(Parameters::read(
                tokens,
                directive.to_owned(),
                span.clone(),
                self.state.space,
                &self.collector.report,
            )?),
            "Attribute" => {
                let (of, parameters) = self.named(directive, span, tokens)?;
                parameters.note_unused(&mut self.collector.report);
                self.collector
                    .report
                    .note(span, format!("`Attribute \"{of}\"` is not supported: it is left out"));
            }
            "AttributeBegin" => self.begin(Block::Attributes, span)?,
            "AttributeEnd" => drop(self.end(&Block::Attributes, span)?),
            "TransformBegin" => self.begin(Block::Transform, span)?,
            "TransformEnd" => {
                let inner = self.state.clone();
                let outer = self.end(&Block::Transform, span)?;
                self.state = State { transform: outer.transform, ..inner };
            }
            "Camera" => {
                let (kind, parameters) = self.named(directive, span, tokens)?;
                let world = self.state.transform.inverse();
                self.systems.insert("camera".to_owned(), world);
                self.camera = Some((parameters, kind, world));
            }
            "ColorSpace" => {
                let (name, place) = quoted(tokens, span)?;
                self.state.space = match name.to_ascii_lowercase().as_str() {
                    "srgb" => Space::Srgb,
                    "dci-p3" => Space::DciP3,
                    "rec2020" => Space::Rec2020,
                    _ => {
                        let name = shortened(&name);
                        let note = format!(
                            "the color space `{name}` is not supported: its colors are taken as sRGB"
                        );
                        self.collector.report.note(&place, note);
                        Space::Srgb
                    }
                };
            }
            "Include" | "Import" => {
                let (name, place) = quoted(tokens, span)?;
                if depth + 1 >= MAX_DEPTH {
                    let message = format!("files are included more than {MAX_DEPTH} deep");
                    return Err(error(&codes::FORMAT, &place, message, "included here"));
                }
                let source = self.collector.report.text(&name, &place)?;
                self.file(source, depth + 1)?;
            }
            "AreaLightSource" => {
                let (kind, parameters) = self.named(directive, span, tokens)?;
                self.state.area_light = self.area_light(&kind, &parameters)?;
            }
            "LightSource" => {
                let (kind, parameters) = self.named(directive, span, tokens)?;
                self.light_source(&kind, &parameters)?;
            }
            "Material" => {
                let (kind, parameters) = self.named(directive, span, tokens)?;
                self.state.surface = self.material(&kind, &kind, &parameters)?;
            }
            "MakeNamedMaterial" => {
                let (name, parameters) = self.named(directive, span, tokens)?;
                let Some(kind) = parameters.text("type")? else {
                    return Err(error(
                        &codes::VALUE,
                        span,
                        "the material has no `string type`",
                        "this material",
                    ));
                };
                let surface = self.material(kind, &name, &parameters)?;
                self.materials.insert(name, surface);
            }
            "NamedMaterial" => {
                let (name, place) = quoted(tokens, span)?;
                let Some(surface) = self.materials.get(&name) else {
                    let known = self.materials.keys().map(String::as_str);
                    return Err(unknown(&place, ("material", "materials"), &name, known));
                };
                self.state.surface.clone_from(surface);
            }
            "MakeNamedMedium" | "MediumInterface" => {
                while let Some((Token::Quoted(_), _)) = tokens.peek()? {
                    let (name, _) = quoted(tokens, span)?;
                    if directive == "MakeNamedMedium" {
                        self.collector
                            .report
                            .note(span, format!("the medium `{}` is left out", shortened(&name)));
                        Parameters::read(
                            tokens,
                            name,
                            span.clone(),
                            self.state.space,
                            &self.collector.report,
                        )?;
                    }
                }
            }
            "Texture" => self.texture(span, tokens)?,
            "Shape" => {
                let (kind, parameters) = self.named(directive, span, tokens)?;
                self.shape(&kind, &parameters)?;
            }
            "ObjectBegin" => {
                let (name, place) = quoted(tokens, span)?;
                if self.object.is_some() {
                    return Err(error(
                        &codes::FORMAT,
                        &place,
                        "an object is within another one",
                        "within an object",
                    ));
                }
                self.begin(Block::Object, span)?;
                self.object = Some((name, Object::new()));
            }
            "ObjectEnd" => {
                self.end(&Block::Object, span)?;
                self.objects.extend(self.object.take());
            }
            "ObjectInstance" => {
                let (name, place) = quoted(tokens, span)?;
                self.instance(&name, &place)?;
            }
            "ReverseOrientation" => self.state.reversed = !self.state.reversed,
            "WorldBegin" => {
                self.state.transform = DMat4::IDENTITY;
                self.state.at_start = true;
                self.systems.insert("world".to_owned(), DMat4::IDENTITY);
                self.finish_camera()?;
            }
            // Of pbrt-v3, whose scenes else differ much.
            "WorldEnd" => {}
            _ => self.transform(directive, span, tokens)?,
        }
        Ok(())
    }

    /// Reads the name or type behind a directive, and the parameters.
    fn named(
        &mut self,
        directive: &str,
        span: &Span,
        tokens: &mut Tokens,
    ) -> Result<(String, Parameters), SceneError> {
        let (name, place) = quoted(tokens, span)?;
        let span = Span { end: place.end.max(span.end), ..span.clone() };
        let of = format!("{directive} \"{}\"", shortened(&name));
        let parameters = Parameters::read(tokens, of, span, self.state.space, &self.collector.report)?;
        Ok((name, parameters))
    }

    fn begin(&mut self, block: Block, span: &Span) -> Result<(), SceneError> {
        if self.blocks.len() == MAX_BLOCKS {
            let message = format!("more than {MAX_BLOCKS} blocks are within each other");
            return Err(error(&codes::FORMAT, span, message, "the innermost one"));
        }
        self.blocks.push((block, self.state.clone(), span.clone()));
        Ok(())
    }

    /// Ends a block, and returns the state at its beginning, which is restored.
    fn end(&mut self, block: &Block, span: &Span) -> Result<State, SceneError> {
        match self.blocks.pop() {
            Some((open, state, _)) if open == *block => {
                self.state = state.clone();
                Ok(state)
            }
            Some((_, _, begin)) => {
                let message = "the block that ends is not the one that began last";
                let mismatch = Diagnostic::new(&codes::FORMAT, message).label(span.clone(), "ends here");
                Err(located(mismatch.label(begin, "began last")))
            }
            None => Err(error(&codes::FORMAT, span, "no block is open that could end", "ends here")),
        }
    }

    fn instance(&mut self, name: &str, place: &Span) -> Result<(), SceneError> {
        if self.object.is_some() {
            return Err(error(
                &codes::FORMAT,
                place,
                "an object has instances of others in it",
                "within an object",
            ));
        }
        let Some(object) = self.objects.get(name) else {
            let known = self.objects.keys().map(String::as_str);
            return Err(unknown(place, ("object", "objects"), name, known));
        };
        for (mesh, transform) in object {
            self.collector.place(*mesh, &(self.state.transform * *transform), place)?;
        }
        Ok(())
    }
}

/// Takes a quoted string.
fn quoted(tokens: &mut Tokens, behind: &Span) -> Result<(String, Span), SceneError> {
    match tokens.take()? {
        Some((Token::Quoted(text), span)) => Ok((text, span)),
        Some((_, span)) => Err(error(&codes::FORMAT, &span, "expected a name in quotes", "no name")),
        None => {
            Err(error(&codes::FORMAT, behind, "expected a name in quotes, and the file ends", "behind this"))
        }
    }
}
