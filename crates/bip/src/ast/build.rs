//! Short ways to build trees, for programs that write BIP.

use super::{BinaryOp, Decl, DeclKind, Expr, ExprKind, Literal, Name, Path, PortExpr, PortExprKind, Resume, Stmt};
use super::{StmtKind, UnaryOp};
use lapwing_diag::Span;

impl From<&str> for Name {
    fn from(text: &str) -> Name {
        Name { text: text.to_owned(), span: Span::default() }
    }
}

impl From<String> for Name {
    fn from(text: String) -> Name {
        Name { text, span: Span::default() }
    }
}

impl From<&str> for Path {
    /// The names between the dots.
    fn from(text: &str) -> Path {
        Path { parts: text.split('.').map(Name::from).collect() }
    }
}

impl From<String> for Path {
    fn from(text: String) -> Path {
        Path::from(text.as_str())
    }
}

impl From<Name> for Path {
    fn from(name: Name) -> Path {
        Path { parts: vec![name] }
    }
}

impl From<ExprKind> for Expr {
    fn from(kind: ExprKind) -> Expr {
        Expr { kind, span: Span::default() }
    }
}

impl From<StmtKind> for Stmt {
    fn from(kind: StmtKind) -> Stmt {
        Stmt { kind, span: Span::default() }
    }
}

impl From<DeclKind> for Decl {
    fn from(kind: DeclKind) -> Decl {
        Decl { notes: Vec::new(), annotations: Vec::new(), kind, span: Span::default() }
    }
}

impl From<Expr> for Resume {
    fn from(guard: Expr) -> Resume {
        Resume { guard: Some(guard), span: Span::default() }
    }
}

impl PortExpr {
    /// A port that others must join.
    pub fn synchron(port: impl Into<Name>) -> PortExpr {
        PortExpr { kind: PortExprKind::Port(port.into()), is_trigger: false }
    }

    /// A port that needs nobody.
    pub fn trigger(port: impl Into<Name>) -> PortExpr {
        PortExpr { kind: PortExprKind::Port(port.into()), is_trigger: true }
    }
}

impl Expr {
    /// A whole number.
    pub fn int(value: i64) -> Expr {
        ExprKind::Literal(Literal::Int(value)).into()
    }

    /// A number as written, with a point: `1.5`.
    pub fn real(text: impl Into<String>) -> Expr {
        ExprKind::Literal(Literal::Real(text.into())).into()
    }

    /// `true` or `false`.
    pub fn bool(value: bool) -> Expr {
        ExprKind::Literal(Literal::Bool(value)).into()
    }

    /// A text.
    pub fn text(text: impl Into<String>) -> Expr {
        ExprKind::Literal(Literal::Text(text.into())).into()
    }

    /// A variable: `x`, `p.x`.
    pub fn path(path: impl Into<Path>) -> Expr {
        ExprKind::Path(path.into()).into()
    }

    /// A call of a function.
    pub fn call(function: impl Into<Name>, args: Vec<Expr>) -> Expr {
        ExprKind::Call(function.into(), args).into()
    }

    /// An operator between two.
    pub fn binary(op: BinaryOp, left: Expr, right: Expr) -> Expr {
        ExprKind::Binary(op, Box::new(left), Box::new(right)).into()
    }

    /// An operator before one.
    pub fn unary(op: UnaryOp, operand: Expr) -> Expr {
        ExprKind::Unary(op, Box::new(operand)).into()
    }

    /// All of them at once; `None` of none.
    pub fn all(parts: impl IntoIterator<Item = Expr>) -> Option<Expr> {
        parts.into_iter().reduce(|left, right| Expr::binary(BinaryOp::And, left, right))
    }
}

impl Stmt {
    /// `x = value;`
    pub fn assign(target: impl Into<Path>, value: Expr) -> Stmt {
        StmtKind::Assign(target.into(), value).into()
    }

    /// `f(args);`
    pub fn call(function: impl Into<Name>, args: Vec<Expr>) -> Stmt {
        StmtKind::Call(function.into(), args).into()
    }

    /// `if (condition) then … else … fi`
    pub fn choice(condition: Expr, then: Vec<Stmt>, otherwise: Vec<Stmt>) -> Stmt {
        StmtKind::If(condition, then, otherwise).into()
    }
}
