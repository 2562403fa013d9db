use lapwing_check::checked::*;
use xtask::exhaustive::*;
fn main() {
    let e = |k| Expr { kind: k, ty: lapwing_stream::Type::Bool, dim: Dim::default(), span: Default::default() };
    let f = e(Kind::Scope(Scope::While, Box::new(q()), Box::new(e(Kind::Scope(Scope::After, Box::new(p()), Box::new(q()))))));
    let s = spec(f);
    let program = lapwing_check::compile::compile(&s);
    println!("{:#?}", program.groups[0].looks);
    println!("{:?}", program.groups[0].contexts);
    println!("{:?}", program.groups[0].at.nodes);
}
