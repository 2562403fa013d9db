//! A Cortex-M3: the compiler for it, and QEMU's board mps2-an385, whose input and output go through semihosting.

use std::path::{Path, PathBuf};
use std::process::Command;

use lapwing_codegen::Generated;

use super::{C_FLAGS, compile_with, driver, put};

const LINKER_SCRIPT: &str = include_str!("cortex/board.ld");
const VECTORS: &str = include_str!("cortex/vectors.c");

/// The processor, for the compiler.
pub const CPU: [&str; 2] = ["-mcpu=cortex-m3", "-mthumb"];

/// Compiles monitors and what drives them for the board.
pub fn build(monitors: &[&Generated], folder: &Path) -> Result<PathBuf, String> {
    for (name, text) in monitors.iter().flat_map(|m| &m.files) {
        put(&folder.join(name), text)?;
    }
    let (source, vectors, script) = (folder.join("cortex.c"), folder.join("vectors.c"), folder.join("board.ld"));
    put(&source, &driver::c(monitors))?;
    put(&vectors, VECTORS)?;
    put(&script, LINKER_SCRIPT)?;
    let program = folder.join("monitors.elf");
    let mut command = Command::new("arm-none-eabi-gcc");
    command.args(C_FLAGS).args(CPU).arg("--specs=rdimon.specs").arg("-T").arg(&script).arg("-o").arg(&program);
    compile_with(command.arg(&source).arg(&vectors).arg("-lm"))?;
    Ok(program)
}

/// What emulates the board with that program in it.
pub fn emulator(program: &Path) -> Command {
    let mut command = Command::new("qemu-system-arm");
    command.args(["-machine", "mps2-an385", "-nographic", "-monitor", "none", "-serial", "none"]);
    command.args(["-semihosting-config", "enable=on,target=native", "-kernel"]).arg(program);
    command
}

/// What generated C takes, compiled for size.
fn size(monitor: &Generated, folder: &Path) -> Result<[usize; 3], String> {
    for (name, text) in &monitor.files {
        put(&folder.join(name), text)?;
    }
    let (source, object) = (folder.join(format!("{}.c", monitor.interface.prefix)), folder.join("monitor.o"));
    compile_with(
        Command::new("arm-none-eabi-gcc").args(C_FLAGS).args(CPU).args(["-Os", "-c", "-o"]).arg(&object).arg(&source),
    )?;
    measured(&object)
}

/// What an object file has: code and constants, data, and data that is zero at first.
fn measured(object: &Path) -> Result<[usize; 3], String> {
    let failed = |e: std::io::Error| format!("arm-none-eabi-size: {e}");
    let output = Command::new("arm-none-eabi-size").arg(object).output().map_err(failed)?;
    let text = String::from_utf8_lossy(&output.stdout).into_owned();
    let numbers = text.lines().nth(1).into_iter().flat_map(str::split_whitespace).filter_map(|w| w.parse().ok());
    let sizes: Vec<usize> = numbers.take(3).collect();
    sizes.try_into().map_err(|_| format!("`{text}` is not what arm-none-eabi-size prints"))
}

/// The properties of the soccer robot.
pub const SOCCER: [&str; 6] = [
    "init",
    "ball_in_front_until_kick",
    "ball_close_at_kick",
    "always_ir",
    "goto_goal_until_in_range",
    "eventually_kicks",
];

/// What a monitor takes of a small machine, in bytes.
#[derive(Clone, PartialEq, Eq, Debug)]
pub struct Size {
    /// The property, or what they are together.
    pub name: String,
    /// Code and constants, compiled for size.
    pub code: usize,
    /// What a monitor remembers.
    pub memory: usize,
}

/// The sizes of the soccer robot's monitors, each alone, then all together.
pub fn sizes(folder: &Path) -> Result<Vec<Size>, String> {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../examples/soccer/soccer.rv");
    let spec = lapwing::Spec::load(&path).map_err(|e| e.to_string())?;
    let of = |name: &str, properties: &[&str]| {
        let options = lapwing_codegen::Options {
            language: lapwing_codegen::Language::C,
            name: "soccer".to_owned(),
            capacity: lapwing_codegen::CAPACITY,
            properties: properties.iter().map(|p| (*p).to_owned()).collect(),
        };
        let generated = lapwing_codegen::generate(&spec.alone().spec, spec.name(), &options);
        let generated = generated.map_err(|why| format!("{name}: {why:?}"))?;
        let [code, data, zero] = size(&generated, folder)?;
        if data + zero > 0 {
            return Err(format!("{name}: {} bytes outside of the monitor", data + zero));
        }
        Ok(Size { name: name.to_owned(), code, memory: memory(folder)? })
    };
    let mut table: Vec<Size> = SOCCER.iter().map(|name| of(name, &[name])).collect::<Result<_, String>>()?;
    table.push(of("all six", &SOCCER)?);
    Ok(table)
}

/// The size of a monitor in the header that stands in that folder: that of an array as long.
fn memory(folder: &Path) -> Result<usize, String> {
    let (source, object) = (folder.join("memory.c"), folder.join("memory.o"));
    put(&source, "#include \"soccer.h\"\nsoccer_monitor monitor;\n")?;
    compile_with(Command::new("arm-none-eabi-gcc").args(CPU).args(["-std=c99", "-c", "-o"]).arg(&object).arg(&source))?;
    let [_, _, zero] = measured(&object)?;
    Ok(zero)
}
