//! Components, interfaces, tasks, ports, and what is said of them.

use super::expr::joined;
use super::{Parser, Read};
use crate::ast::{
    Body, Export, Ident, Order, Port, Property, PropertyKind, Relation, ServiceKind, Task, TextProperty, TimeProperty,
};

impl Parser<'_> {
    /// A component or an interface, without its semicolon.
    pub(super) fn body(&mut self) -> Read<Body> {
        let is_interface = self.bump().is_word("interface");
        let what = if is_interface { "interface" } else { "component" };
        let name = self.name(&format!("the name of the {what}"))?;
        let exports = if self.is("{") { self.braced(what, Parser::export)? } else { Vec::new() };
        Ok(Body { is_interface, name, exports })
    }

    fn export(&mut self) -> Read<Export> {
        let export = match self.word() {
            "ids" => {
                let word = self.bump();
                let place = Ident { name: "ids".to_owned(), span: word.span };
                Export::Ids(place, self.members("internal data")?)
            }
            "task" => {
                self.bump();
                let name = self.name("the name of the task")?;
                Export::Task(Task { name, properties: self.properties("task")? })
            }
            "port" => Export::Port(self.port()?),
            "attribute" => Export::Service(self.service(ServiceKind::Attribute)?),
            "function" => Export::Service(self.service(ServiceKind::Function)?),
            "activity" => Export::Service(self.service(ServiceKind::Activity)?),
            "native" | "exception" => Export::Decl(self.declaration()?),
            _ if self.begins_declaration() => Export::Decl(self.declaration()?),
            _ => match self.property()? {
                Some(property) => Export::Property(property),
                None => return Err(self.expected(
                    "a part of the component (ids, task, port, attribute, function, activity, a property or a type)",
                )),
            },
        };
        self.semicolon()?;
        Ok(export)
    }

    fn port(&mut self) -> Read<Port> {
        self.bump();
        let second = self.peek_second();
        let multiple = self.peek().is_word("multiple") && (second.is_word("in") || second.is_word("out"));
        if multiple {
            self.bump();
        }
        let is_out = self.eat_word("out");
        if !is_out && !self.eat_word("in") {
            return Err(self.expected("`in` or `out`"));
        }
        let ty = self.ty()?;
        let name = self.name("the name of the port")?;
        Ok(Port { name, multiple, is_out, ty, properties: self.properties("port")? })
    }

    /// `{ … }` with properties, or nothing.
    pub(super) fn properties(&mut self, what: &str) -> Read<Vec<Property>> {
        if !self.is("{") {
            return Ok(Vec::new());
        }
        self.braced(what, |parser| {
            let Some(property) = parser.property()? else { return Err(parser.expected("a property")) };
            parser.semicolon()?;
            Ok(property)
        })
    }

    /// A property without its semicolon; `None` where no property begins here.
    fn property(&mut self) -> Read<Option<Property>> {
        let text = self.word().to_owned();
        // GenoM3 takes these words in the singular and in the plural.
        let singular = match text.as_str() {
            "requires" | "codels-requires" | "throws" | "interrupts" | "extends" | "provides" | "uses" => {
                text.trim_end_matches('s')
            }
            other => other,
        };
        if !PROPERTIES.contains(&singular) {
            return Ok(None);
        }
        let token = self.bump();
        let word = Ident { name: text.clone(), span: token.span };
        let kind = self.property_kind(singular)?;
        Ok(Some(Property { word, kind }))
    }

    fn property_kind(&mut self, word: &str) -> Read<PropertyKind> {
        let text = |kind| move |(text, _)| PropertyKind::Text(kind, text);
        Ok(match word {
            "doc" => self.strings().map(text(TextProperty::Doc))?,
            "version" => self.strings().map(text(TextProperty::Version))?,
            "lang" => self.strings().map(text(TextProperty::Lang))?,
            "email" => self.strings().map(text(TextProperty::Email))?,
            "require" => PropertyKind::Require(false, self.texts()?),
            "codels-require" => PropertyKind::Require(true, self.texts()?),
            "clock-rate" => PropertyKind::Time(TimeProperty::ClockRate, self.quantity()?),
            "period" => PropertyKind::Time(TimeProperty::Period, self.quantity()?),
            "delay" => PropertyKind::Time(TimeProperty::Delay, self.quantity()?),
            "provide" => PropertyKind::Interfaces(Relation::Provides, self.names("an interface")?),
            "use" => PropertyKind::Interfaces(Relation::Uses, self.names("an interface")?),
            "extend" => PropertyKind::Interfaces(Relation::Extends, self.names("an interface")?),
            "priority" => PropertyKind::Priority(self.expr()?),
            "scheduling" => match self.eat_word("real-time") {
                true => PropertyKind::RealTime,
                false => return Err(self.expected("`real-time`")),
            },
            "stack" => {
                let size = self.expr()?;
                let unit = match self.word() {
                    "k" => 1 << 10,
                    "M" => 1 << 20,
                    _ => return Ok(PropertyKind::Stack(size, 1)),
                };
                self.bump();
                PropertyKind::Stack(size, unit)
            }
            "throw" => PropertyKind::Throws(self.list(|parser| parser.scoped_name("an exception"))?),
            "task" => PropertyKind::Task(self.name("the name of a task")?),
            "interrupt" => PropertyKind::Services(Order::Interrupts, self.names("a service")?),
            "before" => PropertyKind::Services(Order::Before, self.names("a service")?),
            "after" => PropertyKind::Services(Order::After, self.names("a service")?),
            "validate" => PropertyKind::Validate(self.codel(false)?),
            "local" => {
                let ty = self.ty()?;
                PropertyKind::Local(ty, self.list(Parser::declarator)?)
            }
            "async" if !self.eat_word("codel") => return Err(self.expected("`codel`")),
            word => PropertyKind::Codel(self.codel(word == "async")?),
        })
    }

    fn names(&mut self, what: &str) -> Read<Vec<Ident>> {
        self.list(|parser| parser.name(what))
    }

    /// Texts with commas between.
    fn texts(&mut self) -> Read<Vec<String>> {
        self.list(|parser| parser.strings().map(|(text, _)| text))
    }

    /// From a place to the end of what has just been read.
    pub(super) fn until_here(&self, start: lapwing_diag::Span) -> lapwing_diag::Span {
        let end = self.tokens.get(self.at.saturating_sub(1)).map_or(start, |t| t.span);
        joined(start, end)
    }
}

/// Words that begin a property, in the singular.
const PROPERTIES: &[&str] = &[
    "doc",
    "version",
    "lang",
    "email",
    "require",
    "codels-require",
    "clock-rate",
    "period",
    "delay",
    "provide",
    "use",
    "extend",
    "priority",
    "scheduling",
    "stack",
    "throw",
    "task",
    "interrupt",
    "before",
    "after",
    "validate",
    "local",
    "async",
    "codel",
];
