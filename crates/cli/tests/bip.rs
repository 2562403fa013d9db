//! `lapwing bip run`: options, logs and exit codes.

mod common;

use common::Folder;

const CHOICE: &str = "\
package choice
port type Data(int n)
connector type Single(Data p)
  define p
end
atom type Counter()
  data int n
  export port Data inc(n), dec(n)
  place a
  initial to a
  on inc from a to a provided (n < 3) do { n = n + 1; }
  on dec from a to a provided (n > 0) do { n = n - 1; }
end
compound type Top()
  component Counter C()
  connector Single more(C.inc), less(C.dec)
end
end
";

#[test]
fn a_run_is_logged_as_the_original_engine_does() {
    let run = Folder::new(&[("m.bip", CHOICE)]).lapwing("bip run m.bip --seed 6 --asap --limit 1");
    let expected = format!(
        "[BIP ENGINE]: BIP Engine (version {} )
[BIP ENGINE]: 
[BIP ENGINE]: initialize components...
[BIP ENGINE]: random scheduling based on seed=6
[BIP ENGINE]: state #0 and global time 0: 1 interaction:
[BIP ENGINE]:   [0] ROOT.more: C.inc(n=0;) [ 0, +INFTY ]
[BIP ENGINE]: -> choose [0] ROOT.more: C.inc(n=0;) at global time 0
[BIP ENGINE]: state #1 and global time 0: stop (reached limit of 1 states)
",
        env!("CARGO_PKG_VERSION")
    );
    assert_eq!((run.code, run.stdout, run.stderr), (0, expected, String::new()));
}

#[test]
fn a_seed_gives_the_same_run() {
    let folder = Folder::new(&[("m.bip", CHOICE)]);
    let log = |seed: u64| folder.lapwing(&format!("bip run m.bip --seed {seed} --limit 200")).stdout;
    assert_eq!(log(3), log(3));
    assert_ne!(log(3), log(4));
}

#[test]
fn steps_are_chosen_through_a_pipe() {
    let folder = Folder::new(&[("m.bip", CHOICE)]);
    let run = folder.lapwing_with("bip run m.bip --interactive --asap --seed 1", "0\n1\nnonsense\n7\nr\nq\n");
    assert_eq!(run.code, 0);
    let chosen: Vec<&str> = run.stdout.lines().filter(|l| l.contains("-> choose")).collect();
    assert_eq!(chosen.len(), 3, "{}", run.stdout);
    assert!(chosen[0].contains("ROOT.more: C.inc(n=0;)") && chosen[1].contains("ROOT.less: C.dec(n=1;)"), "{chosen:?}");
    assert!(run.stdout.contains("`nonsense` is no choice") && run.stdout.contains("`7` is no choice"));
    let ended = folder.lapwing_with("bip run m.bip --interactive", "0\n");
    assert_eq!(ended.code, 0, "the input has ended, and with it the run");
}

#[test]
fn faults_of_a_model_have_their_exit_codes() {
    let with = |body: &str| {
        let text = format!(
            "package p extern function msleep(int) port type Go()
atom type A() data int n clock x unit millisecond port Go p(), q() place a, b initial to a {body} end
compound type Top() component A A() end end"
        );
        Folder::new(&[("m.bip", &text)])
    };
    let code = |body: &str, options: &str| with(body).lapwing(&format!("bip run m.bip --silent {options}")).code;
    assert_eq!(code("on p from a to b on p from a to a", ""), 1);
    assert_eq!(code("on p from a to a, b", ""), 2);
    assert_eq!(code("on p from a to b on q from a to b priority r p < q priority s q < p", ""), 4);
    assert_eq!(code("on p from a to b do { n = 1; } invariant i provided (n == 0)", ""), 5);
    assert_eq!(code("on p from a to b do { n = 1 / n; }", ""), 8);
    let slow = "on p from a to b do { x = 0; msleep(60); } resume (x <= 5)";
    assert_eq!([code(slow, ""), code(slow, "--real-time"), code(slow, "--real-time --on-violation warn")], [0, 7, 0]);
    let warned = with(slow).lapwing("bip run m.bip --silent --real-time --on-violation warn");
    assert!(warned.stdout.contains("WARNING: state #1 and global time "), "{}", warned.stdout);
    let divided = with("on p from a to b do { n = 1 / n; }").lapwing("bip run m.bip --silent");
    assert!(divided.stdout.contains("ERROR: ROOT.A: a division by zero"), "{}", divided.stdout);
    assert!(divided.stderr.contains("at m.bip:2:"), "{}", divided.stderr);
}

#[test]
fn what_is_wrong_with_a_model_is_shown_with_its_place() {
    let folder = Folder::new(&[("m.bip", &CHOICE.replace("(C.inc)", "(C.incc)"))]);
    let run = folder.lapwing("bip run m.bip");
    assert_eq!((run.code, run.stdout.as_str()), (2, ""));
    assert!(
        run.stderr.contains("error[bip-unknown-name]") && run.stderr.contains("did you mean `inc`?"),
        "{}",
        run.stderr
    );
    let nobody = folder.lapwing("bip run n.bip");
    assert_eq!(nobody.code, 2);
    assert!(nobody.stderr.contains("n.bip"), "{}", nobody.stderr);
}

#[test]
fn external_functions_that_nobody_provides_are_named() {
    let text = CHOICE.replace("package choice", "package choice\nextern function int read_laser()");
    let run = Folder::new(&[("m.bip", &text)]).lapwing("bip run m.bip");
    assert_eq!(run.code, 2);
    assert!(run.stderr.contains("error[bip-external]") && run.stderr.contains("`read_laser`"), "{}", run.stderr);
}

#[test]
fn roots_are_named_on_the_command_line() {
    let two = CHOICE.replace("compound type Top()", "compound type Other()\nend\ncompound type Top()");
    let folder = Folder::new(&[("m.bip", &two)]);
    let unclear = folder.lapwing("bip run m.bip");
    assert_eq!(unclear.code, 2);
    assert!(unclear.stderr.contains("Other, Top") && unclear.stderr.contains("--root"), "{}", unclear.stderr);
    assert!(folder.lapwing("bip run m.bip --root Other").stdout.contains("state #0 and global time 0: deadlock!"));
    assert!(folder.lapwing("bip run m.bip --root Top --limit 1").stdout.contains("ROOT.more"));
}

#[test]
fn packages_are_found_beside_the_model_and_where_it_is_said() {
    let library = "package lib.ports port type Go() connector type Single(Go p) define p end end";
    let model = "package m use lib.ports
atom type A() export port Go p() place a, b initial to a on p from a to b end
compound type Top() component A A() connector lib.ports.Single s(A.p) end end";
    let folder = Folder::new(&[("m.bip", model), ("lib/ports.bip", library)]);
    assert!(folder.lapwing("bip run m.bip").stdout.contains("-> choose [0] ROOT.s: A.p()"));
    let folder = Folder::new(&[("m.bip", model), ("elsewhere/ports.bip", library)]);
    let missing = folder.lapwing("bip run m.bip");
    assert!(missing.code == 2 && missing.stderr.contains("bip-unknown-package"), "{}", missing.stderr);
    assert_eq!(folder.lapwing("bip run m.bip -I elsewhere").code, 0);
}
