//! Where the nodes of a graph go: in layers, so that most arrows point downwards and few cross.
//!
//! The steps are those of Sugiyama's method: arrows that close a circle are turned round, every node gets a layer, long arrows and labels
//! get places in the layers that they pass, the order in each layer follows the neighbours, and then the places do.

/// What is to be laid out: boxes by their width and height, and arrows between them with the sizes of their labels.
#[derive(Clone, Debug, Default)]
pub(super) struct Wanted {
    pub boxes: Vec<Size>,
    pub arrows: Vec<(usize, usize, Option<Size>)>,
}

/// Width and height.
pub(super) type Size = (f64, f64);
/// A place: to the right and down.
pub(super) type Place = (f64, f64);

/// Where everything goes.
#[derive(Clone, Debug, Default)]
pub(super) struct Layout {
    /// The middle of each box.
    pub boxes: Vec<Place>,
    /// The way of each arrow, from the border of one box to that of the other.
    pub arrows: Vec<Vec<Place>>,
    /// The middle of each label.
    pub labels: Vec<Option<Place>>,
    pub size: Size,
}

/// Between two in a layer, and between two layers.
const GAP: Size = (24.0, 34.0);
/// The width kept free for an arrow that passes a layer.
const LANE: f64 = 10.0;
/// How often the order of the layers is improved.
const SWEEPS: usize = 12;

/// Lays a graph out.
pub(super) fn layout(wanted: &Wanted) -> Layout {
    let mut net = Net::new(wanted);
    net.order();
    net.place();
    net.read_off(wanted)
}

/// Boxes, labels and lanes, all of which have a layer, and the links between neighbouring layers.
struct Net {
    sizes: Vec<Size>,
    /// The numbers of those in each layer, from left to right.
    layers: Vec<Vec<usize>>,
    above: Vec<Vec<usize>>,
    below: Vec<Vec<usize>>,
    middles: Vec<Place>,
    /// For each arrow, what it passes from its beginning to its end.
    ways: Vec<Vec<usize>>,
    /// For each arrow, its label.
    labels: Vec<Option<usize>>,
}

impl Net {
    fn new(wanted: &Wanted) -> Net {
        let turned = circles(wanted);
        let mut sizes = wanted.boxes.clone();
        let mut links = Vec::new();
        let mut labels = Vec::new();
        for (&(from, to, label), &is_turned) in wanted.arrows.iter().zip(&turned) {
            let (upper, lower) = if is_turned { (to, from) } else { (from, to) };
            let number = label.filter(|_| from != to).map(|size| {
                sizes.push(size);
                sizes.len() - 1
            });
            labels.push(number);
            match number {
                _ if from == to => {}
                Some(label) => links.extend([(upper, label), (label, lower)]),
                None => links.push((upper, lower)),
            }
        }
        let ranks = ranks(sizes.len(), &links);
        let mut net = Net {
            layers: vec![Vec::new(); ranks.iter().max().map_or(0, |r| r + 1)],
            above: vec![Vec::new(); sizes.len()],
            below: vec![Vec::new(); sizes.len()],
            middles: Vec::new(),
            sizes,
            ways: Vec::new(),
            labels,
        };
        ranks.iter().enumerate().for_each(|(node, &rank)| net.layers[rank].push(node));
        for (number, (&(from, to, _), &is_turned)) in wanted.arrows.iter().zip(&turned).enumerate() {
            let (upper, lower) = if is_turned { (to, from) } else { (from, to) };
            let stops: Vec<usize> = std::iter::once(upper).chain(net.labels[number]).chain([lower]).collect();
            let mut way = vec![upper];
            if from != to {
                stops.windows(2).for_each(|pair| net.link(&mut way, pair[1], &ranks));
            }
            if is_turned {
                way.reverse();
            }
            net.ways.push(way);
        }
        net.middles = vec![(0.0, 0.0); net.sizes.len()];
        net
    }

    /// Goes on to `to`, by a lane in every layer between.
    fn link(&mut self, way: &mut Vec<usize>, to: usize, ranks: &[usize]) {
        let Some(&from) = way.last() else { return };
        let mut last = from;
        for rank in ranks[from] + 1..ranks[to] {
            self.sizes.push((LANE, 0.0));
            let lane = self.sizes.len() - 1;
            self.above.push(Vec::new());
            self.below.push(Vec::new());
            self.layers[rank].push(lane);
            self.join(last, lane);
            way.push(lane);
            last = lane;
        }
        self.join(last, to);
        way.push(to);
    }

    fn join(&mut self, upper: usize, lower: usize) {
        self.below[upper].push(lower);
        self.above[lower].push(upper);
    }

    /// Orders the layers by the middle of their neighbours, downwards and upwards in turn, and keeps the order with the fewest crossings.
    fn order(&mut self) {
        let mut best = (self.crossings(), self.layers.clone());
        for sweep in 0..SWEEPS {
            let is_down = sweep % 2 == 0;
            let count = self.layers.len();
            for k in 1..count {
                let (layer, other) = if is_down { (k, k - 1) } else { (count - 1 - k, count - k) };
                let places = self.ranks_in(other);
                let links = if is_down { &self.above } else { &self.below };
                let mut keyed: Vec<(f64, usize)> = self.layers[layer]
                    .iter()
                    .enumerate()
                    .map(|(at, &node)| (mean(links[node].iter().map(|n| places[*n] as f64)).unwrap_or(at as f64), node))
                    .collect();
                keyed.sort_by(|a, b| a.0.total_cmp(&b.0));
                self.layers[layer] = keyed.into_iter().map(|(_, node)| node).collect();
            }
            let crossings = self.crossings();
            if crossings < best.0 {
                best = (crossings, self.layers.clone());
            }
        }
        self.layers = best.1;
    }

    /// For every node of a layer, its place from the left.
    fn ranks_in(&self, layer: usize) -> Vec<usize> {
        let mut places = vec![0; self.sizes.len()];
        self.layers[layer].iter().enumerate().for_each(|(at, &node)| places[node] = at);
        places
    }

    fn crossings(&self) -> usize {
        let between = |layer: usize| {
            let places = self.ranks_in(layer + 1);
            let links =
                self.layers[layer].iter().enumerate().flat_map(|(at, n)| self.below[*n].iter().map(move |b| (at, *b)));
            let links: Vec<(usize, usize)> = links.map(|(at, b)| (at, places[b])).collect();
            let crosses = |a: &(usize, usize), b: &(usize, usize)| a.0 < b.0 && a.1 > b.1;
            links.iter().map(|a| links.iter().filter(|b| crosses(a, b)).count()).sum::<usize>()
        };
        (0..self.layers.len().saturating_sub(1)).map(between).sum()
    }

    /// Gives places: layers one below the other, and in each as near to the neighbours as there is room.
    fn place(&mut self) {
        let mut y = 0.0;
        for layer in &self.layers {
            let height = layer.iter().map(|n| self.sizes[*n].1).fold(0.0, f64::max);
            layer.iter().for_each(|&node| self.middles[node].1 = y + height / 2.0);
            y += height + GAP.1;
        }
        for layer in 0..self.layers.len() {
            self.spread(layer, |_, _| None);
        }
        for sweep in 0..2 * SWEEPS {
            let count = self.layers.len();
            for k in 0..count {
                let layer = if sweep % 2 == 0 { k } else { count - 1 - k };
                self.spread(layer, |net, node| {
                    mean(net.above[node].iter().chain(&net.below[node]).map(|n| net.middles[*n].0))
                });
            }
        }
    }

    /// Places a layer so that nothing overlaps, and all are as near as can be to where they want to be.
    ///
    /// With the least distances taken off, places in order are numbers that do not decrease: those nearest to the wishes are the means
    /// of the runs in which the wishes are not in order.
    fn spread(&mut self, layer: usize, wish: impl Fn(&Net, usize) -> Option<f64>) {
        let nodes = self.layers[layer].clone();
        let mut runs: Vec<(f64, usize)> = Vec::new();
        let mut offsets = Vec::new();
        let mut offset = 0.0;
        for (at, &node) in nodes.iter().enumerate() {
            if at > 0 {
                offset += (self.sizes[nodes[at - 1]].0 + self.sizes[node].0) / 2.0 + GAP.0;
            }
            offsets.push(offset);
            let mut run = (wish(self, node).unwrap_or(self.middles[node].0) - offset, 1);
            while let Some(&(mean, count)) = runs.last()
                && mean > run.0
            {
                runs.pop();
                run = ((mean * count as f64 + run.0 * run.1 as f64) / (count + run.1) as f64, count + run.1);
            }
            runs.push(run);
        }
        let places = runs.iter().flat_map(|(mean, count)| std::iter::repeat_n(*mean, *count));
        for ((&node, place), offset) in nodes.iter().zip(places).zip(offsets) {
            self.middles[node].0 = place + offset;
        }
    }

    /// What has been found, with everything to the right of 0.
    fn read_off(mut self, wanted: &Wanted) -> Layout {
        let left = self.extremes(|(x, _), (width, _)| x - width / 2.0, f64::min);
        self.middles.iter_mut().for_each(|m| m.0 -= left);
        Layout {
            boxes: self.middles[..wanted.boxes.len()].to_vec(),
            arrows: (0..wanted.arrows.len()).map(|arrow| self.way(arrow)).collect(),
            labels: self.labels.iter().map(|label| label.map(|l| self.middles[l])).collect(),
            size: (
                self.extremes(|(x, _), (width, _)| x + width / 2.0, f64::max),
                self.extremes(|(_, y), (_, height)| y + height / 2.0, f64::max),
            ),
        }
    }

    fn extremes(&self, side: impl Fn(Place, Size) -> f64, pick: fn(f64, f64) -> f64) -> f64 {
        self.middles.iter().zip(&self.sizes).map(|(m, s)| side(*m, *s)).reduce(pick).unwrap_or(0.0)
    }

    /// The places that an arrow passes, from border to border.
    fn way(&self, arrow: usize) -> Vec<Place> {
        let way = &self.ways[arrow];
        let (Some(&from), Some(&to)) = (way.first(), way.last()) else { return Vec::new() };
        if way.len() < 2 {
            return Vec::new();
        }
        let mut places = vec![self.port(from, way[1])];
        for &stop in &way[1..way.len() - 1] {
            places.push(self.middles[stop]);
        }
        places.push(self.port(to, way[way.len() - 2]));
        places
    }

    /// Where on the border of a box its link to a neighbour begins: beside those of the others, in their order.
    fn port(&self, node: usize, neighbour: usize) -> Place {
        let ((x, y), (width, height)) = (self.middles[node], self.sizes[node]);
        let is_below = self.below[node].contains(&neighbour);
        let mut others = if is_below { self.below[node].clone() } else { self.above[node].clone() };
        others.sort_by(|a, b| self.middles[*a].0.total_cmp(&self.middles[*b].0));
        let at = others.iter().position(|n| *n == neighbour).unwrap_or(0) as f64;
        let step = (width * 0.6 / others.len() as f64).min(26.0);
        let shift = (at - (others.len() as f64 - 1.0) / 2.0) * step;
        (x + shift, if is_below { y + height / 2.0 } else { y - height / 2.0 })
    }
}

fn mean(numbers: impl Iterator<Item = f64>) -> Option<f64> {
    let (sum, count) = numbers.fold((0.0, 0), |(sum, count), x| (sum + x, count + 1));
    (count > 0).then(|| sum / f64::from(count))
}

/// For each arrow, whether it closes a circle on the way through the graph, which begins at the first box.
fn circles(wanted: &Wanted) -> Vec<bool> {
    let mut turned = vec![false; wanted.arrows.len()];
    let mut leaving = vec![Vec::new(); wanted.boxes.len()];
    wanted.arrows.iter().enumerate().for_each(|(arrow, (from, ..))| leaving[*from].push(arrow));
    // What has not been met, what is on the way, what is done with.
    let mut marks = vec![0_u8; wanted.boxes.len()];
    for root in 0..wanted.boxes.len() {
        if marks[root] != 0 {
            continue;
        }
        marks[root] = 1;
        let mut stack = vec![(root, 0)];
        while let Some((node, next)) = stack.last_mut() {
            let Some(&arrow) = leaving[*node].get(*next) else {
                marks[*node] = 2;
                stack.pop();
                continue;
            };
            *next += 1;
            let to = wanted.arrows[arrow].1;
            match marks[to] {
                0 => {
                    marks[to] = 1;
                    stack.push((to, 0));
                }
                1 => turned[arrow] = true,
                _ => {}
            }
        }
    }
    turned
}

/// The layer of each: one below the lowest of those that link to it. There are no circles.
fn ranks(count: usize, links: &[(usize, usize)]) -> Vec<usize> {
    let mut ranks = vec![0; count];
    // Each round settles one more layer.
    for _ in 0..count {
        let mut is_settled = true;
        for &(upper, lower) in links {
            if ranks[lower] <= ranks[upper] {
                ranks[lower] = ranks[upper] + 1;
                is_settled = false;
            }
        }
        if is_settled {
            break;
        }
    }
    ranks
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Graphs of all kinds, made by a small generator.
    fn graphs() -> Vec<Wanted> {
        let mut seed = 7_u32;
        let mut next = move |below: usize| {
            seed = seed.wrapping_mul(1_664_525).wrapping_add(1_013_904_223);
            (seed >> 16) as usize % below
        };
        (0..60)
            .map(|_| {
                let count = 1 + next(9);
                let boxes = (0..count).map(|_| (30.0 + next(120) as f64, 20.0 + next(40) as f64)).collect();
                let arrow = |next: &mut dyn FnMut(usize) -> usize| {
                    let label = (next(2) == 0).then(|| (20.0 + next(100) as f64, 14.0));
                    (next(count), next(count), label)
                };
                let arrows = (0..next(14)).map(|_| arrow(&mut next)).collect();
                Wanted { boxes, arrows }
            })
            .collect()
    }

    fn overlap(a: (Place, Size), b: (Place, Size)) -> bool {
        let apart = |a: f64, b: f64, sizes: f64| (a - b).abs() + 1e-6 >= sizes / 2.0;
        !apart(a.0.0, b.0.0, a.1.0 + b.1.0) && !apart(a.0.1, b.0.1, a.1.1 + b.1.1)
    }

    #[test]
    fn nothing_overlaps_and_everything_is_inside() {
        for wanted in graphs() {
            let laid = layout(&wanted);
            let boxes = laid.boxes.iter().copied().zip(wanted.boxes.iter().copied());
            let labels = wanted.arrows.iter().zip(&laid.labels).filter_map(|(a, place)| Some(((*place)?, a.2?)));
            let all: Vec<(Place, Size)> = boxes.chain(labels).collect();
            for (k, a) in all.iter().enumerate() {
                assert!(all[..k].iter().all(|b| !overlap(*a, *b)), "{wanted:?}\n{laid:?}");
                let ((x, y), (width, height)) = *a;
                assert!(x - width / 2.0 > -1e-6 && x + width / 2.0 < laid.size.0 + 1e-6, "{laid:?}");
                assert!(y - height / 2.0 > -1e-6 && y + height / 2.0 < laid.size.1 + 1e-6, "{laid:?}");
            }
        }
    }

    #[test]
    fn arrows_go_from_border_to_border() {
        for wanted in graphs() {
            let laid = layout(&wanted);
            for ((from, to, _), way) in wanted.arrows.iter().zip(&laid.arrows) {
                if from == to {
                    assert!(way.is_empty());
                    continue;
                }
                for (node, end) in [(from, way.first()), (to, way.last())] {
                    let ((x, y), (width, height)) = (laid.boxes[*node], wanted.boxes[*node]);
                    let (px, py) = *end.unwrap();
                    assert!((px - x).abs() <= width / 2.0 && ((py - y).abs() - height / 2.0).abs() < 1e-6);
                }
            }
        }
    }

    #[test]
    fn what_nothing_leads_to_stands_beside_the_rest() {
        let (size, label) = ((100.0, 30.0), Some((200.0, 16.0)));
        let wanted = Wanted { boxes: vec![size; 4], arrows: vec![(0, 2, label), (2, 0, label), (2, 3, None)] };
        let laid = layout(&wanted);
        assert!(laid.size.0 < 600.0, "{laid:?}");
    }

    #[test]
    fn a_chain_goes_straight_down() {
        let size = (50.0, 20.0);
        let wanted = Wanted { boxes: vec![size; 3], arrows: vec![(0, 1, None), (1, 2, None)] };
        let laid = layout(&wanted);
        assert!(laid.boxes.windows(2).all(|p| (p[0].0 - p[1].0).abs() < 1e-6 && p[1].1 > p[0].1));
    }
}
