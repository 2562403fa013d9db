//! `lapwing genom`: components read, drawn and written.

mod common;

use common::Folder;

const LASER: &str = "#include \"types.idl\"\ncomponent Laser { port out scan Scan; task t { period 40 ms; };\n\
                     activity Read() { task t; codel<start> f(out Scan) yield pause::start, ether wcet 5 ms; interrupts Read; }; };\n";
const PILOT: &str = "component Pilot { port in scan Scan; task t { period 20 ms; };\n\
                     activity Drive() { task t; codel<start> g(in Scan) yield pause::start wcet SLOW ms; }; };\n";

fn folder() -> Folder {
    Folder::new(&[("idl/types.idl", "struct scan { double near; };\n"), ("laser.gen", LASER), ("pilot.gen", PILOT)])
}

#[test]
fn check_says_what_is_there_and_what_is_missing() {
    let folder = folder();
    let good = folder.lapwing("genom check laser.gen pilot.gen -I idl -D SLOW=2");
    assert_eq!((good.code, good.stderr.as_str()), (0, ""));
    let laser = "Laser 0: 1 task, 1 activity, 0 functions, 0 attributes, 1 port, 1 codel; 1 codel or attribute must wait for others\n";
    assert_eq!(good.stdout, format!("{laser}{}1 port is linked\n", laser.replace("Laser", "Pilot")));
    let lost = folder.lapwing("genom check laser.gen");
    assert_eq!((lost.code, lost.stdout.as_str()), (2, ""));
    assert!(
        lost.stderr.contains("error[missing-include]")
            && lost.stderr.contains("laser.gen:1:10")
            && lost.stderr.contains("-I DIR"),
        "{}",
        lost.stderr
    );
    let slow = folder.lapwing("genom check laser.gen pilot.gen -I idl -D SLOW=21");
    assert!(
        slow.code == 0 && slow.stderr.contains("warning[wcet-over-period]") && slow.stderr.contains("pilot.gen:2"),
        "{}",
        slow.stderr
    );
    let none = folder.lapwing("genom check nothing.gen");
    assert!(none.code == 2 && none.stderr.starts_with("error: nothing.gen cannot be read"), "{}", none.stderr);
    assert!(folder.lapwing("explain missing-include").stdout.contains("`-I`"));
}

#[test]
fn execution_times_and_links_come_from_files_too() {
    let folder = folder();
    folder.write("w.txt", b"Pilot.Drive.start = 25 ms\n");
    folder.write("p.txt", b"Pilot.Scan Laser.Scann\n");
    let run = folder.lapwing("genom check laser.gen pilot.gen -I idl -D SLOW=1 --wcet w.txt");
    assert!(run.code == 0 && run.stderr.contains("may take 25 ms, and its task runs every 20 ms"), "{}", run.stderr);
    let run = folder.lapwing("genom check laser.gen pilot.gen -I idl -D SLOW=1 --ports p.txt");
    assert!(
        run.code == 2 && run.stderr.contains("p.txt:1:12") && run.stderr.contains("did you mean `Laser.Scan`?"),
        "{}",
        run.stderr
    );
}

#[test]
fn pictures_and_models_are_written() {
    let folder = folder();
    let run = |what: &str| {
        let run = folder.lapwing(&format!("genom {what} laser.gen pilot.gen -I idl -D SLOW=2"));
        assert_eq!((run.code, run.stderr.as_str()), (0, ""), "{what}");
        let again = folder.lapwing(&format!("genom {what} laser.gen pilot.gen -I idl -D SLOW=2"));
        assert_eq!(run.stdout, again.stdout, "{what}: the same text every time");
        run.stdout
    };
    let dot = run("graph");
    assert!(dot.starts_with("digraph {") && dot.contains("label=\"Scan\", shape=octagon"), "{dot}");
    assert!(run("graph --format svg").contains("</svg>"));
    assert!(run("graph --automata").contains("Laser_Read_1: an instance of an activity"));
    assert!(run("uppaal").contains("<system>system Laser_control, "));
    let bip = run("bip --instances 1");
    folder.write("model.bip", bip.as_bytes());
    assert!(bip.contains("// laser.gen:3: transition") || bip.contains("// laser.gen:3: pause"), "{bip}");
    assert!(run("bip --runtime").contains("resume (x <= 5)"));
    let small = folder.lapwing("bip run model.bip --root Root --asap --seed 1 --limit 50 --silent");
    assert_eq!(small.code, 0, "{}", small.stderr);
}

#[test]
fn too_much_is_refused() {
    let folder = folder();
    let run = folder.lapwing("genom bip laser.gen -I idl --instances 1000");
    assert!(
        run.code == 2 && run.stderr.contains("128 are the limit") && run.stderr.contains("--instances 1"),
        "{}",
        run.stderr
    );
    folder.write("i.gen", b"interface i { port in long p; };");
    let run = folder.lapwing("genom uppaal i.gen");
    assert!(run.code == 2 && run.stderr.contains("no component"), "{}", run.stderr);
}
