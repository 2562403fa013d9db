//! Models as large as one likes, made like those of robots: tasks with a timer, a manager and activities, which keep copies of the
//! variables that they share.

use std::fmt::Write as _;

/// The text of a model with so many tasks of so many activities each, with a period of 1 ms.
pub fn text(tasks: usize, activities: usize) -> String {
    let mut out = String::from("package large\nport type Go()\n");
    for n in [1, 2, activities + 1] {
        let ports: Vec<String> = (0..n).map(|p| format!("p{p}")).collect();
        let typed: Vec<String> = ports.iter().map(|p| format!("Go {p}")).collect();
        let _ = writeln!(out, "connector type R{n}({}) define {} end", typed.join(", "), ports.join(" "));
    }
    out += "atom type Timer() clock x unit millisecond export port Go tick() place w initial to w
  on tick from w to w provided (x == 1) do { x = 0; } invariant i at w provided (x <= 1) end\n";
    manager(&mut out, activities);
    for activity in 0..activities {
        self::activity(&mut out, activity, activities);
    }
    task(&mut out, activities);
    let all: Vec<String> = (0..tasks).map(|n| format!("T{n}()")).collect();
    let _ = writeln!(out, "compound type Root() component Task {} end\nend", all.join(", "));
    out
}

fn manager(out: &mut String, activities: usize) {
    *out += "atom type Manager() data int pi, i export port Go tick(), done()\n";
    for a in 0..activities {
        let _ = writeln!(out, "  export port Go give{a}(), fin{a}()");
    }
    *out += "  place wait, manage initial to wait\n  on tick from wait to manage\n";
    for a in 0..activities {
        let _ = writeln!(
            out,
            "  on give{a} from manage to manage provided (pi == 0 && i == {a}) eager do {{ pi = {}; }}",
            a + 1
        );
        let _ = writeln!(out, "  on fin{a} from manage to manage do {{ pi = 0; i = i + 1; }}");
    }
    let _ = writeln!(
        out,
        "  on done from manage to wait provided (pi == 0 && i == {activities}) eager do {{ i = 0; }}\nend"
    );
}

fn activity(out: &mut String, own: usize, activities: usize) {
    let _ = writeln!(out, "atom type Activity{own}() data int pi clock x unit microsecond export port Go begin()");
    for a in 0..activities {
        let _ = writeln!(out, "  export port Go give{a}(), fin{a}()");
    }
    *out += "  place ether, run initial to ether\n";
    let _ = writeln!(out, "  on begin from ether to run provided (pi == {}) eager do {{ x = 0; }}", own + 1);
    for a in 0..activities {
        for place in ["ether", "run"] {
            let _ = writeln!(out, "  on give{a} from {place} to {place} do {{ pi = {}; }}", a + 1);
            if a != own {
                let _ = writeln!(out, "  on fin{a} from {place} to {place} do {{ pi = 0; }}");
            }
        }
    }
    let _ = writeln!(out, "  on fin{own} from run to ether provided (x > 0) do {{ pi = 0; }}");
    *out += "  invariant wcet at run provided (x <= 50)\nend\n";
}

fn task(out: &mut String, activities: usize) {
    *out += "compound type Task() component Timer Tim() component Manager M()\n";
    for a in 0..activities {
        let _ = writeln!(out, "  component Activity{a} A{a}()\n  connector R1 begin{a}(A{a}.begin)");
    }
    *out += "  connector R2 tick(Tim.tick, M.tick)\n  connector R1 done(M.done)\n";
    for a in 0..activities {
        for what in ["give", "fin"] {
            let ports: Vec<String> = (0..activities).map(|other| format!("A{other}.{what}{a}")).collect();
            let _ = writeln!(out, "  connector R{} {what}{a}(M.{what}{a}, {})", activities + 1, ports.join(", "));
        }
    }
    *out += "end\n";
}
