//! Chores of the repository that tests share with the command line.

#![forbid(unsafe_code)]

pub mod agree;
pub mod big;
pub mod codegen;
pub mod exhaustive;
pub mod generated;
pub mod patterns;
pub mod random;
pub mod robots;
pub mod robust;
pub mod suite;
pub mod tidy;
