//! Builds a tree from triangles: by obvhs, or by median splits if the tree of obvhs is too deep for the
//! traversal stack.

use crate::gpu_data::{Bounds, Children, Kind};
use glam::{Vec3, Vec3A};
use obvhs::aabb::Aabb;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::leaf_collapser::collapse;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::ploc::{PlocBuilder, PlocSearchDistance, SortPrecision};

/// The greatest number of triangles of a leaf. With more, rays test more triangles than they save nodes.
const MOST_IN_LEAF: usize = 3;
/// A tree over more triangles is optimised less, so that the time of building grows with their number alone.
const FULLY_OPTIMISED: f32 = 2e5;
/// The margin of boxes while they are clustered, as a share of half the scene's extent. The area of a
/// flat box does not distinguish a strip from a square, so that clusters on walls of equal triangles became strips and
/// rays visited √n nodes; that of a box with a thickness grows with its perimeter too.
const THICKNESS: f32 = 1e-5;
/// Cost of traversing a node, in units of a ray-triangle test.
pub(crate) const TRAVERSAL_COST: f32 = 1.0;

/// A tree as it lies in memory: the root first, children after their parents.
pub(crate) struct Tree {
    pub(crate) items: Vec<Item>,
    /// The greatest number of children that can wait during a traversal.
    pub(crate) stack: usize,
}

/// The item at a place of a [`Tree`].
#[derive(Clone, Copy, Debug)]
pub(crate) enum Item {
    Node(Children),
    /// The index of a triangle.
    Triangle(u32),
}

/// Builds a tree over at least one triangle, given by their boxes. It needs a stack of at most `most` entries,
/// if `most` is at least what median splits need.
pub(crate) fn tree(bounds: &[Bounds], most: usize) -> Tree {
    let tree = widened(clustered(bounds));
    if tree.stack <= most { tree } else { widened(halved(bounds)) }
}

/// A binary tree, as pairs of children.
struct Binary {
    root: Side,
    pairs: Vec<[Side; 2]>,
    order: Vec<u32>,
}

/// A side of a [`Binary`] tree.
#[derive(Clone, Copy)]
enum Part {
    /// The index of a pair.
    Pair(usize),
    /// The first triangle, in the order of the leaves, and their number.
    Triangles(usize, usize),
}

/// A child in a [`Binary`] tree.
#[derive(Clone, Copy)]
struct Side {
    part: Part,
    /// When nodes are widened, the child with the greatest weight is opened first: the area of its box, in
    /// any unit.
    weight: f64,
}

impl Side {
    const NONE: Side = Side { part: Part::Triangles(0, 0), weight: 0.0 };

    fn is_pair(&self) -> bool {
        matches!(self.part, Part::Pair(_))
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
    let thick = |b: &Bounds| Aabb::new(place(b.low) - THICKNESS, place(b.high) + THICKNESS);
    let boxes: Vec<Aabb> = bounds.iter().map(thick).collect();
    let mut bvh = PlocBuilder::with_capacity(boxes.len()).build(
        PlocSearchDistance::Medium,
        &boxes,
        (0..boxes.len() as u32).collect(),
        SortPrecision::U64,
        3,
    );
    let effort = (FULLY_OPTIMISED / boxes.len() as f32).min(1.0);
    ReinsertionOptimizer::default().run(&mut bvh, 0.2 * effort, None);
    collapse(&mut bvh, MOST_IN_LEAF as u32, TRAVERSAL_COST);
    ReinsertionOptimizer::default().run(&mut bvh, effort, None);
    ordered(&bvh)
}

/// Converts the tree of obvhs, with triangles in the order of the leaves.
fn ordered(bvh: &Bvh2) -> Binary {
    let mut binary = Binary { root: Side::NONE, pairs: Vec::new(), order: Vec::new() };
    // A node of obvhs, and the pair and side that it is written to.
    let mut open = vec![(0, None)];
    while let Some((index, place)) = open.pop() {
        let node = &bvh.nodes[index];
        let (first, count) = (node.first_index as usize, node.prim_count as usize);
        let part = if node.is_leaf() {
            let start = binary.order.len();
            binary.order.extend(&bvh.primitive_indices[first..first + count]);
            Part::Triangles(start, count)
        } else {
            let pair = binary.pairs.len();
            binary.pairs.push([Side::NONE; 2]);
            open.extend([(first + 1, Some((pair, 1))), (first, Some((pair, 0)))]);
            Part::Pair(pair)
        };
        *binary.at(place) = Side { part, weight: f64::from(node.aabb().half_area()) };
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
        let part = if run.len() <= MOST_IN_LEAF {
            Part::Triangles(run.start, run.len())
        } else {
            let centers = inside.iter().map(|index| Bounds { low: center(index), high: center(index) });
            let around = Bounds::around(centers);
            let axis = (around.high - around.low).max_position();
            inside.select_nth_unstable_by(run.len() / 2, |a, b| center(a)[axis].total_cmp(&center(b)[axis]));
            let pair = binary.pairs.len();
            binary.pairs.push([Side::NONE; 2]);
            let middle = run.start + run.len() / 2;
            open.extend([(middle..run.end, Some((pair, 1))), (run.start..middle, Some((pair, 0)))]);
            Part::Pair(pair)
        };
        *binary.at(place) = Side { part, weight: run.len() as f64 };
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
            if let Part::Pair(pair) = sides.remove(heaviest).part {
                sides.extend(self.pairs[pair]);
            }
        }
        sides
    }
}

/// Converts to a tree with four children per node instead of two: half as many nodes along a path, and all
/// boxes of a node are read at once.
fn widened(binary: Binary) -> Tree {
    // Every place is written when its node is visited.
    let mut items = vec![Item::Triangle(0)];
    let mut open = vec![(binary.root, 0)];
    while let Some((side, place)) = open.pop() {
        let mut children = Children { first: items.len() as u32, kinds: [Kind::NONE; 4] };
        let nodes = open.len();
        for (kind, side) in children.kinds.iter_mut().zip(binary.opened(side)) {
            match side.part {
                Part::Pair(_) => {
                    *kind = Kind::NODE;
                    open.push((side, items.len()));
                    items.push(Item::Triangle(0));
                }
                Part::Triangles(first, count) => {
                    *kind = Kind::triangles(count);
                    items.extend(binary.order[first..first + count].iter().copied().map(Item::Triangle));
                }
            }
        }
        // The first child's own children follow next.
        open[nodes..].reverse();
        items[place] = Item::Node(children);
    }
    let stack = stack_need(&items);
    Tree { items, stack }
}

/// Returns the greatest number of children that can wait during a traversal, whatever their order: at each
/// level, all others of a node while one is visited.
fn stack_need(items: &[Item]) -> usize {
    let mut needs = vec![0; items.len()];
    for (index, item) in items.iter().enumerate().rev() {
        if let Item::Node(children) = item {
            let items = children.items();
            let below = items.iter().flat_map(|range| &needs[range.clone()]).max().copied().unwrap_or(0);
            let count = children.kinds.iter().filter(|kind| **kind != Kind::NONE).count();
            needs[index] = count - 1 + below;
        }
    }
    needs[0]
}
