//! Chores of the repository that tests share with the command line.

#![forbid(unsafe_code)]

pub mod agree;
pub mod exhaustive;
pub mod random;
pub mod robust;
pub mod suite;
pub mod tidy;
