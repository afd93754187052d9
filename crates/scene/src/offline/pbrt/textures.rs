//! Textures of pbrt.

use std::rc::Rc;

use data_file::Span;
use glam::{Vec2, Vec3};

use super::parameters::{Parameters, Usage};
use super::tokens::Tokens;
use super::{Scene, quoted};
use crate::codes;
use crate::error::SceneError;
use crate::material::{Encoding, Wrap};
use crate::offline::collector::Collector;
use crate::offline::paint::{Paint, Picture, Texels, UvMap};
use crate::offline::report::{error, shortened};

/// The value of a texture that is not supported.
const GREY: f32 = 0.5;

impl Scene<'_> {
    /// Reads `Texture "name" "type" "class" …`.
    pub(super) fn texture(&mut self, span: &Span, tokens: &mut Tokens) -> Result<(), SceneError> {
        let (name, _) = quoted(tokens, span)?;
        let (kind, place) = quoted(tokens, span)?;
        let (class, _) = quoted(tokens, span)?;
        let of = format!("Texture \"{}\"", shortened(&name));
        let space = self.state.space;
        let parameters = Parameters::read(tokens, of, span.clone(), space, &self.collector.report)?;
        let is_color = match kind.as_str() {
            "spectrum" => true,
            "float" => false,
            _ => {
                return Err(error(
                    &codes::VALUE,
                    &place,
                    "the type of a texture is `spectrum` or `float`",
                    "neither",
                ));
            }
        };
        let paint = self.texture_of_class(&class, is_color, &parameters)?;
        parameters.note_unused(&mut self.collector.report);
        let list = if is_color { &mut self.textures.colors } else { &mut self.textures.numbers };
        list.insert(name, paint);
        Ok(())
    }

    /// Returns a value of a texture, which may be another texture.
    fn value(
        &mut self,
        name: &str,
        is_color: bool,
        parameters: &Parameters,
    ) -> Result<Option<Paint>, SceneError> {
        match is_color {
            true => parameters.paint(name, Usage::Reflectance, &self.textures, &mut self.collector.report),
            false => parameters.shade(name, &self.textures),
        }
    }

    fn texture_of_class(
        &mut self,
        class: &str,
        is_color: bool,
        parameters: &Parameters,
    ) -> Result<Paint, SceneError> {
        let span = &parameters.span;
        match class {
            "constant" => Ok(self.value("value", is_color, parameters)?.unwrap_or(Paint::number(1.0))),
            "scale" => {
                let texture = self.value("tex", is_color, parameters)?.unwrap_or(Paint::number(1.0));
                Ok(match self.value("scale", false, parameters)?.unwrap_or(Paint::number(1.0)) {
                    Paint::Plain(factor) => texture.times(factor),
                    Paint::Picture(_) => {
                        self.collector.report.note(span, "the texture `scale` of a texture is left out");
                        texture
                    }
                })
            }
            "mix" => {
                let first = self.value("tex1", is_color, parameters)?.unwrap_or(Paint::number(0.0));
                let second = self.value("tex2", is_color, parameters)?.unwrap_or(Paint::number(1.0));
                let amount = self.value("amount", false, parameters)?.unwrap_or(Paint::number(0.5));
                Ok(match (&first, &second, amount) {
                    (Paint::Plain(a), Paint::Plain(b), Paint::Plain(amount)) => {
                        Paint::Plain(*a + (*b - *a) * amount)
                    }
                    _ => {
                        self.collector.report.note(span, "a mix of textures is taken as the first of them");
                        first
                    }
                })
            }
            "checkerboard" => {
                let mut colors = [Vec3::ONE, Vec3::ZERO];
                for (name, color) in ["tex1", "tex2"].into_iter().zip(&mut colors) {
                    match self.value(name, is_color, parameters)? {
                        Some(Paint::Plain(plain)) => *color = plain,
                        Some(Paint::Picture(picture)) => {
                            *color = GREY * picture.factor;
                            self.collector
                                .report
                                .note(span, "textures within a checkerboard are taken as grey");
                        }
                        None => {}
                    }
                }
                if parameters.number_or("dimension", 2.0)? != 2.0 {
                    self.collector
                        .report
                        .note(span, "a checkerboard in space is taken as one on the surface");
                }
                let UvMap { scale, offset } = self.mapping(parameters)?;
                // The picture is two units wide and high.
                let map = UvMap { scale: scale * 0.5, offset: offset * 0.5 };
                let texels = Rc::new(Texels::checkerboard(colors));
                Ok(Paint::Picture(Picture { texels, factor: Vec3::ONE, map }))
            }
            "imagemap" => self.image(parameters),
            _ => {
                let class = shortened(class);
                self.collector.report.note(span, format!("a texture of type `{class}` is taken as grey"));
                Ok(Paint::number(GREY))
            }
        }
    }

    fn image(&mut self, parameters: &Parameters) -> Result<Paint, SceneError> {
        let span = &parameters.span;
        let Some(file) = parameters.text("filename")?.map(str::to_owned) else {
            return Err(error(&codes::VALUE, span, "the texture has no `string filename`", "this texture"));
        };
        parameters.ignore(&["filter", "maxanisotropy"]);
        let wrap = match parameters.text("wrap")? {
            None | Some("repeat") => Wrap::Repeat,
            Some("clamp") => Wrap::Clamp,
            Some(other) => {
                let other = shortened(other);
                self.collector
                    .report
                    .note(span, format!("the wrap mode `{other}` of a texture is taken as `clamp`"));
                Wrap::Clamp
            }
        };
        let encoding = match parameters.text("encoding")? {
            None => None,
            Some("sRGB") => Some(Encoding::Srgb),
            Some("linear") => Some(Encoding::Linear),
            Some(other) => {
                let other = shortened(other);
                self.collector
                    .report
                    .note(span, format!("the encoding `{other}` of a texture is taken as `sRGB`"));
                Some(Encoding::Srgb)
            }
        };
        let scale = parameters.number_or("scale", 1.0)? as f32;
        let inverted = parameters.flag("invert")?;
        let map = self.mapping(parameters)?;
        let place = parameters.place("filename").clone();
        let Collector { materials, report, .. } = &mut self.collector;
        let texels = materials.picture(&file, encoding, wrap, &place, report)?;
        let Some(texels) = texels else { return Ok(Paint::number(GREY)) };
        let picture = Paint::Picture(Picture { texels, factor: Vec3::splat(scale), map });
        Ok(if inverted { picture.mapped(|value| 1.0 - value) } else { picture })
    }

    /// Returns the transform of texture coordinates. In pbrt, v is upwards.
    fn mapping(&mut self, parameters: &Parameters) -> Result<UvMap, SceneError> {
        let mapping = parameters.text("mapping")?;
        if let Some(other) = mapping.filter(|mapping| *mapping != "uv") {
            let note = format!("the mapping `{}` of a texture is taken as `uv`", shortened(other));
            self.collector.report.note(parameters.place("mapping"), note);
            parameters.ignore(&["v1", "v2"]);
        }
        let pair = |names: [&str; 2], default: f64| -> Result<Vec2, SceneError> {
            let [u, v] = names.map(|name| parameters.number_or(name, default));
            Ok(Vec2::new(u? as f32, v? as f32))
        };
        let scale = pair(["uscale", "vscale"], 1.0)?;
        let offset = pair(["udelta", "vdelta"], 0.0)?;
        Ok(upwards(scale, offset))
    }
}

/// Returns the transform for coordinates whose v is upwards: of a picture, v = 0 is its last row.
fn upwards(scale: Vec2, offset: Vec2) -> UvMap {
    UvMap { scale: scale * Vec2::new(1.0, -1.0), offset: Vec2::new(offset.x, 1.0 - offset.y) }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn v_is_upwards_behind_scale_and_offset() {
        let map = upwards(Vec2::new(2.0, 4.0), Vec2::new(0.25, 0.5));
        // s = 2u + 0.25, t = 4v + 0.5, and the row of the picture is at 1 − t.
        assert_eq!(map.apply(Vec2::new(0.5, 0.125)), Vec2::new(1.25, 0.0));
        assert_eq!(upwards(Vec2::ONE, Vec2::ZERO).apply(Vec2::ZERO), Vec2::Y);
    }
}
