//! GenoM3 specifications, requests of components and answers of their codels, of any bytes.

use std::collections::BTreeMap;
use std::path::PathBuf;
use std::sync::{Arc, LazyLock};

use lapwing_codels::{frames, read_answer, write_call};
use lapwing_components::codel::{Argument, Held};
use lapwing_components::{Call, Codels, Run, Setup, Types, request};
use lapwing_diag::{Style, render};
use lapwing_genom::automata::{Settings, build};
use lapwing_genom::emit::{Input, bip, uppaal};
use lapwing_genom::model::{Direction, Type};
use lapwing_genom::{Model, Options, graph, load};
use lapwing_stream::{Duration, Time};

/// Components whose services take values of every kind.
const COMPONENTS: &str = "
enum mode { FAST, SLOW };
native handle;
typedef string line;
struct point { double x, y; };
struct nothing { };
struct all {
  boolean b; char c; octet o; short s; unsigned short us; long l; unsigned long ul; long long ll; unsigned long long ull; float f; double d;
  string t; string<4> few; mode m; point p; sequence<point> ps; sequence<double, 3> some; optional<long> maybe; long grid[2][3]; nothing none;
  sequence<nothing> nones; nothing many[1000];
};
union one switch (mode) { case FAST: double speed; default: string why; };
struct chain { long n; sequence<chain> rest; };
component C {
  ids { all a; one u; handle h; chain links; };
  port in point Where;
  port out all Told;
  port multiple out line Names;
  task t { period 10 ms; };
  attribute Set(in u);
  attribute Get(out a);
  function F(in all a, in one u, in chain links, out point p) { validate V(local in u); codel G(local in a::given, ids inout a); };
  activity A(in all a = { .m = SLOW, .p = { .x = 1 } }, in long n = 3) {
    task t;
    codel<start> S(ids inout a, ids inout u, ids inout h, ids out links, port in Where, port out Told, port out Names) yield pause::start, ether wcet 1 ms;
    codel<stop> E() yield ether;
    interrupts A;
  };
};
";

static MODEL: LazyLock<(Arc<Model>, Types)> = LazyLock::new(|| {
    let files = BTreeMap::from([(PathBuf::from("a.gen"), COMPONENTS.to_owned())]);
    let loaded = load(&files, &[PathBuf::from("a.gen")], &Options::default()).expect("the file is there");
    assert!(!loaded.has_errors(), "{:?}", loaded.diagnostics);
    let types = Types::new(&loaded.model).expect("values of a fair size");
    (Arc::new(loaded.model), types)
});

/// Lines of requests: what is wrong has a place in the text, and what is right is made, and comes to an end.
pub(super) fn requests(data: &[u8]) {
    let (model, types) = &*MODEL;
    let lines: Vec<(usize, Result<String, request::RequestError>)> = request::Lines::new(data).collect();
    let mut run = Run::new(
        model.clone(),
        Setup { duration: Some(Duration::from_nanos(50_000_000)), ..Setup::default() },
        Codels::new(),
    )
    .expect("components of a fair size");
    for (number, line) in lines {
        let Ok(text) = line else { continue };
        match request::timed(model, types, &text, number) {
            Ok(Some((time, request))) => run.schedule(time, request),
            Ok(None) => {}
            Err(error) => {
                assert_eq!(error.line, number);
                assert!(error.column >= 1 && error.column <= text.chars().count() + 1, "{error} in {text:?}");
            }
        }
    }
    let mut before = Time(0);
    while let Some(happening) = run.advance() {
        assert!(happening.time >= before, "time goes back");
        before = happening.time;
    }
}

/// What a process with codels says: frames, and answers in them. One that is understood is the same when it is given back.
pub(super) fn wire(data: &[u8]) {
    let (mut rest, mut length) = (data, 0);
    for frame in frames(&mut rest) {
        length += frame.len();
        answer(&frame);
    }
    assert!(length <= data.len(), "there is more in the frames than has come");
    answer(data);
}

fn answer(bytes: &[u8]) {
    let mut call = call();
    if read_answer(&mut call, bytes).is_err() {
        return;
    }
    let mut once = Vec::new();
    write_call(&call, &mut once).expect("what codels have answered they can be given");
    assert!(call.arguments.iter().all(|a| a.direction != Direction::In), "{call:?}");
}

/// A call with all internal data of the component and its ports.
fn call() -> Call {
    let (model, types) = &*MODEL;
    let component = &model.components[0];
    let argument = |name: &str, ty: Type, value: Held| Argument {
        name: name.into(),
        direction: Direction::InOut,
        ty: Arc::new(ty),
        value,
    };
    let ids = Type::Named(component.ids.expect("internal data"));
    let mut arguments = vec![argument("ids", ids.clone(), Held::Data(types.initial(&ids)))];
    for port in component.ports.iter().filter(|p| p.is_out) {
        let value = match port.multiple {
            true => Held::Ports { content: BTreeMap::new(), written: Vec::new() },
            false => Held::Port { content: None, written: Vec::new() },
        };
        arguments.push(argument(&port.name, port.ty.clone(), value));
    }
    Call::new("C".into(), "S".into(), Time(0), arguments, types.clone())
}

/// A specification, which may include itself: what is wrong with it can be shown, and what is right is written in every way, and read back.
pub(super) fn gen_file(data: &[u8]) {
    let text = String::from_utf8_lossy(data).into_owned();
    let files = BTreeMap::from([(PathBuf::from("a.gen"), text)]);
    let Ok(loaded) = load(&files, &[PathBuf::from("a.gen")], &Options::default()) else { panic!("the file is there") };
    for diagnostic in &loaded.diagnostics {
        assert!(!render(&loaded.sources, diagnostic, Style::Plain).is_empty());
    }
    assert!(graph::graphs(&loaded.model).len() > loaded.model.components.len());
    let Ok(system) = build(&loaded.model, Settings { instances: 1, ..Settings::default() }) else { return };
    let locations: usize = system.automata.iter().map(|a| a.locations.len()).sum();
    if loaded.has_errors() || system.automata.is_empty() || locations > 400 {
        return;
    }
    let input = Input { system: &system, sources: &loaded.sources };
    assert!(uppaal(input).ends_with("</nta>\n"));
    let text = lapwing_bip::print(&bip(input));
    let parsed = lapwing_bip::parse(lapwing_bip::FileId(0), &text);
    assert!(parsed.diagnostics.is_empty(), "{:?}\n{text}", parsed.diagnostics);
    let checked = lapwing_bip::check(&parsed.package, &[]);
    assert!(checked.diagnostics.is_empty(), "{:?}\n{text}", checked.diagnostics);
}
