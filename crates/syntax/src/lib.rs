//! The text of a specification: lexer, parser, syntax tree, formatter.

#![forbid(unsafe_code)]

pub mod ast;
