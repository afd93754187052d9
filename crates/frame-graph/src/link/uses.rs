//! Asks each pass type for the settings and ports of each use of it.

use super::Linker;
use crate::codes;
use crate::description::{At, Body, Link, PassDecl, Set};
use crate::port::{PassTypeError, Ports, Use};
use crate::resolve::Node;
use data_file::{Code, Diagnostic, Misfit, Name, Place, Setting, Settings};
use rustc_hash::{FxHashMap, FxHasher};
use smallvec::SmallVec;
use std::hash::{Hash, Hasher};
use std::rc::Rc;
use std::sync::Arc;

/// The answer of a pass type about one use of it.
#[derive(Clone, Debug)]
pub(super) struct UseOf {
    pub(super) ports: Arc<Ports>,
    pub(super) names: Rc<PortNames>,
    pub(super) settings: Arc<Settings>,
    /// For each link of the description, the index of its input, if there is one.
    pub(super) linked: Vec<Option<u32>>,
    /// Names of the inputs that it links, if they differ from those of the description.
    pub(super) inputs: Option<Arc<[String]>>,
}

/// The names of ports, shared by all uses with the same ports.
#[derive(Debug)]
pub(super) struct PortNames {
    /// Port and interface.
    pub(super) inputs: Vec<(Name, Name)>,
    /// Port and interface.
    pub(super) outputs: Vec<(Name, Name)>,
}

/// Values derived from a value that pass types share between uses, by its address. The shared value is held,
/// so that its address stays unique.
type Shared<K, V> = FxHashMap<*const (), (Arc<K>, V)>;

/// Uses with the same hash.
type Alike<'a> = SmallVec<[(&'a PassDecl, Rc<UseOf>); 1]>;

#[derive(Default)]
struct Caches<'a> {
    /// The uses that were asked about and are valid, by a hash of everything that a pass type may look at: an
    /// equal use gets the same answer.
    uses: FxHashMap<u64, Alike<'a>>,
    defaults: FxHashMap<*const (), (Arc<[Setting]>, Arc<Settings>)>,
    names: Shared<Ports, Rc<PortNames>>,
}

impl UseOf {
    /// Returns the form in which the pass type is asked about a use.
    pub(super) fn ask<'u>(&'u self, decl: &'u PassDecl) -> Option<Use<'u>> {
        decl.use_of(self.inputs.as_deref().unwrap_or(&decl.link_names))
    }
}

/// Hashes what a pass type may look at in a use.
fn hash_use(decl: &PassDecl, kind: &Name, shader: Option<&Name>) -> u64 {
    let mut hasher = FxHasher::default();
    kind.hash(&mut hasher);
    shader.hash(&mut hasher);
    decl.link_names.hash(&mut hasher);
    for set in &decl.set {
        set.name.value.hash(&mut hasher);
    }
    hasher.finish()
}

/// Returns whether two uses are equal in everything that a pass type may look at.
fn same_use(a: &PassDecl, b: &PassDecl) -> bool {
    let (Body::Pass { kind: kind_a, shader: shader_a }, Body::Pass { kind: kind_b, shader: shader_b }) =
        (&a.body, &b.body)
    else {
        return false;
    };
    let sets = |a: &Set, b: &Set| a.name.value == b.name.value && a.value.get() == b.value.get();
    kind_a.value == kind_b.value
        && shader_a.as_ref().map(|s| &s.value) == shader_b.as_ref().map(|s| &s.value)
        && a.link_names == b.link_names
        && a.set.len() == b.set.len()
        && a.set.iter().zip(&b.set).all(|(a, b)| sets(a, b))
        && (Arc::ptr_eq(&a.overrides, &b.overrides) || a.overrides == b.overrides)
}

impl<'a> Linker<'a> {
    pub(super) fn find_uses(&mut self) {
        let mut caches = Caches::default();
        let mut uses = Vec::with_capacity(self.nodes.len());
        for node in self.nodes {
            let used = match &node.decl.body {
                Body::Pass { kind, shader } => self.known_use(node, kind, shader.as_ref(), &mut caches),
                Body::Group(_) | Body::Sub(_) | Body::Removed => None,
            };
            uses.push(used);
        }
        self.uses = Rc::new(uses);
    }

    /// Returns the answer of an equal use, or asks the pass type.
    fn known_use(
        &mut self,
        node: &'a Node,
        kind: &At<Name>,
        shader: Option<&At<Name>>,
        caches: &mut Caches<'a>,
    ) -> Option<Rc<UseOf>> {
        let decl = &*node.decl;
        let hash = hash_use(decl, &kind.value, shader.map(|s| &s.value));
        let known = caches.uses.get(&hash).into_iter().flatten();
        if let Some((_, used)) = known.into_iter().find(|(other, _)| same_use(decl, other)) {
            return Some(Rc::clone(used));
        }
        let count = self.errors.len();
        let used = Rc::new(self.find_use(node, kind, shader, caches)?);
        // Errors are reported for each use separately, so uses with errors are not shared.
        if self.errors.len() == count && used.inputs.is_none() {
            caches.uses.entry(hash).or_default().push((decl, Rc::clone(&used)));
        }
        Some(used)
    }

    fn find_use(
        &mut self,
        node: &Node,
        kind: &At<Name>,
        shader: Option<&At<Name>>,
        caches: &mut Caches<'a>,
    ) -> Option<UseOf> {
        let decl = &*node.decl;
        match (self.kinds.takes_shader(&kind.value), shader) {
            (None, _) => {
                let names = self.kinds.names();
                let error =
                    Diagnostic::new(&codes::UNKNOWN_KIND, format!("there is no pass type `{}`", kind.value))
                        .label(self.span(kind.place), "")
                        .suggest("pass types", &kind.value, names.iter().map(String::as_str));
                self.errors.push(error);
                return None;
            }
            (Some(true), None) => {
                let message = format!("the pass type `{}` needs a `shader:`", kind.value);
                let error = Diagnostic::new(&codes::SHADER, message)
                    .label(self.span(kind.place), "add shader: \"….wgsl\"");
                self.errors.push(error);
                return None;
            }
            (Some(false), Some(shader)) => {
                let message = format!("the pass type `{}` takes no `shader:`", kind.value);
                let error = Diagnostic::new(&codes::SHADER, message)
                    .label(self.span(shader.place), "remove this")
                    .label(self.span(kind.place), "this pass type has its own shaders")
                    .note("the pass types `compute` and `fullscreen` are for shaders of one's own");
                self.errors.push(error);
                return None;
            }
            _ => {}
        }
        let shader = shader.map(|s| s.value.as_str());
        // Inputs that `Replace` kept are dropped one by one if the new pass type does not have them.
        let mut inputs: Option<Arc<[String]>> = None;
        loop {
            let names = inputs.as_deref().unwrap_or(&decl.link_names);
            let use_ = Use { kind: &kind.value, shader, inputs: names, outputs: &decl.overrides };
            let asked = match self.kinds.settings(use_) {
                Ok(schema) => {
                    let settings = self.settings(node, &schema, caches);
                    self.kinds.ports(use_, &settings).map(|ports| (ports, settings))
                }
                Err(error) => Err(error),
            };
            match asked {
                Ok((ports, settings)) => {
                    let names = self.names(&ports, caches);
                    let input = |link: &Link| {
                        names.inputs.iter().position(|(port, _)| *port == link.port.value).map(|i| i as u32)
                    };
                    let linked = decl.links.iter().map(input).collect();
                    return Some(UseOf { ports, names, settings, linked, inputs });
                }
                Err(error) => {
                    let kept = |name: &String| decl.link(name).is_some_and(|link| link.inherited);
                    let dropped = error.input.as_ref().filter(|name| names.contains(name) && kept(name));
                    match dropped {
                        Some(dropped) => {
                            inputs = Some(names.iter().filter(|name| *name != dropped).cloned().collect());
                        }
                        None => {
                            self.refused(node, &error);
                            return None;
                        }
                    }
                }
            }
        }
    }

    /// Reports the error of a pass type about a use.
    pub(super) fn refused(&mut self, node: &Node, error: &PassTypeError) {
        let decl = &node.decl;
        let Body::Pass { kind, shader } = &decl.body else { return };
        let setting =
            error.setting.as_ref().and_then(|name| decl.set.iter().find(|s| s.name.value == **name));
        let link = error.input.as_ref().and_then(|name| decl.link(name));
        let out = error.output.as_ref().and_then(|name| decl.outs.iter().find(|o| o.port.value == **name));
        let place = setting.map(|s| s.place).or(link.map(|l| l.port.place)).or(out.map(|o| o.port.place));
        let shader = shader.as_ref().filter(|_| error.shader).map(|shader| shader.place);
        let place = place.or(shader);
        let mut diagnostic = Diagnostic::new(
            if error.shader { &codes::SHADER } else { &codes::REFUSED },
            format!("`{}`: {}", node.name, error.message),
        );
        diagnostic = match place {
            Some(place) => diagnostic
                .label(self.span(place), "here")
                .label(self.span(node.place), format!("in this pass, of pass type `{}`", kind.value)),
            None => diagnostic
                .label(self.span(node.place), format!("in this pass, of pass type `{}`", kind.value)),
        };
        if let Some(help) = &error.help {
            diagnostic = diagnostic.note(help.clone());
        }
        if let Some(file) = shader.map(|place| self.span(place).source.name.clone())
            && data_file::paths::is_link(&file)
        {
            diagnostic = diagnostic.note(format!(
                "`{file}` is a symbolic link: what it names is looked for beside the link, not beside what that leads to"
            ));
        }
        self.errors.push(diagnostic);
    }

    /// Returns the settings of a use, checked and complete.
    fn settings(&mut self, node: &Node, schema: &Arc<[Setting]>, caches: &mut Caches<'a>) -> Arc<Settings> {
        let set = &node.decl.set;
        let key = schema.as_ptr().cast::<()>();
        let made = || (Arc::clone(schema), Arc::new(Settings::defaults(schema)));
        let (_, defaults) = caches.defaults.entry(key).or_insert_with(made);
        if set.is_empty() {
            return Arc::clone(defaults);
        }
        let mut settings = Settings::clone(defaults);
        for given in set {
            let name = &given.name.value;
            let Some(value) = given.value.get() else { continue };
            let Some(setting) = schema.iter().find(|s| s.name == **name) else {
                let kind = if let Body::Pass { kind, .. } = &node.decl.body { &*kind.value } else { "" };
                let message = format!("the pass type `{kind}` has no setting `{name}`");
                let mut error =
                    Diagnostic::new(&codes::UNKNOWN_SETTING, message).label(self.span(given.name.place), "");
                if given.patched {
                    error = error.label(self.span(node.place), "of this pass");
                }
                self.errors.push(error.suggest("settings", name, schema.iter().map(|s| s.name.as_str())));
                continue;
            };
            match setting.check(value.clone()) {
                Ok(value) => {
                    settings.0.insert(name.to_string(), value);
                }
                Err(Misfit::Type(message)) => {
                    self.misfit(node, &codes::SETTING_TYPE, message, given.place, given);
                }
                Err(Misfit::Range(message)) => {
                    self.misfit(node, &codes::SETTING_RANGE, message, given.place, given);
                }
            }
        }
        Arc::new(settings)
    }

    fn misfit(
        &mut self,
        node: &Node,
        code: &'static Code,
        message: String,
        place: Place,
        set: &crate::description::Set,
    ) {
        let mut error = Diagnostic::new(code, message).label(self.span(place), "");
        if let Some(source) = set.value.explained() {
            error.labels[0].message = source;
            for (_, _, origin) in set.value.origins() {
                error = error.label(self.span(origin), "given here");
            }
        } else if set.patched {
            error = error.label(self.span(node.place), "of this pass");
        }
        self.errors.push(error);
    }

    fn names(&self, ports: &Arc<Ports>, caches: &mut Caches<'a>) -> Rc<PortNames> {
        let key = Arc::as_ptr(ports).cast::<()>();
        let (_, names) = caches.names.entry(key).or_insert_with(|| {
            let interface = |name: &str| {
                let known = self.interfaces.iter().find(|i| i.name == name).map(|i| Name::new(i.name));
                known.unwrap_or_else(|| Name::from(name))
            };
            let names = PortNames {
                inputs: ports.inputs.iter().map(|p| (Name::from(&p.name), interface(&p.interface))).collect(),
                outputs: ports
                    .outputs
                    .iter()
                    .map(|p| (Name::from(&p.name), interface(&p.interface)))
                    .collect(),
            };
            (Arc::clone(ports), Rc::new(names))
        });
        Rc::clone(names)
    }
}
