//! Which codels exclude each other.

mod common;

use common::{IMU, only, sound};
use lapwing_genom::model::{Component, Role};
use lapwing_genom::mutex::{Mutex, Rules, conflicts};

/// `a x b`, for each codel and what it waits for, by the names of their functions.
fn pairs(component: &Component, wants: impl Fn(&Role) -> bool) -> Vec<String> {
    let name = |id: lapwing_genom::model::CodelId| component.codels[id.0].function.as_str();
    let of = |id| {
        conflicts(component, id, Rules::default())
            .into_iter()
            .map(move |other| format!("{} x {}", name(id), name(other)))
    };
    component.codels().filter(|(_, c)| wants(&c.role)).flat_map(|(id, _)| of(id)).collect()
}

/// The vector of GenoM3's own tests.
#[test]
fn as_genom_has_it() {
    let loaded = sound(
        "component c { ids { long a, b; }; attribute set_a(in a); attribute get_a(out a);
           function f1() { codel c1(in a, out b); }; function f2() { codel c2(in b, out a); };
           task t { codel<start> c3(in a) yield main; codel<main> c4(in b) yield stop; codel<stop> c5() yield ether; };
           activity a1() { task t; codel<start> c6(in a, out b) yield main; codel<main> c7(in b, out a) yield ether; }; };",
    );
    let component = only(&loaded);
    let mut codels = pairs(component, |role| *role != Role::Attribute);
    codels.sort();
    let mut expected: Vec<String> =
        "c1 x c4,c1 x c6,c1 x c7,c2 x c3,c2 x c6,c2 x c7,c3 x set_a,c3 x c2,c4 x c1,c6 x set_a,c6 x c1,c6 x c2,\
                                     c7 x set_a,c7 x get_a,c7 x c1,c7 x c2"
            .split(',')
            .map(str::to_owned)
            .collect();
    expected.sort();
    assert_eq!(codels, expected);
    assert_eq!(
        pairs(component, |role| *role == Role::Attribute),
        ["set_a x c3", "set_a x c6", "set_a x c7", "get_a x c7"]
    );
}

/// One function that is the codel of a function, of a task and of an activity: three codels.
#[test]
fn one_function_in_several_places() {
    let loaded = sound(
        "component c { ids { long a; }; function t() { codel c(out a); }; task t { codel<start> c(out a) yield ether; };
           activity a() { task t; codel<start> c(out a) yield ether; }; };",
    );
    let component = only(&loaded);
    let lists: Vec<Vec<usize>> = component
        .codels()
        .map(|(id, _)| conflicts(component, id, Rules::default()).iter().map(|c| c.0).collect())
        .collect();
    // The task's, the function's, the activity's.
    assert_eq!(lists, [vec![1], vec![0, 2], vec![1]]);
}

#[test]
fn parts_of_internal_data() {
    let loaded = sound(
        "component c { ids { struct s { long x, y; } a, b[3]; };
           task t { period 1 s; codel<start> whole(out ::all) yield one; codel<one> part(out a.x) yield two; codel<two> elem(out b[1]) yield ether; };
           task u { period 1 s; codel<start> other(in a.y) yield same; codel<same> read(in a) yield more; codel<more> cell(in b[2], in b[1].x::z) yield ether; }; };",
    );
    let found = pairs(only(&loaded), |_| true);
    let expected = [
        "whole x other",
        "whole x read",
        "whole x cell",
        "part x read",
        "elem x cell",
        "other x whole",
        "read x whole",
        "read x part",
        "cell x whole",
        "cell x elem",
    ];
    assert_eq!(found, expected);
}

#[test]
fn ports_exclude_even_readers_and_interruption_goes_one_way() {
    let text = "struct s { long m; }; component c { port in s p; task t { period 1 s; }; task u { period 1 s; };
           activity A() { task t; codel<start> f(in p) yield ether; };
           activity B() { task u; codel<start> g(in p) yield ether; X }; };";
    let both = sound(&text.replace('X', ""));
    assert_eq!(pairs(only(&both), |_| true), ["f x g", "g x f"]);
    let share = Rules { readers_share: true };
    assert!(only(&both).codels().all(|(id, _)| conflicts(only(&both), id, share).is_empty()));
    // What interrupts A need not be waited for by A, but waits for it.
    let one = sound(&text.replace('X', "interrupts A;"));
    assert_eq!(pairs(only(&one), |_| true), ["g x f"]);
    let symmetric = Mutex::symmetric(&one.model, Rules::default());
    assert!(only(&one).codels().all(|(id, _)| symmetric.of((0, id)).len() == 1));
}

/// In the paper's example `start` and `write_p` of Measure use a port that another component reads, and nothing else is shared.
#[test]
fn ports_exclude_across_components() {
    let loaded = sound(IMU);
    let mutex = Mutex::symmetric(&loaded.model, Rules::default());
    let name = |(component, codel): (usize, lapwing_genom::model::CodelId)| {
        let component = &loaded.model.components[component];
        component.codel_name(&component.codels[codel.0])
    };
    let all = loaded.model.components.iter().enumerate().flat_map(|(n, c)| c.codels().map(move |(id, _)| (n, id)));
    let found: Vec<String> =
        all.flat_map(|w| mutex.of(w).iter().map(move |o| format!("{} x {}", name(w), name(*o)))).collect();
    assert_eq!(
        found,
        [
            "Measure.start x Read.read",
            "Measure.write_p x Read.read",
            "Read.read x Measure.start",
            "Read.read x Measure.write_p"
        ]
    );
}
