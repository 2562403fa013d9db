//! What the thesis prints in figures 4.10 to 4.15, by the names of `soccer.rv`, and why what comes out here is not always the same.

use crate::fault::Fault;

/// A figure: the sequence of events of one property's monitor in a run without and in a run with a violation.
#[derive(Debug)]
pub struct Figure {
    /// Its number.
    pub number: &'static str,
    /// The property, as `soccer.rv` calls it.
    pub property: &'static str,
    /// How it is violated here.
    pub fault: Fault,
    /// How the thesis had it violated.
    pub provoked: &'static str,
    /// The printed sequence without a violation, what its monitor does not step on included. Where the figure has `…` one of what repeats stands
    /// for all; `!` is the violation.
    pub without: &'static [&'static str],
    /// The printed sequence with a violation.
    pub with: &'static [&'static str],
    /// What explains the left column.
    pub why_without: &'static [&'static Reason],
    /// What explains the right one.
    pub why_with: &'static [&'static Reason],
}

/// Why something is not as it is printed.
#[derive(Debug, PartialEq)]
pub struct Reason {
    /// The letter by which the table refers to it.
    pub letter: char,
    /// Why.
    pub text: &'static str,
    /// Whether it makes the compared sequences differ.
    pub changes_sequence: bool,
}

const fn differs(letter: char, text: &'static str) -> Reason {
    Reason { letter, text, changes_sequence: true }
}

const fn remark(letter: char, text: &'static str) -> Reason {
    Reason { letter, text, changes_sequence: false }
}

/// All of them, in the order of their letters.
pub static REASONS: [&Reason; 9] = [
    &IN_GOAL_RANGE,
    &LOOKS_ONCE_MORE,
    &BALL_CLOSE,
    &MISSED_RANGE,
    &EPISODES,
    &STALE_FLAGS,
    &APPENDIX_J,
    &FIRST_POSITION,
    &LOST_AGAIN,
];

static IN_GOAL_RANGE: Reason = differs(
    'a',
    "The figure prints `in_goal_range_true`, twelve times, an event that the monitor of appendix N does not have, and nothing of the `goto_goal_true` \
     that it has. That comes once, when `goto_goal` returns. After that our robot looks once more (see b), and is where it can kick.",
);
static LOOKS_ONCE_MORE: Reason = differs(
    'b',
    "Our robot looks once more between its arrival and the kick. The thesis watches one property at a time, and needs no run in which all hold: in \
     figure 4.13 the robot is seen in the kicking state before it kicks, and while it dribbles, which figure 4.11 forbids. In figure 4.12 that state \
     is noted by any call of the state's condition, also after the kick.",
);
static BALL_CLOSE: Reason = remark(
    'c',
    "The figure prints `ballclose_true` and `ballclose_false`, which the monitor of appendix K does not have. With them in its alphabet the position \
     before the kick would be one of them, and the property violated in the healthy run.",
);
static MISSED_RANGE: Reason = remark(
    'd',
    "The text says that the robot kicked before it was in range; the printed `kick_ball_state_true` says that it was in range and that `goto_goal` had \
     not returned. The fault `range-missed` does what is printed, `kick-out-of-range` what is said: that violates ball_close_at_kick.",
);
static EPISODES: Reason = remark(
    'e',
    "The thesis calls its handler at every failed reading. Lapwing tells failures at consecutive positions as one episode, and calls it once, until \
     it has reset the property.",
);
static STALE_FLAGS: Reason = remark(
    'f',
    "The formula asks for the ball in front from the first look after `turn_to_ball_state_true`. By the thesis's event generator that state is entered \
     inside of a look that finds no ball, which then returns false; the printed `ballinfront_true` takes flags that are left from an earlier look. Here the \
     diagram enters the state when the match begins, as the text describes it.",
);
static APPENDIX_J: Reason = remark(
    'g',
    "The recovery of appendix J loops as long as readings succeed, and is commented out; that of section 3.5.4 is the one that runs here, with the loop \
     the other way round.",
);
static FIRST_POSITION: Reason = remark(
    'h',
    "The formulas of figures 4.12 and 4.13 have no `[]`. JavaMOP judges such a formula at the first event alone; the thesis's text means every \
     event, and so does Lapwing.",
);

static LOST_AGAIN: Reason = remark(
    'i',
    "In the figure the property is violated twice more, when the robot turns to the ball again and the look in which it enters that state finds none \
     (see f). Here the robot has the ball from the first recovery on.",
);

const TURN_TO_BALL: &str = "entered(soccer.turn_to_ball)";
const TURN_TO_GOAL: &str = "entered(soccer.turn_to_goal)";
const DRIBBLE: &str = "entered(soccer.dribble_to_goal)";
const KICK: &str = "entered(soccer.kick_ball_to_goal)";
const IN_RANGE: &str = "in_goal_range_true";

/// The figures.
pub static FIGURES: [Figure; 6] = [
    Figure {
        number: "4.10",
        property: "init",
        fault: Fault::Unplugged,
        provoked: "a part of `Init` commented out",
        without: &["ready_true", "play_before"],
        with: &["ready_false", "play_before", "!"],
        why_without: &[],
        why_with: &[],
    },
    Figure {
        number: "4.11",
        property: "goto_goal_until_in_range",
        fault: Fault::RangeMissed,
        provoked: "not told",
        without: &[
            DRIBBLE,
            TURN_TO_GOAL,
            DRIBBLE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
            IN_RANGE,
        ],
        with: &[DRIBBLE, DRIBBLE, TURN_TO_GOAL, DRIBBLE, KICK, "!"],
        why_without: &[&IN_GOAL_RANGE],
        why_with: &[&MISSED_RANGE],
    },
    Figure {
        number: "4.12",
        property: "eventually_kicks",
        fault: Fault::KickLeftOut,
        provoked: "the call of `KickBall` left out",
        without: &["kick_ball_after", KICK, "game_over"],
        with: &["game_over", "!", KICK],
        why_without: &[&LOOKS_ONCE_MORE, &FIRST_POSITION],
        why_with: &[&LOOKS_ONCE_MORE],
    },
    Figure {
        number: "4.13",
        property: "ball_close_at_kick",
        fault: Fault::KickAtOnce,
        provoked: "`KickBall` called at the beginning of `Play`",
        without: &["ballclose_false", "ballclose_true", KICK, "ballclose_true", "kick_ball_before", "ballclose_false"],
        with: &["kick_ball_before", "!"],
        why_without: &[&BALL_CLOSE, &FIRST_POSITION],
        why_with: &[],
    },
    Figure {
        number: "4.14",
        property: "always_ir",
        fault: Fault::BallOff,
        provoked: "the ball switched off",
        without: &["ir_read_true"],
        with: &[
            "ir_read_true",
            "ir_read_false",
            "!",
            "ir_read_true",
            "ir_read_false",
            "!",
            "ir_read_false",
            "!",
            "ir_read_false",
            "!",
            "ir_read_false",
            "!",
            "ir_read_false",
            "!",
            "ir_read_true",
        ],
        why_without: &[],
        why_with: &[&EPISODES, &APPENDIX_J],
    },
    Figure {
        number: "4.15",
        property: "ball_in_front_until_kick",
        fault: Fault::BallTakenAfterTurn,
        provoked: "the ball moved by hand after the turn",
        without: &[TURN_TO_BALL, "ballinfront_true", "kick_ball_after", "ballinfront_true"],
        with: &[
            TURN_TO_BALL,
            "ballinfront_false",
            "!",
            "ballinfront_false",
            "ballinfront_true",
            TURN_TO_BALL,
            "ballinfront_false",
            "!",
            "ballinfront_false",
            "ballinfront_true",
            TURN_TO_BALL,
            "ballinfront_false",
            "!",
            "ballinfront_true",
            "kick_ball_after",
            "ballinfront_true",
        ],
        why_without: &[&STALE_FLAGS],
        why_with: &[&LOST_AGAIN],
    },
];
