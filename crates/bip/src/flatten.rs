//! From checked types to a model: instances from the root down, then what connectors can do, then priorities.

mod expand;
mod instance;
mod rules;

use crate::check::Checked;
use crate::code::Memory;
use crate::model::{Atom, Connector, Model, Move, Port};
use crate::template::{Kind, Library};
use lapwing_diag::{Code, Diagnostic, Severity, Span};

/// How large a model may become.
mod limit {
    /// Atoms and compounds.
    pub const INSTANCES: usize = 100_000;
    /// Ports of atoms.
    pub const PORTS: usize = 4_000_000;
    /// Interactions of one connector, those of the connectors that it is made of multiplied.
    pub const COMBINATIONS: usize = 1 << 14;
    /// Priorities of all compounds together.
    pub const RULES: usize = 2_000;
    /// Ports in all interactions together.
    pub const LEAVES: usize = 1 << 24;
}

/// The proof that a diagnostic says what is wrong.
type Flat<T> = Result<T, Box<Diagnostic>>;

impl Checked {
    /// The model that begins with a compound: the one of that name, or without a name the only one that no other compound uses, or
    /// `Root`.
    ///
    /// # Errors
    /// Where the package has errors, where it is not clear what the root is, and where the model becomes too large.
    pub fn model(&self, root: Option<&str>) -> Result<Model, Vec<Diagnostic>> {
        let errors = self.diagnostics.iter().filter(|d| d.severity == Severity::Error);
        let errors: Vec<Diagnostic> = errors.cloned().collect();
        if !errors.is_empty() {
            return Err(errors);
        }
        let root = self.root(root).map_err(|d| vec![*d])?;
        build(&self.library, root).map_err(|d| vec![*d])
    }

    /// The compound that a run begins with.
    fn root(&self, name: Option<&str>) -> Flat<u32> {
        let found = match name {
            Some(name) => self.named_root(name)?,
            None => self.only_root()?,
        };
        match self.library.compounds.get(found as usize) {
            Some(compound) if !compound.frame.vars.is_empty() => {
                let message = format!(
                    "the compound `{}` takes parameters, and a run begins with one that takes none",
                    compound.name
                );
                Err(Box::new(Diagnostic::new(Code::BipRoot, compound.span, message)))
            }
            _ => Ok(found),
        }
    }

    fn named_root(&self, name: &str) -> Flat<u32> {
        // As the original tools take it, `Root()` is right too.
        let name = name.trim_end_matches("()");
        if let Some((_, index)) = self.roots.iter().rfind(|(n, _)| n == name) {
            return Ok(*index);
        }
        let message = format!("there is no compound `{name}` to begin with");
        let diagnostic = Diagnostic::new(Code::BipRoot, Span::default(), message);
        let names = self.roots.iter().map(|(n, _)| n.as_str());
        Err(Box::new(match lapwing_diag::suggest::nearest(name, names.clone()) {
            Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
            None => diagnostic.help(format!("compounds are {}", names.collect::<Vec<_>>().join(", "))),
        }))
    }

    fn only_root(&self) -> Flat<u32> {
        let components = self.library.compounds.iter().flat_map(|c| &c.components);
        let used: Vec<u32> =
            components.filter_map(|c| if let Kind::Compound(inner) = c.kind { Some(inner) } else { None }).collect();
        let free: Vec<&(String, u32)> = self.roots.iter().filter(|(_, index)| !used.contains(index)).collect();
        let called_root = || self.roots.iter().find(|(name, _)| name == "Root");
        if let [(_, only)] = free.as_slice() {
            return Ok(*only);
        }
        if let Some((_, root)) = called_root() {
            return Ok(*root);
        }
        let names: Vec<&str> = free.iter().map(|(name, _)| name.as_str()).collect();
        let message = match names.is_empty() {
            true => "the package declares no compound to begin with".to_owned(),
            false => format!("it is not clear with which compound to begin: {}", names.join(", ")),
        };
        let diagnostic = Diagnostic::new(Code::BipRoot, Span::default(), message);
        Err(Box::new(diagnostic.help("name one with `--root NAME`")))
    }
}

/// Everything that is made on the way.
struct Builder<'l> {
    library: &'l Library,
    memory: Memory,
    atoms: Vec<Atom>,
    ports: Vec<Port>,
    connectors: Vec<Connector>,
    moves: Vec<Move>,
    /// Inner moves: they come last in the model, and until then are known by their places here.
    inner: Vec<Move>,
    instances: usize,
    leaves: usize,
}

fn build(library: &Library, root: u32) -> Flat<Model> {
    let mut builder = Builder {
        library,
        memory: Memory::default(),
        atoms: Vec::new(),
        ports: Vec::new(),
        connectors: Vec::new(),
        moves: Vec::new(),
        inner: Vec::new(),
        instances: 0,
        leaves: 0,
    };
    let mut tree = builder.instantiate(root, "ROOT", Vec::new())?;
    builder.expand_all(&mut tree)?;
    let first_internal = builder.moves.len() as u32;
    builder.single_moves(|port| port.external.is_none() && !port.is_exported);
    let first_external = builder.moves.len() as u32;
    builder.single_moves(|port| port.external.is_some());
    let first_inner = builder.moves.len() as u32;
    builder.append_inner();
    let rules = builder.rules(&tree)?;
    builder.link(&rules);
    Ok(Model {
        extern_types: library.extern_types.iter().map(|t| t.name.clone()).collect(),
        functions: library.functions.clone(),
        atom_types: library.atoms.clone(),
        connector_types: library.connectors.clone(),
        may_cycle: rules::may_cycle(&builder.connectors, &rules),
        atoms: builder.atoms,
        ports: builder.ports,
        connectors: builder.connectors,
        moves: builder.moves,
        first_internal,
        first_external,
        first_inner,
        rules,
        memory: builder.memory,
    })
}

impl Builder<'_> {
    /// A move for each port of a kind that is made alone.
    fn single_moves(&mut self, wanted: impl Fn(&crate::template::Port) -> bool) {
        for atom in &self.atoms {
            let Some(ty) = self.library.atoms.get(atom.ty as usize) else { continue };
            for (index, _) in ty.ports.iter().enumerate().filter(|(_, p)| wanted(p)) {
                let leaf = atom.first_port + index as u32;
                self.moves.push(Move::of_ports([leaf].into()));
            }
        }
    }

    /// Puts inner moves behind all others.
    fn append_inner(&mut self) {
        let first = self.moves.len() as u32;
        self.moves.append(&mut self.inner);
        self.moves.iter_mut().flat_map(|m| &mut m.larger).for_each(|place| *place += first);
    }

    /// Notes which ports and atoms are of interest to which moves.
    fn link(&mut self, rules: &[crate::model::Rule]) {
        let mut by_port: Vec<Vec<u32>> = vec![Vec::new(); self.ports.len()];
        let mut by_atom: Vec<Vec<u32>> = vec![Vec::new(); self.atoms.len()];
        for (id, one) in self.moves.iter_mut().enumerate() {
            let id = id as u32;
            one.has_rivals |= rules.iter().any(|r| crate::model::among(&r.within_low, id));
            for leaf in &one.leaves {
                if let Some(moves) = by_port.get_mut(*leaf as usize) {
                    moves.push(id);
                }
                let atom = self.ports.get(*leaf as usize).map(|p| p.atom as usize);
                if let Some(moves) = atom.and_then(|a| by_atom.get_mut(a))
                    && !one.nodes.is_empty()
                {
                    moves.push(id);
                }
            }
        }
        for (port, moves) in self.ports.iter_mut().zip(by_port) {
            port.moves = moves.into();
        }
        for (atom, moves) in self.atoms.iter_mut().zip(by_atom) {
            atom.coded = moves.into();
        }
    }
}

/// A model that is too large, and where.
fn too_large<T>(span: Span, message: String) -> Flat<T> {
    Err(Box::new(Diagnostic::new(Code::TooLarge, span, message)))
}
