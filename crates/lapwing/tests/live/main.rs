//! Live runs over a graph that is made up: what happens on it, and when, is a list.

mod agreement;
mod blindness;
mod reactions;
mod script;
mod time;
mod views;
