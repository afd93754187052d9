//! Builds a tree from triangles: by obvhs, or by median splits if the tree of obvhs is too deep for the
//! traversal stack.

use crate::gpu_data::{Bounds, BvhNode, BvhTriangle, Child};
use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

const MOST_IN_LEAF: u32 = 4;
/// Cost of traversing a node, in units of a ray-triangle test.
pub(crate) const TRAVERSAL_COST: f32 = 1.0;

/// A tree: the nodes, with children after their parents and boxes not yet computed, and the order of the
/// triangles.
pub(crate) struct Tree {
    pub(crate) nodes: Vec<BvhNode>,
    pub(crate) order: Vec<u32>,
    /// The greatest number of children that can wait during a traversal.
    pub(crate) stack: usize,
}

/// Builds a tree over at least one triangle. It needs a stack of at most `most` entries, if `most` is at
/// least what median splits need.
pub(crate) fn tree(triangles: &[BvhTriangle], most: usize) -> Tree {
    let bounds: Vec<Bounds> = triangles.iter().map(BvhTriangle::bounds).collect();
    let tree = widened(clustered(&bounds));
    if tree.stack <= most { tree } else { widened(halved(&bounds)) }
}

/// A binary tree, as pairs of children.
struct Binary {
    root: Side,
    pairs: Vec<[Side; 2]>,
    order: Vec<u32>,
}

/// A child in a [`Binary`] tree: the index of a pair, or a range of triangles.
#[derive(Clone, Copy)]
struct Side {
    child: Child,
    /// When nodes are widened, the child with the greatest weight is opened first: the area of its box, in
    /// any unit.
    weight: f64,
}

impl Side {
    const NONE: Side = Side { child: Child::ROOT, weight: 0.0 };

    fn is_pair(&self) -> bool {
        self.child.leaf().is_none()
    }
}

/// Builds a tree by parallel locally ordered clustering and reinsertion of nodes, with leaves chosen by the
/// surface area heuristic (Meister and Bittner 2018 and 2017).
fn clustered(bounds: &[Bounds]) -> Binary {
    // Coordinates are scaled to a unit cube, so that areas neither overflow nor vanish at any scale.
    let whole = Bounds::around(bounds.iter().copied());
    let center = whole.low * 0.5 + whole.high * 0.5;
    let scale = 1.0 / (whole.high * 0.5 - whole.low * 0.5).max_element().max(f32::MIN_POSITIVE);
    let place = |p: Vec3| Vec3A::from((p - center) * scale);
    let boxes: Vec<Aabb> = bounds.iter().map(|b| Aabb::new(place(b.low), place(b.high))).collect();
    let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        3,
    );
    ReinsertionOptimizer::default().run(&mut bvh, 0.05, None);
    collapse(&mut bvh, MOST_IN_LEAF, TRAVERSAL_COST);
    ReinsertionOptimizer::default().run(&mut bvh, 0.1, None);
    ordered(&bvh)
}

/// Converts the tree of obvhs, with triangles in the order of the leaves.
fn ordered(bvh: &Bvh2) -> Binary {
    let mut binary = Binary { root: Side::NONE, pairs: Vec::new(), order: Vec::new() };
    // A node of obvhs, and the pair and side that it is written to.
    let mut open = vec![(0, None)];
    while let Some((index, place)) = open.pop() {
        let node = &bvh.nodes[index];
        let (first, count) = (node.first_index as usize, node.prim_count);
        let child = if node.is_leaf() {
            let start = binary.order.len() as u32;
            binary.order.extend(&bvh.primitive_indices[first..first + count as usize]);
            Child::triangles(start, count)
        } else {
            let pair = binary.pairs.len();
            binary.pairs.push([Side::NONE; 2]);
            open.extend([(first + 1, Some((pair, 1))), (first, Some((pair, 0)))]);
            Child(pair as u32)
        };
        *binary.at(place) = Side { child, weight: f64::from(node.aabb().half_area()) };
    }
    binary
}

/// Builds a tree of the least possible depth: each pair divides the triangles into two halves along the
/// longest side of the box around their centres. Weights are numbers of triangles instead of areas, so that
/// the tree stays shallow when it is widened.
fn halved(bounds: &[Bounds]) -> Binary {
    let center = |index: &u32| bounds[*index as usize].low * 0.5 + bounds[*index as usize].high * 0.5;
    let mut order: Vec<u32> = (0..bounds.len() as u32).collect();
    let mut binary = Binary { root: Side::NONE, pairs: Vec::new(), order: Vec::new() };
    let mut open = vec![(0..order.len(), None)];
    while let Some((run, place)) = open.pop() {
        let inside = &mut order[run.clone()];
        let child = if run.len() <= MOST_IN_LEAF as usize {
            Child::triangles(run.start as u32, run.len() as u32)
        } else {
            let centers = inside.iter().map(|index| Bounds { low: center(index), high: center(index) });
            let around = Bounds::around(centers);
            let axis = (around.high - around.low).max_position();
            inside.select_nth_unstable_by(run.len() / 2, |a, b| center(a)[axis].total_cmp(&center(b)[axis]));
            let pair = binary.pairs.len();
            binary.pairs.push([Side::NONE; 2]);
            let middle = run.start + run.len() / 2;
            open.extend([(middle..run.end, Some((pair, 1))), (run.start..middle, Some((pair, 0)))]);
            Child(pair as u32)
        };
        *binary.at(place) = Side { child, weight: run.len() as f64 };
    }
    binary.order = order;
    binary
}

impl Binary {
    /// Returns the side of a pair, or the root.
    fn at(&mut self, place: Option<(usize, usize)>) -> &mut Side {
        match place {
            Some((pair, side)) => &mut self.pairs[pair][side],
            None => &mut self.root,
        }
    }

    /// Returns up to four descendants that together make up the side.
    fn opened(&self, side: Side) -> Vec<Side> {
        let mut sides = vec![side];
        while sides.len() < 4 {
            let pairs = sides.iter().enumerate().filter(|(_, side)| side.is_pair());
            let Some((heaviest, _)) = pairs.max_by(|a, b| a.1.weight.total_cmp(&b.1.weight)) else { break };
            let pair = sides.remove(heaviest).child;
            sides.extend(self.pairs[pair.0 as usize]);
        }
        sides
    }
}

/// Converts to a tree with four children per node instead of two: half as many nodes along a path, and their
/// boxes fit into vectors.
fn widened(binary: Binary) -> Tree {
    let mut nodes: Vec<BvhNode> = Vec::new();
    let mut open = vec![(binary.root, None)];
    while let Some((side, place)) = open.pop() {
        let index = nodes.len();
        if let Some((parent, k)) = place {
            let parent: &mut BvhNode = &mut nodes[parent];
            parent.children[k] = Child(index as u32);
        }
        let mut node = BvhNode::EMPTY;
        for (k, side) in binary.opened(side).into_iter().enumerate() {
            node.children[k] = side.child;
            // A placeholder box: marks the child as present until boxes are computed.
            node.set_bounds(k, Bounds { low: Vec3::ZERO, high: Vec3::ZERO });
            if side.is_pair() {
                open.push((side, Some((index, k))));
            }
        }
        nodes.push(node);
    }
    let stack = stack_need(&nodes);
    Tree { nodes, order: binary.order, stack }
}

/// Returns the greatest number of children that can wait during a traversal, whatever their order: at each
/// level, all others of a node while one is visited.
fn stack_need(nodes: &[BvhNode]) -> usize {
    let mut needs = vec![0; nodes.len()];
    for (index, node) in nodes.iter().enumerate().rev() {
        let below = node.children().filter(|(child, _)| child.leaf().is_none());
        let deepest = below.map(|(child, _)| needs[child.0 as usize]).max().unwrap_or(0);
        needs[index] = node.children().count() - 1 + deepest;
    }
    needs[0]
}
