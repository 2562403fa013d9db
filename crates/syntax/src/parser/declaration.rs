//! Declarations: `decl`, `model`, `world`, `use`.

use super::{Parse, Parser};
use crate::ast::{Belief, Decl, Ident, Model, Topic, TypePath, Use, World, WorldSource};
use crate::token::{Role, TokenKind};
use crate::words;
use lapwing_diag::{Code, Diagnostic, Span};

impl Parser<'_> {
    /// `NAME /topic Type.field default … stale after …`
    pub(super) fn decl(&mut self) -> Parse<Decl> {
        self.clauses = &["default", "stale"];
        let name = self.ident("the signal's name")?;
        let topic = self.topic("a topic, as in `/odom`")?;
        let ty = self.type_path()?;
        let mut decl = Decl { name, topic, ty, default: None, stale: None };
        loop {
            if decl.default.is_none() && self.eat_word("default") {
                decl.default = Some(*self.sum()?);
            } else if decl.stale.is_none() && self.eat_word("stale") {
                self.word("after")?;
                decl.stale = Some(self.duration()?);
            } else {
                return Ok(decl);
            }
        }
    }

    /// `robot1: position /odom Odometry.pose ;` on as many lines as it takes.
    pub(super) fn model(&mut self) -> Parse<Model> {
        let start = self.first;
        let object = self.ident("the name of the object that is modelled")?;
        self.model_colon()?;
        self.cursor.begin_region();
        let beliefs = self.beliefs(start);
        self.cursor.end_region();
        Ok(Model { object, beliefs: beliefs? })
    }

    /// The colon; where it is missing and a belief follows, the model goes on.
    fn model_colon(&mut self) -> Parse<()> {
        if self.eat(TokenKind::Colon) {
            return Ok(());
        }
        let diagnostic = self.expectation("`:` after the object's name").fix(self.cursor.behind_previous(), ":");
        self.complain(diagnostic).or_else(|reported| {
            self.cursor.begin_region();
            let belief = self.at_name() && matches!(self.cursor.ahead(1), TokenKind::Slash | TokenKind::Name);
            self.cursor.end_region();
            if belief { Ok(()) } else { Err(reported) }
        })
    }

    fn beliefs(&mut self, start: Span) -> Parse<Vec<Belief>> {
        let mut beliefs = Vec::new();
        while !self.eat(TokenKind::Semicolon) {
            if self.statement_follows() {
                let after = self.cursor.behind_previous();
                let diagnostic = Diagnostic::new(Code::Syntax, after, "a model ends with `;`");
                self.report(
                    diagnostic.label("expected `;` here").also(start, "the model begins here").fix(after, " ;"),
                );
                break;
            }
            beliefs.push(self.belief()?);
        }
        Ok(beliefs)
    }

    /// Whether another statement begins here: the end of the model is missing.
    fn statement_follows(&self) -> bool {
        let statement = |word: &str| words::STATEMENTS.contains(&word) || words::is_temporal(word) || word == "not";
        let named = matches!(self.cursor.ahead(1), TokenKind::Colon | TokenKind::Equals);
        self.cursor.at_end() || self.cursor.begins_line() && (named || self.cursor.word().is_some_and(statement))
    }

    /// `position /odom Odometry.pose.pose.position`
    fn belief(&mut self) -> Parse<Belief> {
        let quantity =
            self.ident("what the object believes, as in `position /odom Odometry.pose.pose.position`, or `;`")?;
        let topic = self.topic("a topic, as in `/odom`")?;
        let ty = self.type_path()?;
        Ok(Belief { quantity, topic, ty })
    }

    /// `robot /gt/robot Odometry`, `* topics /{name}/gt PoseStamped`, `robot tf map robot/base_link`
    pub(super) fn world(&mut self) -> Parse<World> {
        let object = match self.cursor.kind() {
            TokenKind::Star => {
                self.cursor.bump(Role::Operator);
                None
            }
            _ => Some(self.ident("the name of an object, or `*` for all")?),
        };
        let source = match (self.cursor.word(), &object) {
            (Some("topics"), _) => self.world_topics()?,
            (Some("tf"), Some(_)) => self.world_frames()?,
            _ => self.world_topic()?,
        };
        Ok(World { object, source })
    }

    fn world_topics(&mut self) -> Parse<WorldSource> {
        self.cursor.bump(Role::Keyword);
        let topic = self.topic_template("a topic, as in `/{name}/gt`")?;
        Ok(WorldSource::Topic { topic, ty: self.world_type()? })
    }

    fn world_topic(&mut self) -> Parse<WorldSource> {
        let topic = self.topic("a topic, `topics` or `tf`")?;
        Ok(WorldSource::Topic { topic, ty: self.world_type()? })
    }

    fn world_type(&mut self) -> Parse<TypePath> {
        self.whole_type("ground truth is a whole message, not a field of one", |_| {
            "its pose and velocity are found by themselves; leave the field out".to_owned()
        })
    }

    fn world_frames(&mut self) -> Parse<WorldSource> {
        self.cursor.bump(Role::Keyword);
        let fixed = self.topic("the frame of the ground truth, as in `map`")?;
        let frame = self.topic("the frame of the object, as in `robot/base_link`")?;
        Ok(WorldSource::Tf { fixed: frame_name(fixed), frame: frame_name(frame) })
    }

    /// `std.robot`, `"mine.rv"`
    pub(super) fn use_statement(&mut self) -> Parse<Use> {
        if self.cursor.kind() == TokenKind::Text {
            let span = self.cursor.span();
            return Ok(Use::File(self.text()?, span));
        }
        self.dotted("a library, as in `std.robot`, or a file in quotation marks").map(Use::Library)
    }
}

/// A frame is named as a topic is.
fn frame_name(topic: Topic) -> Ident {
    Ident { name: topic.name, span: topic.span }
}
