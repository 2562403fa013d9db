//! The command line.
//!
//! Each command is a module that reads its arguments, calls the library and gives an [`Exit`]; nothing here judges anything.

#![forbid(unsafe_code)]

mod args;
mod exit;
mod library;

mod backtest;
mod bip;
mod check;
mod codegen;
mod demo;
mod explain;
mod fmt;
mod genom;
mod import;
mod monitor;
mod new;
mod replay;
mod sim;

mod capsules;
mod complain;
mod graph;
mod interrupt;
mod jobs;
mod onlooker;
mod page;
mod progress;
mod sink;
mod words;

use std::process::ExitCode;

use clap::Parser;

use args::{Arguments, Command};
use exit::Exit;

fn main() -> ExitCode {
    let arguments = Arguments::parse();
    let exit = match arguments.command {
        Command::Demo(demo) => demo::run(&demo),
        Command::Check(check) => check::run(&check),
        Command::Replay(replay) => replay::run(&replay),
        Command::Backtest(backtest) => backtest::run(&backtest),
        Command::Genom(genom) => genom::run(&genom),
        Command::Bip(bip) => bip::run(&bip),
        Command::Import(import) => import::run(&import),
        Command::Codegen(codegen) => codegen::run(&codegen),
        Command::Explain(explain) => explain::run(&explain),
        Command::Fmt(fmt) => fmt::run(&fmt),
        Command::New(new) => new::run(&new),
        Command::Monitor(monitor) => monitor::run(&monitor),
        Command::Sim(sim) => sim::run(&sim),
    };
    exit.unwrap_or_else(|complaint| {
        complaint.tell();
        Exit::Wrong
    })
    .into()
}
