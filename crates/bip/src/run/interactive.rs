//! Steps that somebody chooses, one line for each.

use super::Choice;
use crate::engine::Engine;
use crate::log::Log;
use crate::schedule::Scheduler;
use std::io::BufRead;

/// No answer is longer: who sends more is no human.
const MAX_ANSWER: u64 = 1000;

/// Asks which of the possible moves is to be made, until the answer makes sense or there is none.
pub(super) fn choose<H>(
    engine: &Engine<H>,
    scheduler: &mut Scheduler,
    log: &Log<'_>,
    input: &mut Box<dyn BufRead + '_>,
) -> Choice {
    let offers = engine.offers();
    let last = offers.len().saturating_sub(1);
    loop {
        log.prompt(&format!("-> enter a number (0..{last}), 'r' for a random choice, 'q' to quit: "));
        let mut answer = String::new();
        let read = std::io::Read::take(&mut *input, MAX_ANSWER).read_line(&mut answer);
        if !read.is_ok_and(|length| length > 0) {
            log.prompt("\n");
            return Choice::Quit;
        }
        match answer.trim() {
            "q" => return Choice::Quit,
            "r" => {
                if let Some((id, at)) = scheduler.choose(engine) {
                    return Choice::Make(id, at);
                }
            }
            number => {
                if let Some(offer) = number.parse::<usize>().ok().and_then(|n| offers.get(n)) {
                    return Choice::Make(offer.id, scheduler.plan(offer.window));
                }
            }
        }
        log.prompt(&format!("`{}` is no choice\n", answer.trim()));
    }
}
