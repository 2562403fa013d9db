//! Specifications in memory.
#![allow(dead_code, clippy::unwrap_used)]

use std::collections::BTreeMap;
use std::path::PathBuf;

use lapwing_genom::model::Component;
use lapwing_genom::{Loaded, Options, load};

/// Reads `main.gen` from files given by name and text.
pub fn files(files: &[(&str, &str)], options: &Options) -> Loaded {
    let files: BTreeMap<PathBuf, String> = files.iter().map(|(n, t)| (PathBuf::from(n), (*t).to_owned())).collect();
    load(&files, &[PathBuf::from("main.gen")], options).unwrap()
}

/// Reads a text.
pub fn text(text: &str) -> Loaded {
    files(&[("main.gen", text)], &Options::default())
}

/// Reads a text in which nothing is wrong.
pub fn sound(source: &str) -> Loaded {
    let loaded = text(source);
    assert!(!loaded.has_errors(), "{}", shown(&loaded));
    loaded
}

/// Diagnostics, a line each: `code line: message`.
pub fn shown(loaded: &Loaded) -> String {
    let one = |d: &lapwing_diag::Diagnostic| {
        let (line, _) = loaded.sources.position(d.primary.span);
        format!("{} {line}: {}\n", d.code.name(), d.message)
    };
    loaded.diagnostics.iter().map(one).collect()
}

/// The codes of the diagnostics, and the text at their places.
pub fn codes(loaded: &Loaded) -> Vec<String> {
    let one = |d: &lapwing_diag::Diagnostic| format!("{}: {}", d.code.name(), loaded.sources.slice(d.primary.span));
    loaded.diagnostics.iter().map(one).collect()
}

/// The only component.
pub fn only(loaded: &Loaded) -> &Component {
    assert_eq!(loaded.model.components.len(), 1);
    &loaded.model.components[0]
}

/// The paper's component with its two activities (listing 4), and one that reads its port.
pub const IMU: &str = r#"
struct imu_t { double x; };
component ImuDriver {
  native handle;
  ids { handle driver; imu_t imu; double timestamp; };
  port out imu_t IMU;
  task update { period 10 ms; };
  activity Measure() {
    codel<start> MsStart(port out IMU) yield get, ether wcet 1ms;
    codel<get> GetImu(inout driver, out imu, out timestamp) yield write_p, ether wcet 2ms;
    codel<write_p> WritePort(in imu, port out IMU) yield pause::get, ether wcet 1.5ms;
    codel<stop> MeasureStop() yield ether wcet 2ms;
    interrupts Measure;
    task update;
  };
  activity Connect() {
    codel<start> ConnectStart(inout driver) yield ether wcet 2ms;
    codel<stop> ConnectStop() yield ether wcet 1ms;
    task update;
  };
};
component POM {
  port in imu_t IMU;
  task io { period 10 ms; };
  activity Read() {
    codel<start> Begin() yield read wcet 1 ms;
    codel<read> Take(port in IMU) yield pause::read, ether wcet 1 ms;
    task io;
  };
};
"#;
