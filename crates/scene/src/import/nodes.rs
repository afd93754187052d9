//! Reads nodes, and what is attached to them: meshes, cameras, lights, animations.

use std::f32::consts::{FRAC_PI_2, PI};

use glam::{Affine3A, Mat4, Quat, Vec3};
use gltf::json::animation::{Animation, Interpolation, Property};
use gltf::json::extensions::scene::khr_lights_punctual::{Light, Type};
use gltf::json::scene;
use gltf::json::validation::Checked;

use super::deform::targets_of;
use super::{Importer, named};
use crate::animation::{Animated, Between, Outside, Track};
use crate::error::SceneError;
use crate::light::{BRIGHTEST, LightKind};
use crate::model::{Model, Node, NodeAnimation, NodeCamera, NodeLight, Transform};

/// Distance of the near plane if that of a camera is not usable \[m\].
const DEFAULT_NEAR: f32 = 0.01;

impl Importer<'_> {
    /// Adds the nodes of the document's scene (its default scene, otherwise its first, otherwise every node
    /// that is not a child), with their cameras, lights and skins, and the first animation.
    pub(super) fn nodes(&mut self, model: &mut Model) -> Result<(), SceneError> {
        let mut placed = vec![None; self.root.nodes.len()];
        let mut skinned = Vec::new();
        // Children are put on a stack, so that deep trees cannot overflow; reversed, so that they keep their
        // order.
        let mut open: Vec<(usize, Option<usize>)> =
            self.roots()?.into_iter().rev().map(|i| (i, None)).collect();
        while let Some((index, parent)) = open.pop() {
            let json = self.get(&self.root.nodes, index, "node", "nodes")?;
            let name = named(&json.name).unwrap_or_else(|| format!("node {index}"));
            let place = format!("node {index} `{name}`");
            if placed[index].replace(model.nodes.len()).is_some() {
                return Err(self.wrong(place, "it is reached twice: nodes must form a tree"));
            }
            let rest = rest(json);
            if !rest.is_finite() {
                return Err(self.wrong(place, "its transform is not finite"));
            }
            let mesh = json.mesh.map(|mesh| mesh.value());
            if let Some(mesh) = mesh {
                self.get(&self.root.meshes, mesh, "mesh", &place)?;
            }
            let node = model.nodes.len();
            skinned.extend(json.skin.map(|skin| (node, skin.value())));
            let morph = self.morph(json, &place, model)?;
            self.camera(json, node, &name, &place, model)?;
            self.light(json, node, &name, &place, model)?;
            model.nodes.push(Node { name, parent, rest, animation: None, mesh, skin: None, morph });
            let children = json.children.iter().flatten().rev();
            open.extend(children.map(|child| (child.value(), Some(node))));
        }
        self.skins(&skinned, &placed, model)?;
        if let Some(animation) = self.root.animations.first() {
            self.animate(animation, &placed, model)?;
        }
        Ok(())
    }

    fn roots(&self) -> Result<Vec<usize>, SceneError> {
        let scene = match self.root.scene {
            Some(scene) => Some(self.get(&self.root.scenes, scene.value(), "scene", "scene")?),
            None => self.root.scenes.first(),
        };
        if let Some(scene) = scene {
            return Ok(scene.nodes.iter().map(|node| node.value()).collect());
        }
        let mut is_child = vec![false; self.root.nodes.len()];
        for child in self.root.nodes.iter().flat_map(|node| node.children.iter().flatten()) {
            if let Some(child) = is_child.get_mut(child.value()) {
                *child = true;
            }
        }
        Ok((0..is_child.len()).filter(|i| !is_child[*i]).collect())
    }

    fn camera(
        &mut self,
        json: &scene::Node,
        node: usize,
        node_name: &str,
        place: &str,
        model: &mut Model,
    ) -> Result<(), SceneError> {
        let Some(index) = json.camera else { return Ok(()) };
        let camera = self.get(&self.root.cameras, index.value(), "camera", place)?;
        let name = named(&camera.name).unwrap_or_else(|| node_name.to_string());
        let Some(perspective) = &camera.perspective else {
            self.repairs.push(format!("camera `{name}` is left out: it is orthographic"));
            return Ok(());
        };
        let vertical_fov = perspective.yfov;
        if !(vertical_fov > 0.0 && vertical_fov < PI) {
            let problem = format!("expected a yfov between 0 and π, found {vertical_fov}");
            return Err(self.wrong(format!("camera {} `{name}`", index.value()), problem));
        }
        let near = perspective.znear;
        let near = if near > 0.0 && near.is_finite() {
            near
        } else {
            self.repairs.push(format!("camera `{name}`: its znear {near} is taken as {DEFAULT_NEAR} m"));
            DEFAULT_NEAR
        };
        model.cameras.push(NodeCamera { name, node, vertical_fov, near });
        Ok(())
    }

    fn light(
        &mut self,
        json: &scene::Node,
        node: usize,
        node_name: &str,
        place: &str,
        model: &mut Model,
    ) -> Result<(), SceneError> {
        let Some(index) = json.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref()) else {
            return Ok(());
        };
        let index = index.light.value();
        let lights = self.root.extensions.as_ref().and_then(|e| e.khr_lights_punctual.as_ref());
        let light: &Light = self.get(lights.map_or(&[][..], |l| &l.lights), index, "light", place)?;
        let name = named(&light.name).unwrap_or_else(|| node_name.to_string());
        let place = format!("light {index} `{name}`");
        let kind = match light.type_ {
            Checked::Valid(Type::Point) => LightKind::Point,
            Checked::Valid(Type::Directional) => LightKind::Directional,
            Checked::Valid(Type::Spot) => {
                let (inner, outer) =
                    light.spot.as_ref().map_or((0.0, PI / 4.0), |s| (s.inner_cone_angle, s.outer_cone_angle));
                // A small tolerance: the last digit of a right angle may be rounded.
                if !(outer > 0.0 && outer <= FRAC_PI_2 * 1.0001 && (0.0..=outer).contains(&inner)) {
                    let problem = format!(
                        "expected 0 ≤ innerConeAngle ≤ outerConeAngle ≤ π/2, found {inner} and {outer}"
                    );
                    return Err(self.wrong(place, problem));
                }
                LightKind::Spot { inner: inner.min(FRAC_PI_2), outer: outer.min(FRAC_PI_2) }
            }
            Checked::Invalid => {
                return Err(self.wrong(place, "its type is none of `spot`, `point`, `directional`"));
            }
        };
        if let Some(range) = light.range {
            self.repairs
                .push(format!("{place}: its range of {range} m is left out: light falls off with 1/d²"));
        }
        let emitted = Vec3::from(light.color) * light.intensity;
        let intensity = emitted.clamp(Vec3::ZERO, Vec3::splat(BRIGHTEST));
        if intensity != emitted {
            self.repairs
                .push(format!("{place}: its intensity is not within 0 to 10³⁰ and is taken as the nearer"));
        }
        model.lights.push(NodeLight { name, node, kind, intensity });
        Ok(())
    }

    /// Adds an animation to the nodes; it repeats after its last key.
    fn animate(
        &mut self,
        animation: &Animation,
        placed: &[Option<usize>],
        model: &mut Model,
    ) -> Result<(), SceneError> {
        let clip = named(&animation.name).unwrap_or_else(|| "0".into());
        let others = self.root.animations.len() - 1;
        if others > 0 {
            self.repairs.push(format!("of {} animations the first, `{clip}`, plays", others + 1));
        }
        let mut times = Vec::new();
        for (index, sampler) in animation.samplers.iter().enumerate() {
            let place = format!("animation `{clip}`, sampler {index}");
            let input = self.floats::<1>(sampler.input.value(), &place)?;
            times.push(input.into_iter().map(|[t]| t).collect::<Vec<f32>>());
        }
        let end = times.iter().flatten().copied().filter(|t| t.is_finite()).fold(0.0, f32::max);
        let outside = Outside::Repeat(end);
        for (number, channel) in animation.channels.iter().enumerate() {
            let place = format!("animation `{clip}`, channel {number}");
            let sampler_index = channel.sampler.value();
            let sampler = self.get(&animation.samplers, sampler_index, "sampler", &place)?;
            self.get(&self.root.nodes, channel.target.node.value(), "node", &place)?;
            let Some(node) = placed[channel.target.node.value()] else { continue };
            let (Checked::Valid(path), Checked::Valid(interpolation)) =
                (channel.target.path, sampler.interpolation)
            else {
                return Err(self.wrong(place, "its path or interpolation is none of those of glTF 2.0"));
            };
            let times = &times[sampler_index];
            let output = sampler.output.value();
            let made = match path {
                Property::MorphTargetWeights => {
                    let values = self.floats::<1>(output, &place)?;
                    let values: Vec<f32> = values.into_iter().flatten().collect();
                    let targets = model.nodes[node].mesh.map_or(0, |mesh| targets_of(&model.meshes[mesh]));
                    weight_tracks(times, &values, targets, interpolation, outside)
                        .map(|tracks| model.nodes[node].morph.tracks = tracks)
                }
                Property::Rotation => {
                    let values = self.floats::<4>(output, &place)?;
                    let values = values.into_iter().map(Quat::from_array).collect();
                    track(times, values, interpolation, outside).map(|t| part(model, node).rotation = Some(t))
                }
                Property::Translation | Property::Scale => {
                    let values = self.floats::<3>(output, &place)?;
                    let values = values.into_iter().map(Vec3::from).collect();
                    track(times, values, interpolation, outside).map(|t| {
                        let part = part(model, node);
                        if path == Property::Scale {
                            part.scale = Some(t);
                        } else {
                            part.translation = Some(t);
                        }
                    })
                }
            };
            if let Err(why) = made {
                self.repairs.push(format!("{place} is left out: {why}"));
            }
        }
        Ok(())
    }
}

/// Returns the animation of a node, initialised with its transform at rest.
fn part(model: &mut Model, node: usize) -> &mut NodeAnimation {
    let node = &mut model.nodes[node];
    let base = Transform::from_affine(&node.rest);
    node.animation.get_or_insert_with(|| NodeAnimation { base, ..NodeAnimation::default() })
}

/// Returns the track of a sampler; with CUBICSPLINE, each key has the slope in, the value, the slope out.
fn track<T: Animated + Unit>(
    times: &[f32],
    values: Vec<T>,
    interpolation: Interpolation,
    outside: Outside,
) -> Result<Track<T>, String> {
    let a_key = if interpolation == Interpolation::CubicSpline { 3 } else { 1 };
    if values.len() != times.len() * a_key {
        let expected = times.len() * a_key;
        return Err(format!("expected {expected} values for {} times, found {}", times.len(), values.len()));
    }
    let (values, between): (Vec<T>, _) = match interpolation {
        Interpolation::Step => (values, Between::Step),
        Interpolation::Linear => (values, Between::Linear),
        Interpolation::CubicSpline => (
            values.chunks_exact(3).map(|key| key[1]).collect(),
            Between::Cubic(values.chunks_exact(3).map(|key| [key[0], key[2]]).collect()),
        ),
    };
    let keys = times.iter().copied().zip(values.into_iter().map(Unit::unit)).collect();
    Track::new(keys, between, outside)
}

/// Returns a track for each morph target; each key has the values of all of them, one after the other.
fn weight_tracks(
    times: &[f32],
    values: &[f32],
    targets: usize,
    interpolation: Interpolation,
    outside: Outside,
) -> Result<Vec<Track<f32>>, String> {
    let of = |target| values.iter().skip(target).step_by(targets).copied().collect();
    let a_time = if interpolation == Interpolation::CubicSpline { 3 * targets } else { targets };
    if targets == 0 {
        return Err("its node's mesh has no morph targets".into());
    }
    if values.len() != times.len() * a_time {
        let (expected, found) = (times.len() * a_time, values.len());
        return Err(format!(
            "expected {expected} values for {} times and {targets} morph targets, found {found}",
            times.len()
        ));
    }
    (0..targets).map(|target| track(times, of(target), interpolation, outside)).collect()
}

/// Values that must be normalised.
trait Unit {
    fn unit(self) -> Self;
}

impl Unit for f32 {
    fn unit(self) -> Self {
        self
    }
}

impl Unit for Vec3 {
    fn unit(self) -> Self {
        self
    }
}

impl Unit for Quat {
    fn unit(self) -> Self {
        unit_quaternion(self)
    }
}

/// Returns a quaternion of length 1; one of length zero becomes the identity.
fn unit_quaternion(q: Quat) -> Quat {
    glam::Vec4::from(q).try_normalize().map_or(Quat::IDENTITY, Quat::from_vec4)
}

fn rest(json: &scene::Node) -> Affine3A {
    if let Some(matrix) = json.matrix {
        return Affine3A::from_mat4(Mat4::from_cols_array(&matrix));
    }
    Transform {
        translation: json.translation.map_or(Vec3::ZERO, Vec3::from),
        rotation: json.rotation.as_ref().map_or(Quat::IDENTITY, |q| unit_quaternion(Quat::from_array(q.0))),
        scale: json.scale.map_or(Vec3::ONE, Vec3::from),
    }
    .affine()
}
