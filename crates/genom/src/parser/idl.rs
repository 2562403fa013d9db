//! Types and constants: the interface definition language.

use lapwing_diag::{Code, Diagnostic};

use super::expr::joined;
use super::{Parser, Read, Unread};
use crate::ast::{Basic, Case, Decl, Declarator, Expr, Ident, Member, Type, TypeKind};

/// An array has no more dimensions: what looks into it goes one level deeper for each.
const MOST_DIMENSIONS: usize = 32;

impl Parser<'_> {
    /// Whether a declaration of a type or constant begins here.
    pub(super) fn begins_declaration(&self) -> bool {
        matches!(self.word(), "module" | "const" | "typedef" | "struct" | "union" | "enum")
    }

    /// A declaration, without its semicolon.
    pub(super) fn declaration(&mut self) -> Read<Decl> {
        match self.word() {
            "module" => {
                self.bump();
                let name = self.name("the name of the module")?;
                let inside = self.braced("module", |parser| {
                    let declaration = parser.declaration()?;
                    parser.semicolon()?;
                    Ok(declaration)
                })?;
                Ok(Decl::Module(name, inside))
            }
            "const" => {
                self.bump();
                let ty = self.ty()?;
                let name = self.name("the name of the constant")?;
                self.want("=", "before the value of the constant")?;
                Ok(Decl::Const(ty, name, self.expr()?))
            }
            "typedef" => {
                self.bump();
                let ty = self.ty()?;
                Ok(Decl::Typedef(ty, self.list(Parser::declarator)?))
            }
            "native" => {
                self.bump();
                Ok(Decl::Native(self.name("the name of the type")?))
            }
            "exception" => {
                self.bump();
                Ok(Decl::Exception(self.list(Parser::exception)?))
            }
            _ if self.begins_declaration() => Ok(Decl::Type(self.ty()?)),
            _ => Err(self.expected("a declaration")),
        }
    }

    fn exception(&mut self) -> Read<(Ident, Vec<Member>)> {
        let name = self.name("the name of the exception")?;
        let members = if self.is("{") { self.members("exception")? } else { Vec::new() };
        Ok((name, members))
    }

    /// `{ type a, b; … }`
    pub(super) fn members(&mut self, what: &str) -> Read<Vec<Member>> {
        self.braced(what, |parser| {
            let ty = parser.ty()?;
            let declarators = parser.list(Parser::declarator)?;
            parser.semicolon()?;
            Ok(Member { ty, declarators })
        })
    }

    /// A name with the lengths of its arrays.
    pub(super) fn declarator(&mut self) -> Read<Declarator> {
        let name = self.name("a name")?;
        let mut lengths = Vec::new();
        while self.is("[") {
            let bracket = self.bump();
            if lengths.len() >= MOST_DIMENSIONS {
                let message = format!("`{}` is an array of more than {MOST_DIMENSIONS} dimensions", name.name);
                let help = "put arrays into a structure, or give one a name by `typedef` and take that as elements";
                self.report(Diagnostic::new(Code::TooDeep, bracket.span, message).help(help));
                return Err(Unread);
            }
            lengths.push(self.expr()?);
            self.want("]", "after the length of the array")?;
        }
        Ok(Declarator { name, lengths })
    }

    /// A type.
    pub(super) fn ty(&mut self) -> Read<Type> {
        let start = self.peek().span;
        let kind = self.nested(start, Parser::type_kind)?;
        let end = self.tokens.get(self.at.saturating_sub(1)).map_or(start, |t| t.span);
        Ok(Type { kind, span: joined(start, end) })
    }

    fn type_kind(&mut self) -> Read<TypeKind> {
        if let Some(basic) = self.basic()? {
            return Ok(TypeKind::Basic(basic));
        }
        match self.word() {
            "string" | "wstring" => {
                self.bump();
                let length = self.angled(Parser::bound)?;
                Ok(TypeKind::Text(length.map(Box::new)))
            }
            "sequence" => {
                self.bump();
                self.want("<", "before the type of the elements")?;
                let element = self.ty()?;
                let length = if self.eat(",") { Some(Box::new(self.bound()?)) } else { None };
                self.close_angle()?;
                Ok(TypeKind::Sequence(Box::new(element), length))
            }
            "optional" => {
                self.bump();
                self.want("<", "before the type of what may be missing")?;
                let inside = self.ty()?;
                self.close_angle()?;
                Ok(TypeKind::Optional(Box::new(inside)))
            }
            "fixed" => {
                self.bump();
                let sizes = self.angled(|parser| {
                    let digits = parser.bound()?;
                    parser.want(",", "between the digits and the scale")?;
                    Ok((digits, parser.bound()?))
                })?;
                Ok(TypeKind::Fixed(sizes.map(Box::new)))
            }
            "struct" | "union" | "enum" => self.constructed(),
            _ if self.is("::") || !self.word().is_empty() => Ok(TypeKind::Named(self.scoped_name("a type")?)),
            _ => Err(self.expected("a type")),
        }
    }

    /// What stands between `<` and `>`, where they are there.
    fn angled<T>(&mut self, inside: impl FnOnce(&mut Self) -> Read<T>) -> Read<Option<T>> {
        if !self.eat("<") {
            return Ok(None);
        }
        let inside = inside(self)?;
        self.close_angle()?;
        Ok(Some(inside))
    }

    /// A length between angles, in which `>` and `>>` close and do not compare or shift.
    fn bound(&mut self) -> Read<Expr> {
        let place = self.peek().span;
        self.nested(place, |parser| parser.level(super::expr::SUM))
    }

    /// `>`. Of a `>>` the first half is taken, with a warning: GenoM3 itself reads it as one sign.
    fn close_angle(&mut self) -> Read<()> {
        if self.is(">>") {
            let token = self.peek().clone();
            let message = "GenoM3 reads `>>` as one sign here and refuses the file";
            self.report(Diagnostic::new(Code::UnusualSyntax, token.span, message).fix(token.span, "> >"));
            if let Some(next) = self.tokens.get_mut(self.at) {
                next.text = ">".into();
                next.span.start += 1;
            }
            return Ok(());
        }
        self.want(">", "after this type").map(drop)
    }

    /// A type without parts; `None` where none begins here.
    fn basic(&mut self) -> Read<Option<Basic>> {
        let basic = match self.word() {
            "boolean" => Basic::Boolean,
            "short" => Basic::Short,
            "float" => Basic::Float,
            "double" => Basic::Double,
            "char" => Basic::Char,
            "wchar" => Basic::WideChar,
            "octet" => Basic::Octet,
            "any" => Basic::Any,
            "long" => {
                self.bump();
                return Ok(Some(if self.eat_word("long") { Basic::LongLong } else { Basic::Long }));
            }
            "unsigned" => {
                self.bump();
                return match self.word() {
                    "short" => {
                        self.bump();
                        Ok(Some(Basic::UnsignedShort))
                    }
                    "long" => {
                        self.bump();
                        Ok(Some(if self.eat_word("long") { Basic::UnsignedLongLong } else { Basic::UnsignedLong }))
                    }
                    _ => Err(self.expected("`short` or `long`")),
                };
            }
            _ => return Ok(None),
        };
        self.bump();
        Ok(Some(basic))
    }

    fn constructed(&mut self) -> Read<TypeKind> {
        let word = self.bump().text.clone();
        let name = self.name("the name of the type")?;
        match &*word {
            "enum" => {
                self.want("{", "before the values of the enumeration")?;
                let mut values = Vec::new();
                while !self.is("}") {
                    values.push(self.name("the name of a value")?);
                    if !self.eat(",") {
                        break;
                    }
                }
                self.want("}", "after the values of the enumeration")?;
                Ok(TypeKind::Enum(name, values))
            }
            "union" if self.eat_word("switch") => {
                self.want("(", "before the type that chooses")?;
                let switch = self.ty()?;
                self.want(")", "after the type that chooses")?;
                let cases = self.braced("union", Parser::case)?;
                Ok(TypeKind::Union(name, Box::new(switch), cases))
            }
            "struct" if self.is("{") => Ok(TypeKind::Struct(name, self.members("structure")?)),
            _ => Ok(TypeKind::Forward(name, &*word == "union")),
        }
    }

    fn case(&mut self) -> Read<Case> {
        let mut labels = Vec::new();
        loop {
            if self.eat_word("case") {
                labels.push(Some(self.expr()?));
            } else if self.eat_word("default") {
                labels.push(None);
            } else if labels.is_empty() {
                return Err(self.expected("`case` or `default`"));
            } else {
                break;
            }
            self.want(":", "after the value of the case")?;
        }
        let ty = self.ty()?;
        let declarator = self.declarator()?;
        self.semicolon()?;
        Ok(Case { labels, ty, declarator })
    }
}
