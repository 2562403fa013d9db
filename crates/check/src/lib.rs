//! From syntax to meaning: names, types, dimensions and scopes; then to a program for the engine.

#![forbid(unsafe_code)]

pub mod checked;
