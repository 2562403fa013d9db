//! What connectors can do: every set of ports that they let interact, down to the ports of atoms.

use super::instance::{Behind, Child, Tree};
use super::{Builder, Flat, limit, too_large};
use crate::model::{Connector, Move, Node, Part, is_part};
use crate::template::{self, Source};
use crate::value::Type;
use lapwing_diag::Span;
use std::collections::HashMap;
use std::ops::Range;
use std::rc::Rc;

/// One way in which a connector, or a port, takes part.
#[derive(Clone)]
struct Way {
    leaves: Vec<u32>,
    nodes: Vec<Node>,
    parts: Vec<(u32, Part)>,
    /// Places of the variables that are seen from outside.
    shown: Vec<(String, Type, u32)>,
    /// Inner moves in whose presence this is not seen.
    larger: Vec<u32>,
}

/// The ways of connectors, by the numbers of the compound and of the connector in it.
type Ways = HashMap<(usize, u32), Rc<Vec<Way>>>;

/// The ways that are known already.
#[derive(Default)]
struct Known {
    /// As connectors of the same compound see them.
    all: Ways,
    /// As they are seen from outside, through a port that the compound exports.
    exported: Ways,
}

impl Builder<'_> {
    /// Makes the moves of all connectors that are no parts of others.
    pub(super) fn expand_all(&mut self, tree: &mut Tree) -> Flat<()> {
        let mut known = Known::default();
        let moves = self.expand_tree(tree, &mut known)?;
        self.hand_out(tree, &mut moves.into_iter());
        Ok(())
    }

    /// Gives the moves to the compounds, in the order in which they were made.
    fn hand_out(&self, tree: &mut Tree, moves: &mut impl Iterator<Item = Option<Range<u32>>>) {
        let connectors = self.library.compounds.get(tree.ty as usize).map_or(0, |c| c.connectors.len());
        tree.moves = moves.by_ref().take(connectors).collect();
        for child in &mut tree.children {
            if let Child::Compound(inner) = child {
                self.hand_out(inner, moves);
            }
        }
    }

    /// The moves of each connector, compounds before those that they are made of.
    fn expand_tree(&mut self, tree: &Tree, known: &mut Known) -> Flat<Vec<Option<Range<u32>>>> {
        let library = self.library;
        let mut all = Vec::new();
        let Some(compound) = library.compounds.get(tree.ty as usize) else { return Ok(all) };
        for (index, connection) in compound.connectors.iter().enumerate() {
            let is_part = library.connectors.get(connection.ty as usize).is_none_or(|c| c.export.is_some());
            if is_part {
                all.push(None);
                continue;
            }
            let ways = self.ways(tree, index as u32, known)?;
            let labels = connection.ports.iter().map(|(_, label)| label.clone()).collect();
            let path = format!("{}.{}", tree.path, connection.name);
            all.push(Some(self.add_moves(path, labels, &ways, connection.span)?));
        }
        for child in &tree.children {
            if let Child::Compound(inner) = child {
                all.extend(self.expand_tree(inner, known)?);
            }
        }
        Ok(all)
    }

    fn add_moves(&mut self, path: String, labels: Box<[String]>, ways: &[Way], span: Span) -> Flat<Range<u32>> {
        let first = self.moves.len() as u32;
        let connector = self.connectors.len() as u32;
        // Larger sets come last: of two that compete the later one goes first.
        let mut order: Vec<&Way> = ways.iter().collect();
        order.sort_by_key(|way| way.leaves.len());
        for way in order {
            self.leaves += way.leaves.len();
            if self.leaves > limit::LEAVES {
                return too_large(span, "the interactions of the model have too many ports together".to_owned());
            }
            self.moves.push(Move {
                connector,
                leaves: way.leaves.clone().into(),
                nodes: way.nodes.clone().into(),
                parts: way.parts.clone().into(),
                has_rivals: ways.len() > 1 || !way.larger.is_empty(),
                larger: way.larger.clone().into(),
            });
        }
        let moves = first..self.moves.len() as u32;
        self.connectors.push(Connector { path, labels, moves: moves.clone() });
        Ok(moves)
    }

    /// The ways in which a connector takes part, by the sets of its ports and the ways of each of these.
    fn ways(&mut self, tree: &Tree, index: u32, known: &mut Known) -> Flat<Rc<Vec<Way>>> {
        let key = (tree.id, index);
        if let Some(ways) = known.all.get(&key) {
            return Ok(ways.clone());
        }
        let library = self.library;
        let compound = library.compounds.get(tree.ty as usize);
        let Some(connection) = compound.and_then(|c| c.connectors.get(index as usize)) else {
            return Ok(Default::default());
        };
        let Some(ty) = library.connectors.get(connection.ty as usize) else { return Ok(Default::default()) };
        let mut by_port = Vec::new();
        for (source, _) in &connection.ports {
            let mut ways = Vec::new();
            for behind in self.sources(tree, source) {
                match behind {
                    Behind::Port(port) => ways.push(self.leaf(port)),
                    Behind::Connector(inner, index) => {
                        let found = match source {
                            Source::Connector(_) => self.ways(inner, index, known)?,
                            Source::Component(..) => self.exported_ways(inner, index, known)?,
                        };
                        ways.extend(found.iter().cloned().map(as_part));
                    }
                }
            }
            by_port.push(ways);
        }
        let mut all = Vec::new();
        for (set, action) in &ty.sets {
            self.combine(connection, ty, set, *action, &by_port, &mut all)?;
        }
        let all = Rc::new(all);
        known.all.insert(key, all.clone());
        Ok(all)
    }

    /// The ways of a connector that a compound exports. Maximal progress holds within the compound, so that outside of it a way is seen only
    /// where no larger one is possible: each becomes an inner move, for those that it hides to ask for.
    fn exported_ways(&mut self, tree: &Tree, index: u32, known: &mut Known) -> Flat<Rc<Vec<Way>>> {
        let key = (tree.id, index);
        if let Some(ways) = known.exported.get(&key) {
            return Ok(ways.clone());
        }
        let ways = self.ways(tree, index, known)?;
        if ways.len() < 2 {
            return Ok(ways);
        }
        let first = self.inner.len() as u32;
        for way in ways.iter() {
            let (nodes, larger) = (way.nodes.clone().into(), way.larger.clone().into());
            self.inner.push(Move { nodes, larger, ..Move::of_ports(way.leaves.clone().into()) });
        }
        let exported = ways.iter().map(|way| {
            let hides = |(_, other): &(u32, &Way)| is_part(&way.leaves, &other.leaves);
            let larger = (first..).zip(ways.iter()).filter(hides).map(|(inner, _)| inner);
            Way { larger: way.larger.iter().copied().chain(larger).collect(), ..way.clone() }
        });
        let exported: Rc<Vec<Way>> = Rc::new(exported.collect());
        self.leaves += exported.iter().map(|way| way.leaves.len() + way.larger.len()).sum::<usize>();
        if self.leaves > limit::LEAVES {
            let span = self.library.compounds.get(tree.ty as usize).map(|c| c.span).unwrap_or_default();
            return too_large(span, "the interactions that this compound exports are too many".to_owned());
        }
        known.exported.insert(key, exported.clone());
        Ok(exported)
    }

    /// A port of an atom, which takes part in one way.
    fn leaf(&self, port: u32) -> Way {
        let shown = || {
            let found = self.ports.get(port as usize)?;
            let atom = self.atoms.get(found.atom as usize)?;
            let vars = &self.library.atoms.get(atom.ty as usize)?.ports.get(found.index as usize)?.vars;
            let place = |v: &template::Var| {
                let base = if v.ty.is_plain() { atom.base.cells } else { atom.base.objects };
                (v.name.clone(), v.ty, base + v.slot)
            };
            Some(vars.iter().map(place).collect())
        };
        Way {
            leaves: vec![port],
            nodes: Vec::new(),
            parts: vec![(0, Part::Port(port))],
            shown: shown().unwrap_or_default(),
            larger: Vec::new(),
        }
    }

    /// All ways of one set of ports: each way of the first with each of the second, and so on.
    fn combine(
        &mut self,
        connection: &template::Connection,
        ty: &template::Connector,
        set: &[u32],
        action: Option<u32>,
        by_port: &[Vec<Way>],
        all: &mut Vec<Way>,
    ) -> Flat<()> {
        let choices: Vec<&Vec<Way>> = set.iter().filter_map(|p| by_port.get(*p as usize)).collect();
        let count = choices.iter().try_fold(1_usize, |n, ways| n.checked_mul(ways.len()));
        if count.is_none_or(|n| n + all.len() > limit::COMBINATIONS) {
            let message =
                format!("the connector `{}` has more than {} interactions", connection.name, limit::COMBINATIONS);
            return too_large(connection.span, message);
        }
        for number in 0..count.unwrap_or(0) {
            let mut rest = number;
            let mut chosen = Vec::with_capacity(set.len());
            for (port, ways) in set.iter().zip(&choices).rev() {
                chosen.extend(ways.get(rest % ways.len()).map(|way| (*port, way)));
                rest /= ways.len();
            }
            chosen.reverse();
            all.extend(self.join(connection.ty, ty, action, &chosen));
        }
        Ok(())
    }

    /// Ports with their ways, as one; none where an atom would take part twice.
    fn join(&mut self, id: u32, ty: &template::Connector, action: Option<u32>, chosen: &[(u32, &Way)]) -> Option<Way> {
        let mut leaves: Vec<u32> = chosen.iter().flat_map(|(_, way)| way.leaves.iter().copied()).collect();
        leaves.sort_unstable();
        let atoms: Vec<u32> = leaves.iter().filter_map(|p| self.ports.get(*p as usize)).map(|p| p.atom).collect();
        // Ports of an atom follow one another, so those of one atom are neighbours.
        if atoms.windows(2).any(|pair| pair.first() == pair.last()) {
            return None;
        }
        let part = |(port, way): &(u32, &Way)| {
            let part = match way.parts.as_slice() {
                [(_, Part::Port(leaf))] if way.nodes.is_empty() => Part::Port(*leaf),
                _ => Part::Shown(way.shown.clone().into()),
            };
            (*port, part)
        };
        let parts = chosen.iter().map(part).collect();
        let mut nodes: Vec<Node> = chosen.iter().flat_map(|(_, way)| way.nodes.iter().cloned()).collect();
        let table = self.table(ty, chosen);
        let shown = match &ty.export {
            Some((_, _, vars)) => vars.iter().map(|v| (v.name.clone(), v.ty, table.place(v.ty, v.slot))).collect(),
            None => Vec::new(),
        };
        if let Some(action) = action {
            nodes.push(Node { ty: id, action, cells: table.cells.into(), objects: table.objects.into() });
        }
        let larger = chosen.iter().flat_map(|(_, way)| way.larger.iter().copied()).collect();
        Some(Way { leaves, nodes, parts, shown, larger })
    }

    /// Where the variables of a connector's frame lie: its own in places of their own, those of ports where they are.
    fn table(&mut self, ty: &template::Connector, chosen: &[(u32, &Way)]) -> Places {
        let mut places = Places {
            cells: vec![u32::MAX; ty.frame.cells as usize],
            objects: vec![u32::MAX; ty.frame.objects as usize],
        };
        for (var, value) in &ty.own {
            let at = self.memory.allocate(var.ty, value);
            places.set(var.ty, var.slot, at);
        }
        for (port, way) in chosen {
            let vars = ty.seen.get(*port as usize).map_or(&[][..], Vec::as_slice);
            for (var, (_, _, at)) in vars.iter().zip(&way.shown) {
                places.set(var.ty, var.slot, *at);
            }
        }
        places
    }
}

/// Where the variables of a frame lie.
struct Places {
    cells: Vec<u32>,
    objects: Vec<u32>,
}

impl Places {
    fn set(&mut self, ty: Type, slot: u32, at: u32) {
        let list = if ty.is_plain() { &mut self.cells } else { &mut self.objects };
        if let Some(place) = list.get_mut(slot as usize) {
            *place = at;
        }
    }

    fn place(&self, ty: Type, slot: u32) -> u32 {
        let list = if ty.is_plain() { &self.cells } else { &self.objects };
        list.get(slot as usize).copied().unwrap_or(u32::MAX)
    }
}

/// The way of a connector, as its surroundings see it: by the port that it exports.
fn as_part(mut way: Way) -> Way {
    way.parts = Vec::new();
    way
}
