//! The package and its plain declarations.

use super::{Parse, Parser};
use crate::ast::{
    Annotation, AnnotationValue, ConstData, Decl, DeclKind, ExternFunction, ExternOperator, ExternType, Name, Package,
    Param, PortType,
};
use crate::lexer::TokenKind;
use lapwing_diag::{Code, Diagnostic};

/// The words that begin a declaration of a package.
const STARTS: &[&str] = &["const", "data", "extern", "port", "connector", "atom", "compound", "end", "@"];

impl Parser<'_> {
    pub(super) fn package(&mut self) -> Package {
        let mut package = Package::default();
        if self.package_head(&mut package).is_err() {
            self.skip_to(STARTS);
        }
        while !self.at_end() && !self.is("end") {
            let before = self.at;
            match self.decls(&mut package.decls) {
                Ok(()) => {}
                Err(_) => self.skip_to(STARTS),
            }
            if self.at == before {
                self.advance();
            }
        }
        if self.require("end").is_ok() && !self.at_end() {
            let span = self.span();
            let message = "the package has ended, and there is more";
            self.report(Diagnostic::new(Code::Syntax, span, message).help("a file holds one package"));
        }
        package
    }

    fn package_head(&mut self, package: &mut Package) -> Parse<()> {
        package.annotations = self.annotations()?;
        self.require("package")?;
        package.name = self.path("the name of the package")?;
        while self.take("use") {
            package.uses.push(self.path("the name of a package")?);
        }
        Ok(())
    }

    pub(super) fn annotations(&mut self) -> Parse<Vec<Annotation>> {
        let mut all = Vec::new();
        while self.take("@") {
            let name = self.name("the name of an annotation")?;
            let entries = if self.is("(") { self.bracketed(Self::annotation_entry)? } else { Vec::new() };
            all.push(Annotation { name, entries });
        }
        Ok(all)
    }

    fn annotation_entry(&mut self) -> Parse<(Name, Option<AnnotationValue>)> {
        // Keys such as `include` may be words of the language too.
        if self.kind() != TokenKind::Name {
            return self.missing("a key");
        }
        let key = Name { text: self.here(), span: self.span() };
        self.advance();
        if !self.take("=") {
            return Ok((key, None));
        }
        let value = match self.kind() {
            TokenKind::Text => AnnotationValue::Text(self.text_literal()?),
            TokenKind::Name | TokenKind::Int => {
                let word = self.here();
                self.advance();
                AnnotationValue::Word(word)
            }
            _ => return self.missing("a word or a text"),
        };
        Ok((key, Some(value)))
    }

    fn decls(&mut self, decls: &mut Vec<Decl>) -> Parse<()> {
        let mut annotations = self.annotations()?;
        let start = self.span();
        for kind in self.decl_kinds()? {
            let span = start.to(self.last_span());
            decls.push(Decl { notes: Vec::new(), annotations: std::mem::take(&mut annotations), kind, span });
        }
        Ok(())
    }

    fn decl_kinds(&mut self) -> Parse<Vec<DeclKind>> {
        let one = |kind| Ok(vec![kind]);
        if self.is("const") || self.is("data") {
            return self.constants();
        }
        if self.take("extern") {
            return one(self.external()?);
        }
        match self.peek(0) {
            "port" => one(DeclKind::Port(self.port_type()?)),
            "connector" => one(DeclKind::Connector(self.connector_type()?)),
            "atom" => one(DeclKind::Atom(self.atom_type()?)),
            "compound" => one(DeclKind::Compound(self.compound_type()?)),
            found => {
                let near =
                    lapwing_diag::suggest::nearest(found, ["const", "extern", "port", "connector", "atom", "compound"]);
                let message = format!("a declaration is expected here, and `{found}` begins none");
                let diagnostic = Diagnostic::new(Code::Syntax, self.span(), message);
                Err(self.report(match near {
                    Some(near) => diagnostic.help(format!("did you mean `{near}`?")),
                    None => diagnostic.help(
                        "a declaration begins with `port type`, `connector type`, `atom type`, `compound type`, \
                         `const data` or `extern`",
                    ),
                }))
            }
        }
    }

    fn constants(&mut self) -> Parse<Vec<DeclKind>> {
        let is_const = self.take("const");
        self.require("data")?;
        if !self.take("const") && !is_const {
            return self.missing("`const`: a variable belongs into an atom, and what a package declares is constant,");
        }
        let ty = self.path("a type")?;
        self.separated(|p| {
            let name = p.name("the name of the constant")?;
            p.require("=")?;
            Ok(DeclKind::Const(ConstData { ty: ty.clone(), name, value: p.expr()? }))
        })
    }

    /// What follows `extern`.
    fn external(&mut self) -> Parse<DeclKind> {
        if self.take("data") {
            self.require("type")?;
            let name = self.name("the name of the type")?;
            let refines = if self.take("refine") { self.paths("a type")? } else { Vec::new() };
            let backend = if self.take("as") { Some(self.text_literal()?) } else { None };
            return Ok(DeclKind::ExternType(ExternType { name, refines, backend }));
        }
        if self.take("operator") {
            let result = self.path("the type of the result")?;
            let (operator, span) = self.operator()?;
            let params = self.bracketed(Self::loose_param)?;
            return Ok(DeclKind::ExternOperator(ExternOperator { result, operator, span, params }));
        }
        self.require("function")?;
        self.take("const");
        let first = self.path("a type or the name of the function")?;
        if self.is("(") {
            let Some(name) = first.parts.into_iter().next_back() else { return self.missing("a name") };
            let params = self.bracketed(Self::loose_param)?;
            return Ok(DeclKind::ExternFunction(ExternFunction { result: None, name, params }));
        }
        let name = self.name("the name of the function")?;
        let params = self.bracketed(Self::loose_param)?;
        Ok(DeclKind::ExternFunction(ExternFunction { result: Some(first), name, params }))
    }

    fn operator(&mut self) -> Parse<(String, lapwing_diag::Span)> {
        let known = crate::ast::BinaryOp::ALL.iter().any(|o| self.is(o.symbol())) || self.is_any(&["!", "~"]);
        if !known {
            return self.missing("an operator");
        }
        let found = (self.here(), self.span());
        self.advance();
        Ok(found)
    }

    /// A parameter that may have no name.
    fn loose_param(&mut self) -> Parse<Param> {
        let is_const = self.take("const");
        let ty = self.path("a type")?;
        let name = if self.kind() == TokenKind::Name { Some(self.name("a name")?) } else { None };
        Ok(Param { is_const, ty, name })
    }

    pub(super) fn params(&mut self) -> Parse<Vec<Param>> {
        self.bracketed(|p| {
            let is_const = p.take("const");
            let ty = p.path("a type")?;
            Ok(Param { is_const, ty, name: Some(p.name("the name of the parameter")?) })
        })
    }

    fn port_type(&mut self) -> Parse<PortType> {
        self.require("port")?;
        self.require("type")?;
        let name = self.name("the name of the type")?;
        Ok(PortType { name, params: self.params()? })
    }
}
