//! State diagrams of Mermaid and SCXML, and what machines they become.

mod common;

use common::imported;
use expect_test::{Expect, expect};
use lapwing::explain::{Picture, draw};
use lapwing::{Monitor, Options, Spec, Unseen};
use lapwing_stream::{Sample, Time, What};

/// The machines of a diagram, without the line that says where they are from.
fn check(name: &str, text: &str, machine: Expect) -> String {
    let came = imported(name, text).sound();
    machine.assert_eq(came.text.split_once("\n\n").unwrap().1);
    came.found
}

/// Where the first machine stands after these events.
fn after(text: &str, events: &[&str]) -> String {
    let spec = Spec::parse("m.rv", text, &|_| None).unwrap();
    let machine = spec.alone().spec.machines[0].name.clone();
    let mut monitor = Monitor::new(spec);
    for (at, name) in events.iter().enumerate() {
        let event = monitor.event(name).unwrap();
        monitor.feed(Sample { time: Time(at as i64), what: What::Event { event, values: &[] } });
    }
    let state = monitor.state(&machine).unwrap().to_owned();
    monitor.finish(&Unseen::default());
    state
}

#[test]
fn a_diagram_with_states_in_states_choices_and_ends() {
    let text = "---\ntitle: Door Lock\n---\nstateDiagram-v2\n    %% a comment\n    direction LR\n    classDef bad fill:#f00\n    [*] --> closed\n    \
                closed --> Open : push [force > 2] / creak\n    Open:::bad --> closed : pull\n    closed --> locked : turn key\n    state locked {\n        [*] --> one\n        \
                one --> two : again\n        two --> [*] : click\n    }\n    locked --> closed\n    state pick <<choice>>\n    Open --> pick : kick\n    pick --> broken : if force > 9\n    \
                pick --> Open : else\n    broken : it is broken\n    broken --> [*]\n    note right of broken : no comment\n    note left of Open\n      nor this\n    end note\n";
    let found = check(
        "door.mmd",
        text,
        expect![[r#"
            event final
            event push
            event turn_key
            event pull
            event kick
            event again
            event click

            # locked is: Door_Lock == one or Door_Lock == two
            machine Door_Lock {
                initial closed
                state closed
                state Open
                state one
                state two
                state broken
                state final on final
                closed -> Open on push when force > 2
                closed -> one on turn_key
                Open -> closed on pull
                Open -> broken on kick when force > 9
                Open -> Open on kick when not force > 9
                one -> two on again
                two -> closed on click
                broken -> final
            }
        "#]],
    );
    let said: Vec<&str> = found.lines().collect();
    assert_eq!(
        said,
        ["import-code: \"/ creak\"", "import-renamed: \"turn key\"", "import-trigger: \"broken --> [*]\""]
    );
}

/// The example of Mermaid's own pages: nothing says which of the two comes after the first.
#[test]
fn a_state_that_is_done_may_go_on_to_several() {
    let text = "stateDiagram-v2\n    [*] --> First\n    First --> Second\n    First --> Third\n    state First {\n        [*] --> fir\n        \
                fir --> [*]\n    }\n    state Second {\n        [*] --> sec\n        sec --> [*]\n    }\n    state Third {\n        [*] --> thi\n    }\n";
    let found = check(
        "nested.mmd",
        text,
        expect![[r#"
            event First_final
            event sec
            event Second_final
            event thi

            # First is: nested == fir or nested == First_final
            # Second is: nested == sec or nested == Second_final
            # Third is: nested == thi
            machine nested {
                initial fir
                state fir
                state First_final on First_final
                state sec on sec
                state Second_final on Second_final
                state thi on thi
                fir -> First_final
                First_final -> sec
                First_final -> thi
                sec -> Second_final
            }
        "#]],
    );
    assert_eq!(found, "import-trigger: \"fir --> [*]\"\n");
    let machine = imported("nested.mmd", text).sound().text;
    assert_eq!(after(&machine, &["First_final", "thi"]), "thi");
    assert_eq!(after(&machine, &["First_final", "sec", "Second_final"]), "Second_final");
}

#[test]
fn names_that_are_none_here_are_told() {
    let text = "<scxml xmlns=\"http://www.w3.org/2005/07/scxml\" initial=\"arm.down\">\n<state id=\"arm.down\"><transition event=\"lift arm.raise\" \
                target=\"up\"/></state>\n<state id=\"up\"><transition event=\"arm.*\" target=\"arm.down\"/></state>\n</scxml>\n";
    let came = imported("arm.scxml", text).sound();
    assert!(came.text.contains("arm_down -> up on arm_raise\n"), "{}", came.text);
    let renamed: Vec<&str> = came.found.lines().filter(|l| l.starts_with("import-renamed")).collect();
    let arrow = "import-renamed: \"<transition event=\\\"lift arm.raise\\\" target=\\\"up\\\"/>\"";
    assert_eq!(renamed, ["import-renamed: \"<state id=\\\"arm.down\\\">\"", arrow]);
}

#[test]
fn arrows_without_labels_are_moves_that_are_allowed() {
    let text = "stateDiagram\n    [*] --> search\n    search --> approach : [the ball is near]\n    approach --> search\n    approach --> look-out : kick\n";
    let found = check(
        "robot.mmd",
        text,
        expect![[r#"
            event search
            event kick

            machine robot {
                initial search
                state search on search
                state approach
                state look_out
                search -> approach when the_ball_is_near
                approach -> search
                approach -> look_out on kick
            }
        "#]],
    );
    assert_eq!(
        found,
        "import-renamed: \"approach --> look-out : kick\"\nimport-trigger: \"the ball is near\"\nimport-trigger: \"[*] --> search\"\n"
    );
}

#[test]
fn what_is_written_for_the_eye_says_nothing_and_hides_nothing() {
    let text = "%%{init: {\n  'theme': 'base',\n  'x': {}\n}}%%\nstateDiagram-v2\n    [*] --> a %% the first\n    note \"on its own\" as n\n    \
                a:::big --> b %% no label\n    b --> a : 50 %% done\n    %%{wrap}%%\n    linkStyle 1 stroke:red\n";
    let machine = expect![[r#"
        event b
        event _50_done

        machine m {
            initial a
            state a
            state b on b
            a -> b
            b -> a on _50_done
        }
    "#]];
    check("m.mmd", text, machine);
    for (begins, told) in
        [("note right of a", "note right of a"), ("accDescr {", "accDescr {"), ("%%{init: {", "%%{init: {")]
    {
        let came = imported("m.mmd", &format!("stateDiagram-v2\n[*] --> a\n{begins}\na --> b\n"));
        assert_eq!((&*came.found, &*came.text), (&*format!("import-syntax: {told:?}\n"), ""), "what is not ended");
    }
}

#[test]
fn regions_within_states_that_hold_nothing_else_are_machines() {
    let oven = |inside: &str| {
        let text = "<scxml><state id='oven'><initial><transition target='parts'/></initial>INSIDE<parallel id='parts'>\
                    <state id='heat'><state id='off'><transition event='on' target='hot'><q:editorinfo/></transition></state><state id='hot'/></state>\
                    <state id='door'><state id='shut'/></state></parallel></state></scxml>";
        imported("m.scxml", &text.replace("INSIDE", inside).replace("<scxml>", "<scxml xmlns:q='x'>")).sound()
    };
    let came = oven("");
    assert_eq!(came.text.matches("machine m_").count(), 2, "{}", came.text);
    assert_eq!(came.found, "", "what an editor keeps is no code");
    assert!(oven("<transition event='e' target='oven'/>").found.starts_with("import-refused"));
}

#[test]
fn a_region_that_is_left_for_itself_begins_anew() {
    let text = "<scxml><parallel id='p'><state id='l'><transition event='again' target='l'/><state id='a'><transition event='e' target='b'/></state>\
                <state id='b'/></state><state id='r'><state id='x'/></state></parallel></scxml>";
    let came = imported("m.scxml", text).sound();
    assert!(
        came.text.contains("    a -> a on again\n") && came.text.contains("    b -> a on again\n"),
        "{}",
        came.text
    );
    assert_eq!(after(&came.text, &["e", "again"]), "a");
}

#[test]
fn a_chart_in_scxml() {
    let text = r#"<?xml version="1.0"?>
<scxml xmlns="http://www.w3.org/2005/07/scxml" version="1.0" initial="idle" name="robot">
  <datamodel><data id="n" expr="0"/></datamodel>
  <state id="idle"><transition event="start go" target="busy" cond="ready &amp;&amp; !stuck"/></state>
  <state id="busy" initial="turn">
    <onentry><log expr="'x'"/></onentry>
    <transition event="stop" target="idle"/>
    <transition event="done.state.busy" target="idle"/>
    <transition event="error" target="broken"/>
    <state id="turn">
      <transition event="seen" target="drive"/>
      <transition event="stop" cond="speed &lt; 1" target="drive"/>
    </state>
    <state id="drive"><transition event="there" target="end"/><transition event="error.motor"/></state>
    <final id="end"/>
  </state>
  <state id="broken"><transition target="idle" cond="repaired"/></state>
  <state id="passing"><transition target="broken"/></state>
</scxml>
"#;
    let found = check(
        "robot.scxml",
        text,
        expect![[r#"
            event start
            event go
            event seen
            event stop
            event error
            event error_motor
            event there

            # busy is: robot == turn or robot == drive
            machine robot {
                initial idle
                state idle
                state turn
                state drive
                state broken
                idle -> turn on start when ready and not stuck
                idle -> turn on go when ready and not stuck
                turn -> drive on seen
                turn -> drive on stop when speed < 1
                turn -> idle on stop when not speed < 1
                turn -> broken on error
                turn -> broken on error_motor
                drive -> idle on there
                drive -> drive on error_motor
                drive -> idle on stop
                drive -> broken on error
                broken -> idle when repaired
            }
        "#]],
    );
    assert!(
        found.contains("import-code: \"<datamodel>\"")
            && found.contains("import-differs: \"<state id=\\\"broken\\\">\""),
        "{found}"
    );
}

#[test]
fn inner_arrows_come_before_outer_ones() {
    let text =
        "stateDiagram-v2\n[*] --> s\nstate s {\n[*] --> a\na --> b : e\nb --> a : f\n}\ns --> out : e\nout --> s : f\n";
    let came = imported("m.mmd", text).sound();
    for (events, state) in
        [(&["e"][..], "b"), (&["e", "e"], "out"), (&["e", "e", "f"], "a"), (&["f"], "a"), (&["e", "f"], "a")]
    {
        assert_eq!(after(&came.text, events), state, "{events:?}\n{}", came.text);
    }
    // In SCXML the order of the document decides as well.
    let text = "<scxml><state id='a'><transition event='e' cond='x' target='b'/><transition event='e' target='c'/><transition event='e' target='b'/>\
                </state><state id='b'/><state id='c'/></scxml>";
    let came = imported("m.scxml", text).sound();
    assert!(came.text.contains("    a -> b on e when x\n    a -> c on e when not x\n}"), "{}", came.text);
}

#[test]
fn regions_that_are_all_there_is_become_machines() {
    let text = "stateDiagram-v2\n[*] --> both\nstate both {\n[*] --> a\na --> b : e\n--\n[*] --> x\nx --> y : e\n}\n";
    let came = imported("m.mmd", text);
    assert!(
        came.found.is_empty() && came.text.contains("machine m_1 {") && came.text.contains("machine m_2 {"),
        "{}{}",
        came.found,
        came.text
    );
    came.sound();
    let text = "<scxml><parallel id='p'><state id='l'><state id='a'><transition event='e' target='b'/></state><state id='b'/></state>\
                <state id='r'><state id='x'/></state></parallel></scxml>";
    let came = imported("m.scxml", text).sound();
    assert!(came.text.contains("machine m_l {") && came.text.contains("machine m_r {"), "{}", came.text);
}

#[test]
fn a_page_may_have_several_diagrams() {
    let page = "# x\n```mermaid\nflowchart TD\n  a --> b\n```\n```mermaid\nstateDiagram\n[*] --> a\na --> b : go\n```\n```mermaid\nstateDiagram-v2\n[*] --> a\na --> b : go\n```\n";
    let came = imported("page.md", page).sound();
    assert!(came.text.contains("machine page_1 {") && came.text.contains("machine page_2 {"), "{}", came.text);
    assert_eq!(came.text.matches("event go\n").count(), 1);
}

#[test]
fn what_no_machine_can_be_is_refused_at_its_place() {
    let scxml = |inside: &str| ("m.scxml", format!("<scxml>{inside}</scxml>"));
    let mermaid = |inside: &str| ("m.mmd", format!("stateDiagram-v2\n{inside}\n"));
    for ((name, text), found) in [
        (scxml("<state id='a'><state id='b'/><history id='h'/></state>"), "import-refused: \"<history id='h'/>\""),
        (
            scxml("<state id='a'/><state id='q'><parallel id='b'><state id='c'/><state id='d'/></parallel></state>"),
            "import-refused: \"<parallel id='b'>\"",
        ),
        (
            scxml("<state id='a'><transition event='e' target='b c'/></state><state id='b'/><state id='c'/>"),
            "import-refused: \"<transition event='e' target='b c'/>\"",
        ),
        (
            scxml("<state id='a'><transition event='e' target='bb'/></state><state id='b'/>"),
            "import-syntax: \"<transition event='e' target='bb'/>\"",
        ),
        (scxml("<state id='a'/><state id='a'/>"), "import-syntax: \"<state id='a'/>\""),
        (
            scxml("<state id='a'><transition target='b'/></state><state id='b'><transition target='a'/></state>"),
            "import-refused: \"<state id='a'>\"",
        ),
        (scxml(""), "import-syntax: \"<scxml>\""),
        (("m.scxml", "<scxml><state id='a'>".to_owned()), "import-syntax: \"<state id='a'>\""),
        (("m.scxml", "<a/>".to_owned()), "import-syntax: \"<a/>\""),
        (("m.scxml", "<scxml>".repeat(99)), "import-syntax: \"<scxml>\""),
        (mermaid("[*] --> a\nstate f <<fork>>\na --> f\nf --> b"), "import-refused: \"state f <<fork>>\""),
        (mermaid("[*] --> a\na --> b\nstate b {\nx --> y\n--\nz\n}"), "import-refused: \"a --> b\""),
        (mermaid("[*] --> both\nstate both {\na --> x\n--\nx --> y\n}"), "import-refused: \"x --> y\""),
        (
            mermaid("[*] --> a\nstate c <<choice>>\nstate d <<choice>>\na --> c\nc --> d\nd --> c"),
            "import-refused: \"state c <<choice>>\"",
        ),
        (mermaid("a -> b"), "import-syntax: \"a -> b\""),
        (mermaid("state a {"), "import-syntax: \"\""),
        (mermaid("}"), "import-syntax: \"}\""),
        (mermaid(""), "import-syntax: \"stateDiagram-v2\\n\\n\""),
        (mermaid("%% lapwing: state a on\n[*] --> a"), "import-syntax: \"%% lapwing: state a on\""),
        (("m.mmd", "flowchart TD\n".to_owned()), "import-syntax: \"flowchart TD\""),
        (("m.md", "# nothing\n".to_owned()), "import-syntax: \"\""),
    ] {
        let came = imported(name, &text);
        assert_eq!(came.found.lines().next().unwrap_or(""), found, "{text}\n{}", came.found);
        assert_eq!(came.text, "", "{text}");
    }
}

#[test]
fn what_multiplies_is_refused_before_it_does() {
    let choices: String = (0..15).map(|n| format!("state c{n} <<choice>>\n")).collect();
    let layers: String = (0..14).flat_map(|n| (0..4).map(move |k| format!("c{n} --> c{} : x{k}\n", n + 1))).collect();
    let came = imported("m.mmd", &format!("stateDiagram-v2\n{choices}[*] --> a\na --> c0 : go\n{layers}"));
    assert!(came.found.starts_with("import-refused") && came.text.is_empty(), "{}", came.found);
    // Comments add states as lines do.
    let said = |count: usize| -> String { (0..count).map(|n| format!("%% lapwing: state s{n}\n")).collect() };
    let drawn: String = (0..600).map(|n| format!("d{n}\n")).collect();
    for text in [said(1_001), said(600) + &drawn] {
        let came = imported("m.mmd", &format!("stateDiagram-v2\n[*] --> a\n{text}"));
        assert_eq!((came.found.as_str(), came.text.as_str()), ("import-refused: \"\"\n", ""));
    }
    let guarded: String = (0..80).map(|n| format!("<transition event='e' cond='x == {n}' target='s{n}'/>")).collect();
    let states: String = (0..80).map(|n| format!("<state id='s{n}'/>")).collect();
    let chart = |transitions: &str| format!("<scxml><state id='a'>{transitions}</state>{states}</scxml>");
    let came = imported("m.scxml", &chart(&guarded));
    assert!(came.found.starts_with("import-refused") && came.text.is_empty(), "{}", came.found);
    let few: String = guarded.split_inclusive("/>").take(30).collect();
    let came = imported("m.scxml", &chart(&few));
    assert!(came.text.len() < 40_000 && came.text.contains("a -> s29 on e when"), "{}", came.text.len());
}

#[test]
fn charts_that_mean_harm_are_refused_or_read_and_no_more() {
    let depth = 100_000;
    let nested = |open: &str, close: &str| format!("{}{}", open.repeat(depth), close.repeat(depth));
    // What an entity stands for is nobody's business but XML's five: nothing is expanded, fetched or repeated.
    let laughs: String = (1..30).map(|n| format!("<!ENTITY l{n} '&l{};&l{};'>", n - 1, n - 1)).collect();
    let bomb = format!("<!DOCTYPE scxml [<!ENTITY l0 'ha'>{laughs}]><scxml><state id='&l29;'/></scxml>");
    let file = "<!DOCTYPE scxml [<!ENTITY f SYSTEM 'file:///etc/passwd'>]><scxml><state id='a&f;'/></scxml>";
    for (name, text) in [
        ("m.scxml", bomb),
        ("m.scxml", file.to_owned()),
        ("m.scxml", format!("<scxml>{}</scxml>", nested("<state>", "</state>"))),
        ("m.scxml", format!("<scxml>{}", "<state id='a'>".repeat(depth))),
        ("m.scxml", format!("<scxml><state id='a' {}/></scxml>", "x='y' ".repeat(depth))),
        ("m.scxml", format!("<scxml initial='{}'><state id='a'/></scxml>", "a ".repeat(depth))),
        ("m.scxml", "<!--".repeat(depth)),
        ("m.mmd", format!("stateDiagram-v2\n{}", nested("state a {\n", "}\n"))),
        ("m.mmd", format!("stateDiagram-v2\n[*] --> a\na --> b : {}\n", "[".repeat(depth))),
        ("m.mmd", format!("stateDiagram-v2\nstate {} {{\n--\n}}\n", "\"".repeat(depth))),
        ("m.md", "```mermaid\n".repeat(depth)),
    ] {
        let came = imported(name, &text);
        assert!(!came.found.is_empty() || came.text.len() < 10_000, "{}", &text[..80]);
        for secret in ["root:", "haha"] {
            assert!(!came.text.contains(secret) && !came.found.contains(secret), "{}", came.found);
        }
    }
}

/// The drawing of a specification, if it is one of state diagrams.
fn drawn(text: &str) -> Option<String> {
    let spec = Spec::parse("a.rv", text, &|_| None).ok()?;
    draw(&spec, None, &Options::default(), Picture::Mermaid).unwrap().filter(|d| d.starts_with("stateDiagram"))
}

#[test]
fn drawings_of_machines_come_back_as_the_same_machines() {
    let root = concat!(env!("CARGO_MANIFEST_DIR"), "/../..");
    let suite = std::fs::read_to_string(format!("{root}/suite/machines/machines.md")).unwrap();
    let soccer = std::fs::read_to_string(format!("{root}/examples/soccer/soccer.rv")).unwrap();
    let machine = |fence: &str| fence.split("\n}\n").next().map(|m| format!("{m}\n}}\n")).unwrap();
    let cases =
        suite.split("```rv\n").skip(1).map(machine).chain([soccer.split("\nevent ").next().unwrap().to_owned()]);
    let mut count = 0;
    for spec in cases {
        let Some(drawing) = drawn(&spec) else { panic!("{spec}") };
        let came = imported("a.mmd", &drawing);
        assert_eq!(came.found, "", "{drawing}");
        assert_eq!(drawn(&came.text).as_deref(), Some(drawing.as_str()), "{}", came.text);
        let laid_out = |text: &str| {
            let from = text.find("machine ").unwrap();
            let lines = text[from..]
                .lines()
                .filter(|l| !l.trim().starts_with('#'))
                .map(|l| l.split("  #").next().unwrap().to_owned());
            lines.collect::<Vec<_>>()
        };
        // Where no condition is written otherwise than it is drawn, the text is the same.
        if spec.lines().count() < 9 && !spec.contains(" | ") {
            let spec = lapwing_syntax::format(&spec).unwrap();
            assert_eq!(laid_out(&came.text), laid_out(&spec));
        }
        count += 1;
    }
    assert!(count > 12, "{count} machines");
}

#[test]
fn states_may_be_called_by_words_of_the_language() {
    let words = "when on at state initial sample else over below next until always not true in of for each machine within o X start stop fail since";
    let arrows: String = words.split(' ').map(|w| format!("s --> {w} : {w}\n{w} --> s : back [{w} > 1]\n")).collect();
    let came = imported("m.mmd", &format!("stateDiagram-v2\n[*] --> s\n{arrows}"));
    assert_eq!(came.text.matches(" -> s on back").count(), words.split(' ').count(), "{}", came.text);
    let errors = lapwing_syntax::parse(lapwing_syntax::FileId(0), &came.text).diagnostics;
    assert!(errors.is_empty(), "{errors:?}\n{}", came.text);
}

#[test]
fn what_an_event_carries_is_its_fields() {
    let text = "<scxml name='grip'><state id='a'><transition event='slip touch' cond='_event.data.force > 3' target='b'/></state>\
                <state id='b'><transition cond='_event.name == 1' target='a'/></state></scxml>";
    let found = check(
        "grip.scxml",
        text,
        expect![[r#"
            event slip
            event touch

            machine grip {
                initial a
                state a
                state b
                a -> b on slip when slip.force > 3
                a -> b on touch when touch.force > 3
                b -> a when _event.name == 1
            }
        "#]],
    );
    assert!(found.starts_with("import-trigger: \"<transition cond='_event.name == 1'"), "{found}");
}

#[test]
fn what_stands_in_brackets_behind_an_event_is_said() {
    let text = "stateDiagram-v2\n    [*] --> a\n    a --> b : timeout(2s)\n    b --> a : stop()\n    b --> a : kick(power) [power > 2] / beep\n";
    let came = imported("m.mmd", text).sound();
    assert_eq!(came.found, "import-trigger: \"(2s)\"\nimport-trigger: \"(power)\"\nimport-code: \"/ beep\"\n");
    assert!(came.text.contains("    b -> a on stop\n    b -> a on kick when power > 2\n"), "{}", came.text);
}
