//! Remembers what pass types say of their outputs.

use super::uses::UseOf;
use super::{GraphPort, GraphPorts, Wire};
use rustc_hash::{FxHashMap, FxHasher};
use smallvec::SmallVec;
use std::hash::{Hash, Hasher};
use std::rc::Rc;
use std::sync::Arc;

/// All that the outputs of a pass depend on beside the frame and the scene, by addresses: the linker holds the uses and
/// the answers, so that each address stays its own.
pub(super) struct Question {
    key: Key,
    /// Whether the outputs of every pass that it links to are known.
    pub(super) whole: bool,
}

/// The use, and its links.
type Key = (*const UseOf, SmallVec<[Linked; 4]>);

/// What is linked to an input: index of the input, the outputs of the producer, index of the port, and the member.
type Linked = (u32, *const GraphPort, u32, Option<u32>);

impl Question {
    /// Asks about a use without links.
    pub(super) fn of(used: &Rc<UseOf>) -> Question {
        Question { key: (Rc::as_ptr(used), SmallVec::new()), whole: true }
    }

    /// Adds a link, where the outputs of its producer are known.
    pub(super) fn link(&mut self, wire: &Wire, producer: Option<&GraphPorts>) {
        match producer {
            Some(ports) => {
                self.key.1.push((wire.input, ports.as_ptr(), wire.end.port, wire.end.member));
            }
            None => self.whole = false,
        }
    }
}

/// The answers to questions, so that a chain of like passes asks its pass type once.
///
/// This is right because [`PassTypes`](crate::PassTypes) are pure: the same question gets the same answer. Uses that a
/// pass type cannot distinguish are one [`UseOf`], so questions of equal addresses are equal in all that the pass type
/// sees. Equal answers are kept as one object, so that the next pass of a chain asks the same question as the last.
#[derive(Default)]
pub(super) struct Answers {
    known: FxHashMap<Key, GraphPorts>,
    /// Every answer, by a hash of its resources.
    all: FxHashMap<u64, SmallVec<[GraphPorts; 1]>>,
}

impl Answers {
    pub(super) fn get(&self, question: &Question) -> Option<GraphPorts> {
        // Before all inputs are known, an error may mean no more than that.
        self.known.get(&question.key).filter(|_| question.whole).cloned()
    }

    /// Keeps an answer; gives the one that is kept of those that are equal.
    pub(super) fn add(&mut self, question: Question, ports: Vec<GraphPort>) -> GraphPorts {
        let mut hasher = FxHasher::default();
        for port in &ports {
            port.port.hash(&mut hasher);
            port.members.iter().for_each(|(name, desc, _)| (name, desc).hash(&mut hasher));
        }
        let alike = self.all.entry(hasher.finish()).or_default();
        let answer = match alike.iter().find(|other| ***other == *ports) {
            Some(other) => Arc::clone(other),
            None => {
                let answer = GraphPorts::from(ports);
                alike.push(Arc::clone(&answer));
                answer
            }
        };
        if question.whole {
            self.known.insert(question.key, Arc::clone(&answer));
        }
        answer
    }
}
