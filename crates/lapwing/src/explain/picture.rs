//! Specifications as pictures: state diagrams, and which obligations a property puts when.

mod machine;
mod obligations;

use lapwing_check::checked::{Body, Property, Spec as Meaning};
use lapwing_draw::Graph;
pub use lapwing_draw::Picture;

use super::formula::Printer;
use crate::spec::Spec;

/// The pictures of a specification: one for each property. `None` where it has none.
pub(super) fn draw(spec: &Spec, meaning: &Meaning, picture: Picture) -> Option<String> {
    let printer = Printer { spec, meaning };
    let graph = |property: &Property| match &property.body {
        Body::Machine(_) => diagram(spec, meaning, property),
        Body::Formula(formula) => Some(obligations::graph(&printer, &property.name, formula)),
        Body::None => None,
    };
    let graphs: Vec<Graph> = meaning.properties.iter().filter_map(graph).collect();
    (!graphs.is_empty()).then(|| lapwing_draw::draw(spec.name(), &graphs, picture))
}

/// The state diagram that a property is, where it is one. Its nodes are the machine's states, in their order.
pub(crate) fn diagram(spec: &Spec, meaning: &Meaning, property: &Property) -> Option<Graph> {
    match &property.body {
        Body::Machine(number) => machine::graph(&Printer { spec, meaning }, meaning.machines.get(*number)?),
        Body::Formula(_) | Body::None => None,
    }
}
