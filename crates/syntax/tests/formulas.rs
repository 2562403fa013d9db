//! Which tree a formula gives.

mod common;

use common::{formula, parsed, sexpr};
use lapwing_syntax::print_expr;

/// Each formula gives its tree.
fn check(table: &[(&str, &str)]) {
    for (text, expected) in table {
        assert_eq!(sexpr(&formula(text)), *expected, "{text}");
    }
}

/// Each formula, once more between brackets as the second says, is the same.
fn check_same(table: &[(&str, &str)]) {
    for (text, bracketed) in table {
        assert_eq!(sexpr(&formula(text)), sexpr(&formula(bracketed)), "{text}");
    }
}

#[test]
fn connectives_group_by_rank() {
    check_same(&[
        ("not a and b", "(not a) and b"),
        ("a or b and c", "a or (b and c)"),
        ("a and b or c and d", "(a and b) or (c and d)"),
        ("a implies b or c", "a implies (b or c)"),
        ("a iff b implies c", "a iff (b implies c)"),
        ("a and b and c", "(a and b) and c"),
        ("a or b or c", "(a or b) or c"),
        ("a iff b iff c", "(a iff b) iff c"),
        ("a implies b implies c", "a implies (b implies c)"),
        ("not not a", "not (not a)"),
        ("not a == b", "not (a == b)"),
    ]);
}

#[test]
fn infix_until_and_since_bind_tighter_than_and_looser_than_not() {
    check_same(&[
        ("a and b until c and d", "a and (b until c) and d"),
        ("not a until b", "(not a) until b"),
        ("a until b since c", "(a until b) since c"),
        ("a until b until c", "(a until b) until c"),
        ("a > 1 until b < 2", "(a > 1) until (b < 2)"),
        ("a since not b or c", "(a since (not b)) or c"),
        ("a until always b and c", "a until (always (b and c))"),
    ]);
}

#[test]
fn prefix_words_reach_as_far_right_as_they_can() {
    check_same(&[
        ("p and always q or r", "p and (always (q or r))"),
        ("always a until b", "always (a until b)"),
        ("never a iff b", "never (a iff b)"),
        ("not always a and b", "not (always (a and b))"),
        ("becomes a and b", "becomes (a and b)"),
        ("eventually within 3 s a and b", "eventually within 3 s (a and b)"),
        ("a or after b, c or d", "a or (after b, (c or d))"),
        ("after a or b, c", "after (a or b), c"),
        ("after always a, b", "after (always a), b"),
        ("after after a, b, c", "after (after a, b), c"),
        ("after_until a, b, c and d", "after_until a, b, (c and d)"),
        ("whenever a, while b, c or d", "whenever a, (while b, (c or d))"),
    ]);
}

#[test]
fn held_binds_as_not_does() {
    check_same(&[
        ("held for 1 s a and b", "(held for 1 s a) and b"),
        ("held for 1 s a > 2 until b", "(held for 1 s (a > 2)) until b"),
        ("held for 1 s not a", "held for 1 s (not a)"),
    ]);
    check(&[
        ("held for settle (a)", "(held settle a)"),
        (
            "whenever held for 0.5 s (cmd > 0.03), odom > -0.01",
            "(whenever (held 500000000ns (gt cmd 0.03)) (gt odom (neg 0.01)))",
        ),
        ("held or held.for", "(or held held.for)"),
    ]);
}

#[test]
fn arithmetic_groups_by_rank() {
    check_same(&[
        ("x == a + b * c", "x == a + (b * c)"),
        ("x == a - b - c", "x == (a - b) - c"),
        ("x == a / b * c", "x == (a / b) * c"),
        ("x == -a * b", "x == (-a) * b"),
        ("x == a * -b.c", "x == a * (-(b.c))"),
        ("x == --a", "x == -(-a)"),
        ("a + 1 < b - 2", "(a + 1) < (b - 2)"),
    ]);
    check(&[("a - -b == 0", "(eq (sub a (neg b)) 0)"), ("a <-3", "(lt a (neg 3))")]);
}

#[test]
fn comparisons_and_margins() {
    check(&[
        ("a == b", "(eq a b)"),
        ("a != b", "(ne a b)"),
        ("a < b", "(lt a b)"),
        ("a <= b", "(le a b)"),
        ("a > b", "(gt a b)"),
        ("a >= b", "(ge a b)"),
        ("a =={m} b", "(eq{m} a b)"),
        ("a !={2 * m} b", "(ne{(mul 2 m)} a b)"),
        ("a < {0.05} b", "(lt{0.05} a b)"),
        ("a <={ 5 cm } b + 1", "(le{5cm} a (add b 1))"),
        ("a >{m} -b", "(gt{m} a (neg b))"),
        ("a >={m} b", "(ge{m} a b)"),
        ("(a and b) == c", "(eq (and a b) c)"),
    ]);
}

#[test]
fn operands() {
    check(&[
        ("true or false", "(or true false)"),
        ("a == \"x\\u0041\\n\"", "(eq a \"xA\\n\")"),
        ("a.b.c", "a.b.c"),
        ("a.b[3].c[0]", "(at (. (at a.b 3) c) 0)"),
        ("(a).b", "(. a b)"),
        ("f(x).y", "(. (call f x) y)"),
        ("@{x, -3} < @{@{x + 1, -1}, -2}", "(lt (@3 x) (@2 (@1 (add x 1))))"),
        ("@{a and b, -1}", "(@1 (and a b))"),
        ("f()", "(call f)"),
        ("f(a, b and c, after d, e, g)", "(call f a (and b c) (after d e) g)"),
        ("any(a, v => v.name == \"x\" and p)", "(call any a (fn v (and (eq v.name \"x\") p)))"),
        ("lookup(names, values, \"elbow\") < 1", "(lt (call lookup names values \"elbow\") 1)"),
        ("age(/robot1/scan) < 0.5 s", "(lt (call age (topic /robot1/scan)) 0.5s)"),
        ("frequency(/scan, 2 s) > 10 Hz", "(gt (call frequency (topic /scan) 2s) 10Hz)"),
        ("age(scan) < 1", "(lt (call age scan) 1)"),
        ("running Navigation.GotoPosition or x", "(or (call running Navigation.GotoPosition) x)"),
        ("running(Navigation.GotoPosition)", "(call running Navigation.GotoPosition)"),
        ("running and x", "(and running x)"),
        ("entered(soccer.goto_ball)", "(call entered soccer.goto_ball)"),
        ("soccer == goto_ball", "(eq soccer goto_ball)"),
    ]);
}

#[test]
fn units_follow_a_number_directly_or_after_a_blank() {
    check(&[
        ("x < 2 s", "(lt x 2s)"),
        ("x < 2s", "(lt x 2s)"),
        ("x < 2.0 m/s", "(lt x 2.0m/s)"),
        ("x < 9.81 m/s^2", "(lt x 9.81m/s^2)"),
        ("x < 5 m / s", "(lt x (div 5m s))"),
        ("x < 5 m/sec", "(lt x (div 5m sec))"),
        ("x < 30deg/s", "(lt x 30deg/s)"),
        ("x < 30 deg / 2", "(lt x (div 30deg 2))"),
        ("x < 1e-6 and y", "(and (lt x 1e-6) y)"),
        ("x < 1e3 mm", "(lt x 1e3mm)"),
        ("x < 2 min", "(lt x 2min)"),
        ("x < 2 * s", "(lt x (mul 2 s))"),
        ("m == s", "(eq m s)"),
        ("x < 2 rad/s * 3", "(lt x (mul 2rad/s 3))"),
        ("x < 10 Hz", "(lt x 10Hz)"),
    ]);
}

#[test]
fn bounds() {
    check(&[
        ("always within 2 s p", "(always[0,2000000000ns] p)"),
        ("always for 2 s p", "(always[0,2000000000ns] p)"),
        ("historically for d p", "(historically[0,d] p)"),
        ("eventually within [1 s, 1500 ms] p", "(eventually[1000000000ns,1500000000ns] p)"),
        ("once within (0 s, max_gap] (p or q)", "(once(0ns,max_gap] (or p q))"),
        ("historically within [a, b) p", "(historically[a,b) p)"),
        ("always within (0.1 us, 1 h) p", "(always(100ns,3600000000000ns) p)"),
        ("p until within 3 s q and r", "(and (until[0,3000000000ns] p q) r)"),
        ("p since within (1 min, d] q", "(since(60000000000ns,d] p q)"),
        ("always within d (p)", "(always[0,d] p)"),
        ("eventually within 1.5 ns p", "(eventually[0,2ns] p)"),
        ("eventually within 2.5 ns p", "(eventually[0,2ns] p)"),
    ]);
}

#[test]
fn words_are_reserved_only_where_they_can_start_something() {
    check(&[
        ("x.next > 2 and x.until < 3", "(and (gt x.next 2) (lt x.until 3))"),
        ("`next` > 2 and `a b`.`stop sign`", "(and (gt next 2) a b.stop sign)"),
        ("event > 3 or state == model", "(or (gt event 3) (eq state model))"),
        ("never on and initial", "(never (and on initial))"),
        ("on implies x", "(implies on x)"),
        ("ltl > 3", "(gt ltl 3)"),
        ("for_each > each", "(gt for_each each)"),
        ("since == 3", "(eq since 3)"),
        ("within > 1 and implies", "(and (gt within 1) implies)"),
        ("x > within and or == iff", "(and (gt x within) (eq or iff))"),
        ("and.x - within or (implies)", "(or (sub and.x within) implies)"),
        ("always within 2 s within", "(always[0,2000000000ns] within)"),
        ("within and within until x", "(and within (until within x))"),
        ("o > X + U", "(gt o (add X U))"),
    ]);
    let file = parsed("event = 3\nproperty property: x\nstate: y\ndecl decl /decl decl.decl\n");
    assert_eq!(file.items.len(), 4);
}

#[test]
fn the_symbolic_notation_gives_the_same_nodes() {
    check_same(&[
        ("ltl([] p)", "ltl([]p)"),
        ("ltl(X p)", "ltl(o p)"),
        ("ltl(p && q || !r)", "ltl(p and q or not r)"),
        ("ltl([] p U q)", "ltl(([] p) U q)"),
        ("ltl(! p U q)", "ltl((! p) U q)"),
        ("ltl(p U q S r)", "ltl(p U (q S r))"),
        ("ltl(p and q U r)", "ltl(p and (q U r))"),
        ("ltl(p => q => r)", "ltl(p => (q => r))"),
        ("ltl(p <=> q => r)", "ltl(p <=> (q => r))"),
        ("ltl(p <=> q <=> r)", "ltl((p <=> q) <=> r)"),
        ("ltl(p or q and r => s)", "ltl((p or (q and r)) => s)"),
        ("ltl([] <> p and q)", "ltl(([] (<> p)) and q)"),
        ("ltl(not x == 3)", "ltl(not (x == 3))"),
    ]);
    check(&[
        ("ltl([] p)", "(ltl (always p))"),
        ("ltl(<>o X p)", "(ltl (eventually (next (next p))))"),
        ("ltl(<*>p and [*]p and (*)p)", "(ltl (and (and (once p) (historically p)) (previously p)))"),
        ("ltl(p U q)", "(ltl (until p q))"),
        ("ltl(p S q)", "(ltl (since p q))"),
        ("ltl(x > 3 U any(a, v => v.o))", "(ltl (until (gt x 3) (call any a (fn v v.o))))"),
        ("ltl([] x.o) and o", "(and (ltl (always x.o)) o)"),
        ("ltl(x < 3)", "(ltl (lt x 3))"),
        ("ltl(\n[]\np\n)", "(ltl (always p))"),
    ]);
}

#[test]
fn the_formulas_of_the_soccer_robot() {
    check(&[
        ("ltl([](play_before => <*> ready_true))", "(ltl (always (implies play_before (once ready_true))))"),
        (
            "ltl([](turn_to_ball_state_true => o(ballinfront_true U kick_ball_after)))",
            "(ltl (always (implies turn_to_ball_state_true (next (until ballinfront_true kick_ball_after)))))",
        ),
        (
            "ltl(kick_ball_before => (*) kick_ball_state_true)",
            "(ltl (implies kick_ball_before (previously kick_ball_state_true)))",
        ),
        ("ltl([] ir_read_true)", "(ltl (always ir_read_true))"),
        (
            "ltl([](turn_to_goal_state_true => o(dribble_ball_state_true U goto_goal_true)))",
            "(ltl (always (implies turn_to_goal_state_true (next (until dribble_ball_state_true goto_goal_true)))))",
        ),
        (
            "ltl((game_over => <*> kick_ball_state_true) and (game_over => <*>kick_ball))",
            "(ltl (and (implies game_over (once kick_ball_state_true)) (implies game_over (once kick_ball))))",
        ),
        (
            "ltl(setupSessionEvent =>(*)verifyCredEvent_true)",
            "(ltl (implies setupSessionEvent (previously verifyCredEvent_true)))",
        ),
        (
            "ltl([](kick_ball_state_true => ((<*>ballclose_true) and (!(*)ballclose_false))))",
            "(ltl (always (implies kick_ball_state_true (and (once ballclose_true) (not (previously ballclose_false))))))",
        ),
        (
            "ltl([](Gotoball_true => o ballinfront_true))",
            "(ltl (always (implies Gotoball_true (next ballinfront_true))))",
        ),
    ]);
}

#[test]
fn brackets_are_remembered_and_left_out_of_the_place() {
    let text = "(a and b) or c";
    let expr = formula(text);
    assert!(!expr.parens);
    let lapwing_syntax::ast::ExprKind::Binary(_, left, _) = expr.kind else { panic!("{expr:?}") };
    assert!(left.parens);
    assert_eq!((left.span.start, left.span.end), (1, 8));
    assert_eq!((expr.span.start, expr.span.end), (0, 14));
}

#[test]
fn printing_puts_only_the_brackets_that_are_needed() {
    for (text, printed) in [
        ("((a)) and ((b or c))", "a and (b or c)"),
        ("(a and b) or c", "(a and b) or c"),
        ("(not a) and b", "not a and b"),
        ("(always a) and (always b)", "(always a) and always b"),
        ("(a implies b) implies (c implies d)", "(a implies b) implies c implies d"),
        ("not (always a and b) or c", "not (always a and b) or c"),
        ("(a until b) until (c until d)", "a until b until (c until d)"),
        ("x == (a + b) + (c + d) * e", "x == a + b + (c + d) * e"),
        ("x == -(-a) - (-b)", "x == --a - -b"),
        ("after (after a, b), c", "after (after a, b), c"),
        ("f((a and b), (after c, d))", "f(a and b, (after c, d))"),
        ("always for 90 s a", "always within 90 s a"),
        ("always within (0 s, 15 us] (a)", "always within (0 s, 15 us] a"),
        ("ltl(([] a) U ((b) => c))", "ltl([] a U (b => c))"),
        ("(`always`) and `a b`", "`always` and `a b`"),
        ("@{(x), -3} <{0.1} 2 m/s", "@{x, -3} <{0.1} 2 m/s"),
        ("running A.B", "running(A.B)"),
    ] {
        assert_eq!(print_expr(&formula(text)), printed, "{text}");
        assert_eq!(sexpr(&formula(printed)), sexpr(&formula(text)), "{text}");
    }
}
