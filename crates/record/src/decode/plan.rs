//! Compiles a layout and the wanted fields into the steps that a decoder takes: jump here, read there.

use lapwing_stream::Name;

use super::DecodeError;
use super::span::Span;
use super::tree::Tree;
use crate::definition::{Layout, Node, Prim};

/// A plan may not have more steps than this: a definition that needs more is made to.
const MAX_STEPS: usize = 1 << 16;

/// How to get the wanted fields of one message type.
#[derive(Debug)]
pub(super) struct Plan {
    pub steps: Vec<Step>,
    /// Whether a wide text is anywhere: how wide its characters are is then found by trying.
    pub wide: bool,
    /// Whether bytes that remain are an error.
    pub complete: bool,
}

#[derive(Debug)]
pub(super) enum Step {
    /// Over a run of fixed size.
    Jump(Span),
    /// Over a text.
    Text,
    /// Over a wide text.
    WideText,
    /// Over an array of what has no fixed size, or no fixed number.
    Array(Count, Body),
    /// The value here goes into that slot.
    Read(usize, Shape),
    /// What the inner steps read lies ahead: afterwards the position is as before.
    Peek(Vec<Step>),
    /// To one element of an array, where there is one.
    Index {
        /// How many elements there are.
        count: Count,
        /// Which one is wanted, from 0.
        index: usize,
        /// Over one element.
        over: Body,
        /// What to do with it.
        then: Vec<Step>,
        /// The slots that miss it where the array is too short.
        missed: Vec<usize>,
    },
}

/// The number of elements of an array: fixed, or in front of it.
pub(super) type Count = Option<usize>;

/// How to get over one element of an array.
#[derive(Debug)]
pub(super) enum Body {
    Fixed(Span),
    Steps(Vec<Step>),
}

/// How to read a whole value.
#[derive(Debug)]
pub(super) enum Shape {
    Bool,
    Num(Prim),
    Text,
    WideText,
    Nums(Count, Prim),
    List(Count, Box<Shape>),
    Record(Vec<(Name, Shape)>),
    /// A message without fields, which takes one byte in CDR.
    Nothing(Span),
}

impl Plan {
    /// The plan for the wanted fields of a message, aligned as in CDR or packed as in ROS 1.
    pub fn new(layout: &Layout, wanted: &Tree, aligned: bool) -> Result<Plan, DecodeError> {
        let mut compiler = Compiler { aligned, steps: 0, wide: false };
        let mut steps = Vec::new();
        compiler.message(layout, wanted, &mut steps)?;
        Ok(Plan { steps, wide: compiler.wide, complete: true })
    }

    /// Leaves out what comes after the last step that reads.
    pub fn cut(&mut self) {
        let end = self.steps.iter().rposition(|s| matches!(s, Step::Read(..) | Step::Peek(_))).map_or(0, |at| at + 1);
        self.steps.truncate(end);
        self.complete = false;
    }
}

struct Compiler {
    aligned: bool,
    steps: usize,
    wide: bool,
}

type Compiled<T> = Result<T, DecodeError>;

impl Compiler {
    /// One step more; runs of fixed size grow together.
    fn push(&mut self, steps: &mut Vec<Step>, step: Step) -> Compiled<()> {
        if let (Some(Step::Jump(before)), Step::Jump(more)) = (steps.last_mut(), &step) {
            *before = before.then(*more);
            return Ok(());
        }
        self.count()?;
        steps.push(step);
        Ok(())
    }

    fn count(&mut self) -> Compiled<()> {
        self.steps += 1;
        if self.steps > MAX_STEPS {
            return Err(DecodeError::new(format!("its definition needs more than {MAX_STEPS} steps to decode")));
        }
        Ok(())
    }

    fn message(&mut self, layout: &Layout, wanted: &Tree, steps: &mut Vec<Step>) -> Compiled<()> {
        let has = |name: &str| layout.fields().iter().any(|(n, _)| &**n == name);
        let names = wanted.spelled(has);
        if let Some((unknown, _)) = names.iter().find(|(name, _)| !has(name)) {
            return Err(no_such_field(layout, unknown));
        }
        if !wanted.items.is_empty() {
            return Err(DecodeError::new(format!(
                "{} is a message, not an array: it has no elements",
                layout.schema().name
            )));
        }
        if names.is_empty()
            && let Some(span) = layout.span(self.aligned)
        {
            return self.push(steps, Step::Jump(span));
        }
        for (name, node) in layout.fields() {
            // Two spellings of one name, as `secs` and `sec`, are looked at one after the other.
            let mut below = names.iter().filter(|(n, _)| n == name).map(|(_, tree)| *tree).peekable();
            if below.peek().is_none() {
                self.node(node, &Tree::default(), steps)?;
            }
            while let Some(tree) = below.next() {
                match below.peek() {
                    Some(_) => self.peek(node, tree, steps)?,
                    None => self.node(node, tree, steps)?,
                }
            }
        }
        Ok(())
    }

    fn peek(&mut self, node: &Node, wanted: &Tree, steps: &mut Vec<Step>) -> Compiled<()> {
        let mut inner = Vec::new();
        self.node(node, wanted, &mut inner)?;
        self.push(steps, Step::Peek(inner))
    }

    fn node(&mut self, node: &Node, wanted: &Tree, steps: &mut Vec<Step>) -> Compiled<()> {
        if let Some((&last, others)) = wanted.whole.split_last() {
            for &slot in others {
                let read = Step::Read(slot, self.shape(node)?);
                self.push(steps, Step::Peek(vec![read]))?;
            }
            if wanted.is_deep() {
                let mut inner = Vec::new();
                self.below(node, wanted, &mut inner)?;
                self.push(steps, Step::Peek(inner))?;
            }
            let read = Step::Read(last, self.shape(node)?);
            return self.push(steps, read);
        }
        self.below(node, wanted, steps)
    }

    /// What lies below a node; the node itself is passed over.
    fn below(&mut self, node: &Node, wanted: &Tree, steps: &mut Vec<Step>) -> Compiled<()> {
        match node {
            Node::Message(layout) => return self.message(layout, wanted, steps),
            Node::Array { length, element } => {
                if let Some((name, _)) = wanted.names.first() {
                    return Err(DecodeError::new(format!(
                        "`{name}` is asked of an array: write an index before it, as in `[0].{name}`"
                    )));
                }
                self.indices(*length, element, wanted, steps)?;
            }
            _ if wanted.is_deep() => {
                let what = wanted.names.first().map_or_else(|| "[ ]".to_owned(), |(name, _)| name.to_string());
                return Err(DecodeError::new(format!(
                    "`{what}` is asked of a plain value, which has no fields and no elements"
                )));
            }
            _ => {}
        }
        self.over(node, steps)
    }

    fn indices(&mut self, count: Count, element: &Node, wanted: &Tree, steps: &mut Vec<Step>) -> Compiled<()> {
        for (index, tree) in &wanted.items {
            let mut then = Vec::new();
            self.node(element, tree, &mut then)?;
            let step = Step::Index { count, index: *index, over: self.body(element)?, then, missed: tree.slots() };
            self.push(steps, Step::Peek(vec![step]))?;
        }
        Ok(())
    }

    fn over(&mut self, node: &Node, steps: &mut Vec<Step>) -> Compiled<()> {
        if let Some(span) = node.span(self.aligned) {
            return self.push(steps, Step::Jump(span));
        }
        let step = match node {
            Node::Message(layout) => return self.message(layout, &Tree::default(), steps),
            Node::Array { length, element } => Step::Array(*length, self.body(element)?),
            Node::WideText => {
                self.wide = true;
                Step::WideText
            }
            Node::Text | Node::Prim(_) => Step::Text,
        };
        self.push(steps, step)
    }

    fn body(&mut self, element: &Node) -> Compiled<Body> {
        if let Some(span) = element.span(self.aligned) {
            return Ok(Body::Fixed(span));
        }
        let mut steps = Vec::new();
        self.over(element, &mut steps)?;
        Ok(Body::Steps(steps))
    }

    fn shape(&mut self, node: &Node) -> Compiled<Shape> {
        self.count()?;
        Ok(match node {
            Node::Prim(Prim::Bool) => Shape::Bool,
            Node::Prim(prim) => Shape::Num(*prim),
            Node::Text => Shape::Text,
            Node::WideText => {
                self.wide = true;
                Shape::WideText
            }
            Node::Array { length, element } => match **element {
                Node::Prim(prim) if prim != Prim::Bool => Shape::Nums(*length, prim),
                _ => Shape::List(*length, Box::new(self.shape(element)?)),
            },
            Node::Message(layout) => match layout.span(self.aligned) {
                Some(span) if layout.fields().is_empty() => Shape::Nothing(span),
                _ => Shape::Record(self.record(layout)?),
            },
        })
    }

    fn record(&mut self, layout: &Layout) -> Compiled<Vec<(Name, Shape)>> {
        layout.fields().iter().map(|(name, node)| Ok((name.clone(), self.shape(node)?))).collect()
    }
}

fn no_such_field(layout: &Layout, name: &str) -> DecodeError {
    let known: Vec<&str> = layout.fields().iter().map(|(n, _)| &**n).collect();
    DecodeError::new(format!("{} has no field `{name}`; it has {}", layout.schema().name, known.join(", ")))
}
