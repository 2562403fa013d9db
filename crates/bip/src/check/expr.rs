//! Expressions and their types.

use super::names::{Names, Symbol};
use super::{Check, Checker};
use crate::ast::{self, BinaryOp, ExprKind, Literal, UnaryOp};
use crate::code::{Bool, Call, Cmp, Expr, Float, Int, IntOp, Object};
use crate::value::{Type, Value};
use lapwing_diag::{Code, Diagnostic, Span};

impl Checker<'_> {
    /// An expression of any type.
    pub(super) fn expr(&mut self, names: &Names, expr: &ast::Expr) -> Check<Expr> {
        match &expr.kind {
            ExprKind::Literal(literal) => self.literal(literal, expr.span),
            ExprKind::Path(path) => self.variable(names, path),
            ExprKind::Call(name, args) => {
                let call = self.call(names, name, args, expr.span)?;
                self.called(call)
            }
            ExprKind::Unary(op, operand) => self.unary(names, *op, operand, expr.span),
            ExprKind::Binary(op, left, right) => self.binary(names, *op, left, right, expr.span),
        }
    }

    /// An expression that is to be used as a value of a type.
    pub(super) fn expr_as(&mut self, names: &Names, expr: &ast::Expr, ty: Type) -> Check<Expr> {
        let found = self.expr(names, expr)?;
        self.convert(found, ty, expr.span)
    }

    pub(super) fn bool(&mut self, names: &Names, expr: &ast::Expr) -> Check<Bool> {
        match self.expr_as(names, expr, Type::Bool)? {
            Expr::Bool(condition) => Ok(condition),
            _ => Err(super::Reported(())),
        }
    }

    fn convert(&mut self, expr: Expr, ty: Type, span: Span) -> Check<Expr> {
        let from = expr.ty();
        if from == ty {
            return Ok(expr);
        }
        if !self.fits(from, ty) {
            let message = format!("this is of type {}, and {} is expected here", self.shown(from), self.shown(ty));
            return self.fail(Code::BipType, span, message);
        }
        match expr {
            Expr::Int(inner) => Ok(Expr::Float(float_of(inner))),
            Expr::Object(_, inner) => Ok(Expr::Object(ty, inner)),
            other => Ok(other),
        }
    }

    fn literal(&mut self, literal: &Literal, span: Span) -> Check<Expr> {
        Ok(match literal {
            Literal::Bool(value) => Expr::Bool(Bool::Const(*value)),
            Literal::Int(value) => Expr::Int(Int::Const(*value)),
            Literal::Real(text) => match text.parse::<f64>() {
                Ok(value) if value.is_finite() => Expr::Float(Float::Const(value)),
                _ => return self.fail(Code::BadNumber, span, "this number is too large"),
            },
            Literal::Text(text) => Expr::Object(Type::Text, Object::Const(Value::Text(text.as_str().into()))),
        })
    }

    fn variable(&mut self, names: &Names, path: &ast::Path) -> Check<Expr> {
        let text = path.text();
        match names.get(&text) {
            Some(Symbol::Var { ty, slot, .. }) => Ok(Expr::var(ty, slot)),
            Some(Symbol::Clock { .. }) => {
                let message = format!("the clock `{text}` cannot be used as a value");
                let diagnostic = Diagnostic::new(Code::BipClock, path.span(), message);
                let help = "a clock is compared with a number in a guard, an invariant or `resume`, and set in `do`";
                Err(self.report(diagnostic.help(help)))
            }
            None => match self.scope.constant(&text) {
                Some(constant) => Ok(Expr::constant(constant.ty, &constant.value)),
                None => {
                    let known: Vec<String> = names.all().chain(self.scope.constants()).map(str::to_owned).collect();
                    self.unknown("variable", &text, path.span(), known.iter().map(String::as_str))
                }
            },
        }
    }

    /// A call, with its arguments converted to what the function takes.
    pub(super) fn call(&mut self, names: &Names, name: &ast::Name, args: &[ast::Expr], span: Span) -> Check<Call> {
        let candidates = self.scope.functions(&name.text).to_vec();
        if candidates.is_empty() {
            let known: Vec<String> = self.scope.function_names().map(str::to_owned).collect();
            return self.unknown("function", &name.text, name.span, known.iter().map(String::as_str));
        }
        let mut values = Vec::with_capacity(args.len());
        for arg in args {
            values.push(self.expr(names, arg)?);
        }
        let given: Vec<Type> = values.iter().map(Expr::ty).collect();
        let Some(function) = self.best(&candidates, &given) else {
            return self.no_such_call(&name.text, &candidates, &given, span);
        };
        self.bind_call(names, function, values, args, span)
    }

    /// The function of that name that takes such values: one that takes just these before one that they fit.
    fn best(&self, candidates: &[u32], given: &[Type]) -> Option<u32> {
        let params = |f: u32| self.library.functions.get(f as usize).map_or(&[][..], |s| s.params.as_slice());
        let exact = candidates.iter().find(|f| params(**f) == given);
        let fits = |f: &&u32| {
            let params = params(**f);
            params.len() == given.len() && given.iter().zip(params).all(|(from, to)| self.fits(*from, *to))
        };
        exact.or_else(|| candidates.iter().find(fits)).copied()
    }

    fn no_such_call<T>(&mut self, name: &str, candidates: &[u32], given: &[Type], span: Span) -> Check<T> {
        let list = |types: &[Type]| types.iter().map(|t| self.shown(*t)).collect::<Vec<_>>().join(", ");
        let message = format!("`{name}` does not take ({})", list(given));
        let mut diagnostic = Diagnostic::new(Code::BipArguments, span, message);
        for candidate in candidates.iter().take(4) {
            if let Some(signature) = self.library.functions.get(*candidate as usize) {
                let takes = format!("takes ({})", list(&signature.params));
                diagnostic = diagnostic.also(signature.span, takes);
            }
        }
        Err(self.report(diagnostic))
    }

    fn bind_call(
        &mut self,
        names: &Names,
        function: u32,
        values: Vec<Expr>,
        args: &[ast::Expr],
        span: Span,
    ) -> Check<Call> {
        let Some(signature) = self.library.functions.get(function as usize).cloned() else {
            return Err(super::Reported(()));
        };
        let mut call = Call { function, args: Vec::new(), places: Vec::new(), result: signature.result, span };
        let params = signature.params.iter().zip(&signature.is_const);
        for ((value, arg), (ty, is_const)) in values.into_iter().zip(args).zip(params) {
            // Only a variable of just that type can take what the function leaves in it.
            let writable = !is_const && value.ty() == *ty && self.is_writable(names, arg);
            call.places.push(value.slot().filter(|_| writable));
            call.args.push(self.convert(value, *ty, arg.span)?);
        }
        Ok(call)
    }

    fn called(&mut self, call: Call) -> Check<Expr> {
        match call.result {
            Some(Type::Bool) => Ok(Expr::Bool(Bool::Call(Box::new(call)))),
            Some(Type::Int) => Ok(Expr::Int(Int::Call(Box::new(call)))),
            Some(Type::Float) => Ok(Expr::Float(Float::Call(Box::new(call)))),
            Some(ty) => Ok(Expr::Object(ty, Object::Call(Box::new(call)))),
            None => self.fail(Code::BipType, call.span, "this function gives no value"),
        }
    }

    fn unary(&mut self, names: &Names, op: UnaryOp, operand: &ast::Expr, span: Span) -> Check<Expr> {
        let value = self.expr(names, operand)?;
        Ok(match (op, value) {
            (UnaryOp::Not, Expr::Bool(inner)) => Expr::Bool(Bool::Not(Box::new(inner))),
            (UnaryOp::Minus, Expr::Int(Int::Const(value))) if value != i64::MIN => Expr::Int(Int::Const(-value)),
            (UnaryOp::Minus, Expr::Int(inner)) => Expr::Int(Int::Minus(Box::new(inner), span)),
            (UnaryOp::Minus, Expr::Float(inner)) => Expr::Float(Float::Minus(Box::new(inner))),
            (UnaryOp::Plus, value @ (Expr::Int(_) | Expr::Float(_))) => value,
            (UnaryOp::Complement, Expr::Int(inner)) => Expr::Int(Int::Complement(Box::new(inner))),
            (_, value) => return self.operator(op.symbol(), vec![value], &[operand], span),
        })
    }

    fn binary(&mut self, names: &Names, op: BinaryOp, left: &ast::Expr, right: &ast::Expr, span: Span) -> Check<Expr> {
        let (a, b) = (self.expr(names, left), self.expr(names, right));
        let (a, b) = (a?, b?);
        if let Some(op) = arithmetic(op) {
            match (a, b) {
                (Expr::Int(a), Expr::Int(b)) => return Ok(Expr::Int(Int::Op(op, Box::new(a), Box::new(b), span))),
                (a, b) if is_number(&a) && is_number(&b) && !is_bitwise(op) => {
                    return Ok(Expr::Float(Float::Op(op, Box::new(float(a)), Box::new(float(b)))));
                }
                (a, b) => return self.operator(symbol(op), vec![a, b], &[left, right], span),
            }
        }
        if let Some(cmp) = comparison(op) {
            return self.compare(cmp, op, (a, b), [left, right], span);
        }
        match (op, a, b) {
            (BinaryOp::And, Expr::Bool(a), Expr::Bool(b)) => Ok(Expr::Bool(Bool::And(Box::new(a), Box::new(b)))),
            (BinaryOp::Or, Expr::Bool(a), Expr::Bool(b)) => Ok(Expr::Bool(Bool::Or(Box::new(a), Box::new(b)))),
            (_, a, b) => self.operator(op.symbol(), vec![a, b], &[left, right], span),
        }
    }

    fn compare(
        &mut self,
        cmp: Cmp,
        op: BinaryOp,
        operands: (Expr, Expr),
        trees: [&ast::Expr; 2],
        span: Span,
    ) -> Check<Expr> {
        let is_equality = matches!(cmp, Cmp::Equal | Cmp::NotEqual);
        let negated = |same: Bool| if cmp == Cmp::NotEqual { Bool::Not(Box::new(same)) } else { same };
        Ok(Expr::Bool(match operands {
            (Expr::Int(a), Expr::Int(b)) => Bool::Ints(cmp, Box::new(a), Box::new(b)),
            (a, b) if is_number(&a) && is_number(&b) => Bool::Floats(cmp, Box::new(float(a)), Box::new(float(b))),
            (Expr::Bool(a), Expr::Bool(b)) if is_equality => negated(Bool::Same(Box::new(a), Box::new(b))),
            (Expr::Object(Type::Text, a), Expr::Object(Type::Text, b)) if is_equality => {
                negated(Bool::Objects(Box::new(a), Box::new(b)))
            }
            (a, b) => return self.operator(op.symbol(), vec![a, b], &trees, span),
        }))
    }

    /// An operator that the surroundings provide for these types.
    fn operator(&mut self, sign: &str, values: Vec<Expr>, trees: &[&ast::Expr], span: Span) -> Check<Expr> {
        let given: Vec<Type> = values.iter().map(Expr::ty).collect();
        let candidates = self.scope.functions(sign).to_vec();
        let Some(function) = self.best(&candidates, &given) else {
            let types: Vec<&str> = given.iter().map(|t| self.shown(*t)).collect();
            let message = format!("`{sign}` cannot be applied to {}", types.join(" and "));
            return self.fail(Code::BipType, span, message);
        };
        let trees: Vec<ast::Expr> = trees.iter().map(|t| (*t).clone()).collect();
        let call = self.bind_call(&Names::default(), function, values, &trees, span)?;
        self.called(call)
    }
}

fn is_number(expr: &Expr) -> bool {
    matches!(expr, Expr::Int(_) | Expr::Float(_))
}

fn is_bitwise(op: IntOp) -> bool {
    matches!(op, IntOp::And | IntOp::Or | IntOp::Xor)
}

/// A number as a double; the caller knows that it is a number.
fn float(expr: Expr) -> Float {
    match expr {
        Expr::Int(inner) => float_of(inner),
        Expr::Float(inner) => inner,
        _ => Float::Const(f64::NAN),
    }
}

fn float_of(inner: Int) -> Float {
    match inner {
        Int::Const(value) => Float::Const(value as f64),
        other => Float::Of(Box::new(other)),
    }
}

fn arithmetic(op: BinaryOp) -> Option<IntOp> {
    Some(match op {
        BinaryOp::Add => IntOp::Add,
        BinaryOp::Subtract => IntOp::Subtract,
        BinaryOp::Multiply => IntOp::Multiply,
        BinaryOp::Divide => IntOp::Divide,
        BinaryOp::Remainder => IntOp::Remainder,
        BinaryOp::BitAnd => IntOp::And,
        BinaryOp::BitOr => IntOp::Or,
        BinaryOp::BitXor => IntOp::Xor,
        _ => return None,
    })
}

fn symbol(op: IntOp) -> &'static str {
    match op {
        IntOp::Add => "+",
        IntOp::Subtract => "-",
        IntOp::Multiply => "*",
        IntOp::Divide => "/",
        IntOp::Remainder => "%",
        IntOp::And => "&",
        IntOp::Or => "|",
        IntOp::Xor => "^",
    }
}

/// The comparison that an operator is.
pub(super) fn comparison(op: BinaryOp) -> Option<Cmp> {
    Some(match op {
        BinaryOp::Equal => Cmp::Equal,
        BinaryOp::NotEqual => Cmp::NotEqual,
        BinaryOp::Less => Cmp::Less,
        BinaryOp::LessEqual => Cmp::LessEqual,
        BinaryOp::Greater => Cmp::Greater,
        BinaryOp::GreaterEqual => Cmp::GreaterEqual,
        _ => return None,
    })
}
