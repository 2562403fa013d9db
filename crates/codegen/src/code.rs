//! The intermediate form: a small imperative language that both printers can say, and no more than that.
//!
//! There are no pointers, no strings, no recursion and no memory but the fields of the monitor, whose sizes are constants. Expressions have
//! no side effects, so that what is not read can be left out.

use std::ops::{Add, BitAnd, BitOr, Not, Sub};

/// The types of fields and variables.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
pub(crate) enum Ty {
    /// True or false.
    Bool,
    /// A small number: a state, a verdict.
    U8,
    /// An index, a length, the code of a text.
    U32,
    /// A count, a distance in nanoseconds.
    U64,
    /// A stamp in nanoseconds.
    I64,
    /// A number of the specification.
    F64,
}

/// Operators of two operands of one type.
#[derive(Clone, Copy, PartialEq, Eq, Debug)]
#[allow(missing_docs)]
pub(crate) enum Bin {
    Add,
    Sub,
    Mul,
    Div,
    Rem,
    And,
    Or,
    Eq,
    Ne,
    Lt,
    Le,
    Gt,
    Ge,
}

/// An expression.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Expr {
    Bool(bool),
    /// An integer, of the type that its place wants.
    Int(i64),
    Float(f64),
    Local(String),
    /// A field of the monitor.
    Field(String),
    /// An element of a field that is an array.
    Elem(String, Box<Expr>),
    /// A member of what comes with a step.
    Input(String),
    Not(Box<Expr>),
    Neg(Box<Expr>),
    Bin(Bin, Box<Expr>, Box<Expr>),
    /// `c ? a : b`
    Choose(Box<Expr>, Box<Expr>, Box<Expr>),
    /// A conversion to another type of numbers, exact or rounded to nearest.
    As(Ty, Box<Expr>),
    /// A function that stands in the prelude, or in the mathematical library.
    Call(Helper, Vec<Expr>),
    /// Whether a text, an element of an array, is one that is written down.
    Same(Box<Expr>, String),
}

/// Functions that both languages are given, each after those that it calls.
#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Debug)]
#[allow(missing_docs)]
pub(crate) enum Helper {
    /// The distance from the second stamp to the first, which is not the earlier.
    Since,
    /// A stamp, so many nanoseconds later; at most the end of time.
    Later,
    IsNan,
    Abs,
    Sign,
    Least,
    Greatest,
    Sqrt,
    Sin,
    Cos,
    Atan2,
    Asin,
    Acos,
    Fmod,
}

/// A statement.
#[derive(Clone, PartialEq, Debug)]
pub(crate) enum Stmt {
    Comment(String),
    /// A variable; `is_set` where a later statement sets it.
    Let {
        name: String,
        ty: Ty,
        value: Expr,
        is_set: bool,
    },
    Set(Expr, Expr),
    If(Expr, Vec<Stmt>, Vec<Stmt>),
    While(Expr, Vec<Stmt>),
    /// `name` from 0 up to what lies below the expression.
    For(String, Expr, Vec<Stmt>),
    /// By the value of an expression of [`Ty::U8`]; nothing happens for other values.
    Match(Expr, Vec<(u8, Vec<Stmt>)>),
    /// Sets every element of a field.
    Fill(String, Expr),
    /// Calls a function of the monitor.
    Do(String, Vec<Expr>),
    Return,
}

/// A field of the monitor.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Field {
    pub name: String,
    pub ty: Ty,
    /// `Some` for an array.
    pub len: Option<usize>,
    /// What it is, and every element of it, before anything has come.
    pub initial: Expr,
    /// Whether it survives a jump back in time.
    pub is_kept: bool,
    pub doc: String,
}

/// A function of the monitor.
#[derive(Clone, PartialEq, Debug)]
pub(crate) struct Function {
    pub name: String,
    pub doc: String,
    pub params: Vec<(String, Ty)>,
    pub takes_inputs: bool,
    pub body: Vec<Stmt>,
}

/// What both printers print.
#[derive(Clone, PartialEq, Debug, Default)]
pub(crate) struct Unit {
    pub fields: Vec<Field>,
    /// Each calls only those before it.
    pub functions: Vec<Function>,
}

impl Unit {
    /// Adds a field, and gives it.
    pub fn field(&mut self, name: &str, ty: Ty, initial: Expr, doc: &str) -> Expr {
        self.add(name, ty, None, initial, false, doc);
        Expr::Field(name.to_owned())
    }

    /// Adds an array.
    pub fn array(&mut self, name: &str, ty: Ty, len: usize, initial: Expr, doc: &str) {
        self.add(name, ty, Some(len), initial, false, doc);
    }

    /// Adds a field of any kind, unless there is one of that name.
    pub fn add(&mut self, name: &str, ty: Ty, len: Option<usize>, initial: Expr, is_kept: bool, doc: &str) {
        let (name, doc) = (name.to_owned(), doc.to_owned());
        if self.fields.iter().any(|f| f.name == name) {
            return;
        }
        self.fields.push(Field { name, ty, len, initial, is_kept, doc });
    }

    /// Adds a function, unless it would do nothing. Gives whether it was added.
    pub fn function(&mut self, name: &str, doc: &str, params: &[(&str, Ty)], body: Block) -> bool {
        let body = super::prune::prune(super::fold::fold(body.0));
        let does = body.iter().any(|s| !matches!(s, Stmt::Comment(_)));
        if does {
            let params = params.iter().map(|(n, ty)| (n.to_string(), *ty)).collect();
            let takes_inputs = super::prune::reads_inputs(&body);
            self.functions.push(Function { name: name.to_owned(), doc: doc.to_owned(), params, takes_inputs, body });
        }
        does
    }
}

/// Statements, as they are written down.
#[derive(Clone, Debug, Default)]
pub(crate) struct Block(pub Vec<Stmt>);

impl Block {
    pub fn of(write: impl FnOnce(&mut Block)) -> Block {
        let mut block = Block::default();
        write(&mut block);
        block
    }

    pub fn comment(&mut self, text: impl Into<String>) {
        self.0.push(Stmt::Comment(text.into()));
    }

    /// A variable that nothing sets later.
    pub fn bind(&mut self, name: impl Into<String>, ty: Ty, value: Expr) -> Expr {
        self.declare(name.into(), ty, value, false)
    }

    /// A variable that later statements set.
    pub fn var(&mut self, name: impl Into<String>, ty: Ty, value: Expr) -> Expr {
        self.declare(name.into(), ty, value, true)
    }

    fn declare(&mut self, name: String, ty: Ty, value: Expr, is_set: bool) -> Expr {
        self.0.push(Stmt::Let { name: name.clone(), ty, value, is_set });
        Expr::Local(name)
    }

    pub fn set(&mut self, place: &Expr, value: impl Into<Expr>) {
        self.0.push(Stmt::Set(place.clone(), value.into()));
    }

    pub fn add(&mut self, place: &Expr, value: impl Into<Expr>) {
        self.set(place, place.clone() + value.into());
    }

    pub fn when(&mut self, condition: Expr, then: impl FnOnce(&mut Block)) {
        self.branch(condition, then, |_| ());
    }

    /// Two ways; what cannot happen is left out.
    pub fn branch(&mut self, condition: Expr, then: impl FnOnce(&mut Block), other: impl FnOnce(&mut Block)) {
        let (then, other) = (Block::of(then).0, Block::of(other).0);
        match condition {
            Expr::Bool(true) => self.0.extend(then),
            Expr::Bool(false) => self.0.extend(other),
            _ if then.is_empty() && other.is_empty() => {}
            _ if then.is_empty() => self.0.push(Stmt::If(!condition, other, then)),
            _ => self.0.push(Stmt::If(condition, then, other)),
        }
    }

    pub fn repeat(&mut self, condition: Expr, body: impl FnOnce(&mut Block)) {
        self.0.push(Stmt::While(condition, Block::of(body).0));
    }

    pub fn each(&mut self, name: &str, below: Expr, body: impl FnOnce(&mut Block)) {
        self.0.push(Stmt::For(name.to_owned(), below, Block::of(body).0));
    }

    pub fn call(&mut self, name: impl Into<String>, args: Vec<Expr>) {
        self.0.push(Stmt::Do(name.into(), args));
    }

    pub fn leave(&mut self) {
        self.0.push(Stmt::Return);
    }
}

pub(crate) fn field(name: impl Into<String>) -> Expr {
    Expr::Field(name.into())
}

pub(crate) fn elem(name: impl Into<String>, at: Expr) -> Expr {
    Expr::Elem(name.into(), Box::new(at))
}

pub(crate) fn local(name: impl Into<String>) -> Expr {
    Expr::Local(name.into())
}

pub(crate) fn call(helper: Helper, args: Vec<Expr>) -> Expr {
    Expr::Call(helper, args)
}

/// The distance between two stamps.
pub(crate) fn since(now: &Expr, stamp: &Expr) -> Expr {
    call(Helper::Since, vec![now.clone(), stamp.clone()])
}

impl Expr {
    pub fn bin(self, op: Bin, other: impl Into<Expr>) -> Expr {
        Expr::Bin(op, Box::new(self), Box::new(other.into()))
    }

    pub fn eq(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Eq, other)
    }

    pub fn ne(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Ne, other)
    }

    pub fn lt(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Lt, other)
    }

    pub fn le(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Le, other)
    }

    pub fn gt(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Gt, other)
    }

    pub fn ge(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Ge, other)
    }

    pub fn mul(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Mul, other)
    }

    pub fn div(self, other: impl Into<Expr>) -> Expr {
        self.bin(Bin::Div, other)
    }

    /// Two truth values are the same.
    pub fn same(self, other: Expr) -> Expr {
        match (self, other) {
            (Expr::Bool(b), e) | (e, Expr::Bool(b)) => {
                if b {
                    e
                } else {
                    !e
                }
            }
            (a, b) => a.eq(b),
        }
    }

    pub fn choose(self, then: Expr, other: Expr) -> Expr {
        match (self, then, other) {
            (Expr::Bool(c), then, other) => {
                if c {
                    then
                } else {
                    other
                }
            }
            (c, Expr::Bool(true), other) => c | other,
            (c, Expr::Bool(false), other) => !c & other,
            (c, then, Expr::Bool(true)) => !c | then,
            (c, then, Expr::Bool(false)) => c & then,
            (c, then, other) => Expr::Choose(Box::new(c), Box::new(then), Box::new(other)),
        }
    }

    pub fn cast(self, ty: Ty) -> Expr {
        Expr::As(ty, Box::new(self))
    }
}

impl From<bool> for Expr {
    fn from(b: bool) -> Expr {
        Expr::Bool(b)
    }
}

impl From<i64> for Expr {
    fn from(i: i64) -> Expr {
        Expr::Int(i)
    }
}

impl From<f64> for Expr {
    fn from(x: f64) -> Expr {
        Expr::Float(x)
    }
}

impl From<&Expr> for Expr {
    fn from(e: &Expr) -> Expr {
        e.clone()
    }
}

impl Not for Expr {
    type Output = Expr;
    fn not(self) -> Expr {
        match self {
            Expr::Bool(b) => Expr::Bool(!b),
            Expr::Not(e) => *e,
            e => Expr::Not(Box::new(e)),
        }
    }
}

/// `and`, which evaluates both sides or one: nothing here has side effects.
impl BitAnd for Expr {
    type Output = Expr;
    fn bitand(self, other: Expr) -> Expr {
        match (self, other) {
            (Expr::Bool(true), e) | (e, Expr::Bool(true)) => e,
            (Expr::Bool(false), _) | (_, Expr::Bool(false)) => Expr::Bool(false),
            (a, b) if a == b => a,
            (a, b) => a.bin(Bin::And, b),
        }
    }
}

impl BitOr for Expr {
    type Output = Expr;
    fn bitor(self, other: Expr) -> Expr {
        match (self, other) {
            (Expr::Bool(false), e) | (e, Expr::Bool(false)) => e,
            (Expr::Bool(true), _) | (_, Expr::Bool(true)) => Expr::Bool(true),
            (a, b) if a == b => a,
            (a, b) => a.bin(Bin::Or, b),
        }
    }
}

impl Add for Expr {
    type Output = Expr;
    fn add(self, other: Expr) -> Expr {
        self.bin(Bin::Add, other)
    }
}

impl Sub for Expr {
    type Output = Expr;
    fn sub(self, other: Expr) -> Expr {
        self.bin(Bin::Sub, other)
    }
}
