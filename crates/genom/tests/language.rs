//! What specifications mean: the whole language, in specifications in which nothing is wrong.

mod common;

use common::{codes, files, only, sound, text};
use lapwing_genom::Options;
use lapwing_genom::model::{Direction, Object, Step, Target, Type, TypeDefKind, Value};

#[test]
fn the_preprocessor_is_that_of_c() {
    let main = "#define TWICE(x) ((x) + (x))\n#define NAME(a, b) a ## b\n#define TEXT(x) #x\n#if defined(FAST) && FAST > 1\n\
                const long NAME(sp, eed) = TWICE(FAST);\n#else\nconst long speed = 0;\n#endif\nconst string t = TEXT(a b);\n\
                #include \"sub/one.idl\"\ncomponent c { version \"1\"; task t { period speed ms; delay two us; }; };\n";
    let all = [
        ("main.gen", main),
        ("sub/one.idl", "#include \"two.idl\"\n#include \"two.idl\"\n"),
        ("inc/two.idl", "#pragma once\nconst long two = 2;\n"),
    ];
    let options = Options { folders: vec!["inc".into()], defines: vec!["FAST=4".to_owned()], ..Options::default() };
    let loaded = files(&all, &options);
    assert_eq!(codes(&loaded), [""; 0]);
    let task = &only(&loaded).tasks[0];
    assert_eq!((task.period_ns, task.delay_ns), (Some(8_000_000), Some(2_000)));
    // What a macro put there is where the macro is named.
    let wrong = text("#define BAD port in nothing p;\ncomponent c {\n  BAD\n};\n");
    assert_eq!(codes(&wrong), ["unknown-name: BAD"]);
    assert_eq!(wrong.sources.position(wrong.diagnostics[0].primary.span), (3, 3));
    // Marks of another preprocessor name the file and the line.
    let marked = text("# 1 \"real.gen\"\ncomponent c {\n# 20 \"inner.gen\" 1\n  port in nothing p;\n};\n");
    let span = marked.diagnostics[0].primary.span;
    assert_eq!((marked.sources.name(span.file), marked.sources.position(span).0), ("inner.gen", 20));
}

#[test]
fn words_are_names_where_names_stand() {
    let loaded = sound(
        "struct task { long port; }; struct state { task ids; };
         component local { ids { task task; state state; long period, in, out; };
           task codel { period 10 ms; codel<start> yield(ids in task::port, ids out out, ids in in) yield pause::wcet, ether; codel<wcet> pause() yield ether wcet 1ms; };
           port in state s; activity ms(in long component, in task version) { task codel; codel<start> k(in component, in version) yield ether wcet 5us; }; };",
    );
    let component = only(&loaded);
    assert_eq!(component.codels.iter().map(|c| c.wcet_ns).collect::<Vec<_>>(), [None, Some(1_000_000), Some(5_000)]);
    let found = &component.codels[0];
    assert_eq!(found.parameters[0].name, "port");
    assert!(
        matches!(found.yields()[0].to, Target::Codel(_))
            && found.yields()[0].pause
            && found.yields()[1].to == Target::Ether
    );
}

#[test]
fn types() {
    let loaded = sound(
        "module m { enum e { one, two }; const unsigned short n = 2 * (1 << 3) | 1; typedef sequence<string<28>, n> names; };
         union u switch(m::e) { case one: case m::two: short a[2]; default: struct inner { m::e v; } b; };
         struct forward; typedef sequence<forward> many; struct forward { optional<u> x; fixed<3, 1> y; unsigned long long z; };",
    );
    let ty = |name: &str| &loaded.model.types.iter().find(|t| t.name() == name).unwrap().kind;
    let TypeDefKind::Alias(Type::Sequence(element, Some(17))) = ty("m::names") else { panic!("{:?}", ty("m::names")) };
    assert_eq!(**element, Type::Text(Some(28)));
    let TypeDefKind::Union(_, branches) = ty("u") else { panic!("{:?}", ty("u")) };
    assert_eq!((branches.len(), branches[0].0.len()), (2, 2));
    assert!(matches!(ty("u::inner"), TypeDefKind::Struct(fields) if fields.len() == 1));
    assert!(matches!(ty("forward"), TypeDefKind::Struct(fields) if fields.len() == 3));
}

#[test]
fn interfaces_are_provided_used_and_extended() {
    let loaded = sound(
        "#pragma require \"idl >= 1\"
         interface base { struct s { long m; }; exception e; ids { s kept; }; port in s request; };
         interface more { extends base; port out base::s answer; function Ask(in base::s what) { throw e; }; };
         component server { provides more; function Ask(in base::s what) { codel ask(in what, out kept); };
           task t { period 1 s; codel<start> work(in request, out answer) yield ether; }; };
         component client { uses more; task t { period 1 s; codel<start> work(out request, in answer, in Ask) yield ether; }; };",
    );
    let [server, client] = loaded.model.components.as_slice() else { panic!("{}", loaded.model.components.len()) };
    assert_eq!(server.requires, ["idl >= 1"]);
    let ports =
        |c: &lapwing_genom::model::Component| c.ports.iter().map(|p| (p.name.clone(), p.is_out)).collect::<Vec<_>>();
    assert_eq!(ports(server), [("request".to_owned(), false), ("answer".to_owned(), true)]);
    assert_eq!(ports(client), [("request".to_owned(), true), ("answer".to_owned(), false)]);
    assert_eq!(server.services[0].codels.len(), 1);
    assert_eq!(client.remotes[0].name, "Ask");
    assert_eq!(client.codels[0].parameters[2].object, Object::Remote(0));
    assert_eq!(loaded.model.links.len(), 2, "{:?}", loaded.model.links);
}

#[test]
fn the_types_of_an_interface_are_those_of_who_extends_it() {
    let loaded = sound(
        "interface base { struct s { long m; }; exception e; };
         interface more { extends base; port out s answer; };
         component server { provides more; ids { s kept; }; function Ask(in s what) { throw e; codel ask(in what, out kept); }; };
         component client { uses more; function Tell(in s what) { throw e; }; };",
    );
    let asked: Vec<_> = loaded.model.components.iter().map(|c| c.services[0].parameters[0].ty.clone()).collect();
    assert_eq!(asked[0], asked[1]);
}

#[test]
fn parts_and_defaults() {
    let loaded = sound(
        "component c { ids { struct s { double x; long n[4]; } a; };
           attribute Set(in a.x = 1.5 : \"how much\", inout a.n[2]::second);
           function F(in c::ids all = { { .n = { [1] = 7, 8 }, .x = -1 } }, in string t = \"a\" \"b\") { codel f(in all.a.n[3]::last, ids out a.x) ; }; };",
    );
    let component = only(&loaded);
    let set = &component.services[0];
    assert_eq!(set.parameters[0].default, Some(Value::Float(1.5)));
    assert_eq!(set.parameters[1].name, "second");
    // What a client writes is written to the internal data.
    assert_eq!(component.codels[0].parameters[0].direction, Direction::Out);
    assert_eq!(
        component.codels[0].parameters[1].object,
        Object::Ids(vec![Step::Member("a".into()), Step::Member("n".into()), Step::Element(2)])
    );
    let Some(Value::Parts(parts)) = &component.services[1].parameters[0].default else { panic!("no parts") };
    let Value::Parts(inner) = &parts[0].1 else { panic!("{parts:?}") };
    let elements = Value::Parts(vec![(Step::Element(1), Value::Int(7)), (Step::Element(2), Value::Int(8))]);
    assert_eq!(inner, &[(Step::Member("n".into()), elements), (Step::Member("x".into()), Value::Int(-1))]);
    assert_eq!(component.services[1].parameters[1].default, Some(Value::Text("ab".into())));
    let path = vec![Step::Member("a".into()), Step::Member("n".into()), Step::Element(3)];
    assert_eq!(component.codels[1].parameters[0].object, Object::Local("all".into(), path));
}

#[test]
fn components_are_opened_again() {
    let loaded = sound(
        "component c { version \"2\"; doc \"one\"; ids { long a; }; task t { period 10 ms; }; activity A() { task t; doc \"first\"; }; };
         component c { doc \"two\"; ids { long b; }; task t { priority 3; stack 2k; scheduling real-time; delay 5 ms; };
           activity A() { codel<start> f(in a, out b) yield ether; doc \"second\"; }; };",
    );
    let component = only(&loaded);
    assert_eq!(
        (component.doc.as_str(), component.lang.as_str(), component.clock_ns),
        ("one\ntwo", "c", Some(5_000_000))
    );
    let task = &component.tasks[0];
    assert_eq!(
        (task.period_ns, task.priority, task.stack, task.real_time),
        (Some(10_000_000), Some(3), Some(2048), true)
    );
    assert_eq!((component.services[0].doc.as_str(), component.services[0].codels.len()), ("first\nsecond", 1));
}

/// The eight components of the example: nothing is wrong with them, and each port finds its writer.
#[test]
fn the_navigation_example() {
    let root = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../../examples/navigation/robot_navigation.gen");
    let loaded = lapwing_genom::load(&lapwing_genom::Disk, &[root], &Options::default()).unwrap();
    assert_eq!(codes(&loaded), [""; 0]);
    let names: Vec<&str> = loaded.model.components.iter().map(|c| c.name.as_str()).collect();
    assert_eq!(
        names,
        ["LaserDriver", "GPSDriver", "IMUDriver", "RobotDriver", "POM", "Navigation", "PotentialField", "SafetyPilot"]
    );
    let readers = loaded.model.components.iter().flat_map(|c| &c.ports).filter(|p| !p.is_out).count();
    assert_eq!((readers, loaded.model.links.len()), (10, 10));
    let system = lapwing_genom::automata::build(&loaded.model, lapwing_genom::automata::Settings::default()).unwrap();
    let input = lapwing_genom::emit::Input { system: &system, sources: &loaded.sources };
    let lines = lapwing_bip::print(&lapwing_genom::emit::bip(input)).lines().count();
    assert!(lines > 13_000, "{lines}");
}
