//! `lapwing import`: files from elsewhere, and what a check says of what was made of them.

mod common;

use common::Folder;

const MONITOR: &str = "Init(Kicker k) {\n    event ready after(Kicker k) returning(boolean res): call(boolean Kicker.Ready()) && condition(res) && target(k) {}\n    \
                       event play before(Kicker k): call(void Kicker.Play()) && target(k) {}\n    ltl: play => <*> ready\n    @violation { k.Init(); __RESET; }\n}\n";

#[test]
fn a_monitor_is_written_and_judges() {
    let folder = Folder::new(&[("Init.mop", MONITOR)]);
    let run = folder.lapwing("import Init.mop -o init.rv");
    assert_eq!((run.code, run.stdout.as_str()), (0, ""), "{}", run.stderr);
    assert!(
        run.stderr.contains("warning[import-first-position]") && run.stderr.contains("Init.mop:4:10"),
        "{}",
        run.stderr
    );
    assert!(folder.lapwing("explain import-first-position").stdout.contains("the first position"));
    assert_eq!(folder.read("init.rv"), folder.lapwing("import Init.mop").stdout);
    folder.write("good.ndjson", b"{\"t\":0,\"event\":\"ready\",\"result\":true}\n{\"t\":1,\"event\":\"play\"}\n");
    folder.write("bad.ndjson", b"{\"t\":1,\"event\":\"play\"}\n");
    assert_eq!(folder.lapwing("check init.rv good.ndjson").code, 0);
    let bad = folder.lapwing("check init.rv bad.ndjson");
    assert!(bad.code == 1 && bad.stdout.contains("init"), "{}", bad.stdout);
    assert_eq!(folder.lapwing("fmt --check init.rv").code, 0);
}

#[test]
fn parameters_tell_objects_apart_where_that_is_wanted() {
    let folder = Folder::new(&[("Init.mop", MONITOR)]);
    folder.lapwing("import Init.mop --parameters each -o init.rv");
    let line =
        |t: u8, event: &str, k: &str| format!("{{\"t\":{t},\"event\":\"{event}\",\"k\":\"{k}\",\"result\":true}}\n");
    let trace = [line(0, "ready", "a"), line(1, "play", "a"), line(2, "play", "b")].concat();
    folder.write("two.ndjson", trace.as_bytes());
    let run = folder.lapwing("check init.rv two.ndjson --format json");
    let word = |instance: &str| {
        let at = run.stdout.find(&format!("\"init[{instance}]\"")).unwrap_or_else(|| panic!("{}", run.stdout));
        run.stdout[at..].split("\"verdict\":").nth(1).unwrap().trim_start().split('"').nth(1).unwrap().to_owned()
    };
    assert_eq!([word("a"), word("b")], ["holds", "violated"]);
}

#[test]
fn what_is_left_out_shows_in_the_exit_code() {
    let partly = MONITOR.replace("ltl: play", "cfg: S -> play ltl: play");
    let folder =
        Folder::new(&[("a.mop", &partly), ("b.mop", "X(Y y) { srs: a -> b }"), ("c.txt", ""), ("d.mmd", "graph TD\n")]);
    let run = folder.lapwing("import a.mop");
    assert!(
        run.code == 3 && run.stdout.contains("property init") && run.stderr.contains("error[import-refused]"),
        "{run:?}"
    );
    let run = folder.lapwing("import b.mop -o b.rv");
    assert!(run.code == 2 && run.stderr.contains("nothing of b.mop could be carried over"), "{run:?}");
    assert!(!folder.path("b.rv").exists());
    let run = folder.lapwing("import c.txt");
    assert!(run.code == 2 && run.stderr.contains(".scxml"), "{run:?}");
    let run = folder.lapwing("import none.mop");
    assert!(run.code == 2 && run.stderr.starts_with("error: none.mop cannot be read"), "{run:?}");
    assert_eq!(folder.lapwing("import d.mmd").code, 2);
}

#[test]
fn a_drawing_of_a_machine_comes_back() {
    let spec = "event go\nmachine gate {\n    sample when updated(x)\n    initial shut\n    state shut when x < 1 at most 2 s\n    state open when x >= 1 and not shut_down\n    \
                state broken when isnan(x)\n    else stay\n    shut -> open\n    open -> shut\n    open -> broken on go when x > 5\n}\n";
    let folder = Folder::new(&[("a.rv", spec)]);
    let drawn = folder.lapwing("explain a.rv --format mermaid").stdout;
    folder.write("a.mmd", drawn.as_bytes());
    let run = folder.lapwing("import a.mmd -o b.rv");
    assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{drawn}");
    let back = folder.read("b.rv");
    let lines = |text: &str| {
        text.lines().filter(|l| !l.starts_with('#') && !l.is_empty()).map(str::to_owned).collect::<Vec<_>>()
    };
    assert_eq!(lines(&back), lines(spec), "{drawn}");
    assert_eq!(folder.lapwing("explain b.rv --format mermaid").stdout, drawn);
}
