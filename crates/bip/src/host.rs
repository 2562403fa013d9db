//! What a model asks of its surroundings: the functions that it declares as external.

use crate::value::{Type, Value};
use std::collections::BTreeMap;

/// Answers the calls of a model's external functions and operators.
pub trait Host {
    /// Calls the function of that number in [`crate::Model::functions`]. Arguments that the function does not declare as `const` may be
    /// changed: where a variable was given, it takes the new value.
    ///
    /// `atom` is the number of the atom whose code calls, in [`crate::Model::atoms`]; none where a connector's code does.
    ///
    /// # Errors
    /// What went wrong, in a few words: it ends the run.
    fn call(&mut self, function: u32, args: &mut [Value], atom: Option<u32>) -> Result<Value, String>;
}

/// An external function or operator as a model declares it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Signature {
    /// Its name; of an operator its sign.
    pub name: String,
    /// What it takes.
    pub params: Vec<Type>,
    /// For each of them whether it may only be read.
    pub is_const: Vec<bool>,
    /// What it gives.
    pub result: Option<Type>,
    /// Where it is declared.
    pub span: lapwing_diag::Span,
}

type Function<'f> = Box<dyn FnMut(&mut [Value]) -> Result<Value, String> + 'f>;

/// Functions by name: a [`Host`] for whoever needs no more.
#[derive(Default)]
pub struct Registry<'f> {
    functions: BTreeMap<String, Function<'f>>,
}

impl<'f> Registry<'f> {
    /// Adds a function, or replaces the one of that name.
    pub fn with(
        mut self,
        name: &str,
        function: impl FnMut(&mut [Value]) -> Result<Value, String> + 'f,
    ) -> Registry<'f> {
        self.functions.insert(name.to_owned(), Box::new(function));
        self
    }

    /// The names of its functions.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.functions.keys().map(String::as_str)
    }

    /// A host for a model.
    ///
    /// # Errors
    /// A diagnostic for each function that the model declares and the registry does not have.
    pub fn bind(self, model: &crate::Model) -> Result<Bound<'f>, Vec<lapwing_diag::Diagnostic>> {
        let missing = |s: &&Signature| !self.functions.contains_key(&s.name);
        let complaint = |s: &Signature| {
            let message = format!("nobody provides the external function `{}`", s.name);
            let diagnostic = lapwing_diag::Diagnostic::new(lapwing_diag::Code::BipExternal, s.span, message);
            match lapwing_diag::suggest::nearest(&s.name, self.names()) {
                Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
                None => diagnostic.help(format!("there are {}", self.names().collect::<Vec<_>>().join(", "))),
            }
        };
        let complaints: Vec<_> = model.functions().iter().filter(missing).map(complaint).collect();
        if !complaints.is_empty() {
            return Err(complaints);
        }
        let names = model.functions().iter().map(|s| s.name.clone()).collect();
        Ok(Bound { registry: self, names })
    }
}

/// A [`Registry`] that knows the functions of a model.
pub struct Bound<'f> {
    registry: Registry<'f>,
    names: Vec<String>,
}

impl Host for Bound<'_> {
    fn call(&mut self, function: u32, args: &mut [Value], _: Option<u32>) -> Result<Value, String> {
        let name = self.names.get(function as usize);
        match name.and_then(|n| self.registry.functions.get_mut(n)) {
            Some(function) => function(args),
            None => Err("a call of a function that nobody provides".to_owned()),
        }
    }
}
