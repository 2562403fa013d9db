//! What the host answers violations with: closures under the names that the specification calls them by.

use std::collections::BTreeMap;
use std::fmt;

use lapwing::News;
use lapwing_react::Reading;
use lapwing_react::shown::Origin;
use lapwing_stream::{Time, Value};

/// A violation, as a handler sees it.
#[derive(Clone, Copy, Debug)]
pub struct Violation<'v> {
    news: &'v News,
}

impl<'v> Violation<'v> {
    pub(crate) fn new(news: &'v News) -> Violation<'v> {
        Violation { news }
    }

    /// The property, with its instance: `always_ir`, `always_ir[r1]`.
    pub fn property(&self) -> &'v str {
        &self.news.property.name
    }

    /// The values of its `for each … of`, outermost first; empty where it has none.
    pub fn instance(&self) -> &'v [Value] {
        &self.news.instance
    }

    /// Where the property stands: file, line and column, from 1.
    pub fn place(&self) -> (&'v str, usize, usize) {
        (&self.news.property.file, self.news.property.line, self.news.property.column)
    }

    /// The text of the property.
    pub fn text(&self) -> &'v str {
        &self.news.property.text
    }

    /// When the obligation that failed began.
    pub fn began(&self) -> Time {
        self.news.violation.began
    }

    /// When it failed.
    pub fn failed(&self) -> Time {
        self.news.violation.failed
    }

    /// The value of everything that the property reads, when it failed.
    pub fn values(&self) -> &'v [Reading] {
        self.news.violation.values.as_deref().unwrap_or_default()
    }

    /// One of them, by the name that the specification gives it.
    pub fn value(&self, name: &str) -> Option<&'v Value> {
        self.values().iter().find(|r| r.name == name).map(|r| &r.value)
    }

    /// Everything that a report says of it: the values when it began, what led to it, a machine's move.
    pub fn details(&self) -> &'v lapwing_react::Violation {
        &self.news.violation
    }
}

impl fmt::Display for Violation<'_> {
    /// One line: `soccer.rv:12: init is violated at 3.5 s`. As in reports, times that count in some calendar are shown from the first arrival.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (file, line, _) = self.place();
        let failed = Origin::of_start(self.news.start).time(self.failed());
        write!(f, "{file}:{line}: {} is violated at {failed}", self.property())?;
        self.details().why.as_ref().map_or(Ok(()), |why| write!(f, ": {why}"))
    }
}

/// A handler that knows the host's context already.
pub(crate) type Handler = Box<dyn Fn(&Violation<'_>) + Send + Sync>;

/// Handlers by the names by which `run NAME` calls them. `C` is the host's context: whatever the handlers need of the program, to be
/// shared between threads.
///
/// ```
/// use std::sync::atomic::{AtomicU32, Ordering};
/// use lapwing_tracing::Handlers;
///
/// #[derive(Default)]
/// struct Robot {
///     searches: AtomicU32,
/// }
///
/// /// What the robot does when it goes wrong: a module of its own, apart from the mission.
/// fn recoveries() -> Handlers<Robot> {
///     Handlers::new().on("find_ball", |violation, robot: &Robot| {
///         println!("{violation}");
///         robot.searches.fetch_add(1, Ordering::Relaxed);
///     })
/// }
/// # assert_eq!(recoveries().names().collect::<Vec<_>>(), ["find_ball"]);
/// ```
pub struct Handlers<C> {
    by_name: BTreeMap<String, WithContext<C>>,
}

type WithContext<C> = Box<dyn Fn(&Violation<'_>, &C) + Send + Sync>;

impl<C> Handlers<C> {
    /// None yet.
    pub fn new() -> Handlers<C> {
        Handlers { by_name: BTreeMap::new() }
    }

    /// Adds a handler; a later one of the same name takes its place.
    #[must_use]
    pub fn on(mut self, name: &str, handler: impl Fn(&Violation<'_>, &C) + Send + Sync + 'static) -> Handlers<C> {
        self.by_name.insert(name.to_owned(), Box::new(handler));
        self
    }

    /// Adds those of another registry.
    #[must_use]
    pub fn and(mut self, others: Handlers<C>) -> Handlers<C> {
        self.by_name.extend(others.by_name);
        self
    }

    /// Their names, in alphabetical order.
    pub fn names(&self) -> impl Iterator<Item = &str> {
        self.by_name.keys().map(String::as_str)
    }
}

impl<C: Send + Sync + 'static> Handlers<C> {
    /// The handlers with the context in them.
    pub(crate) fn bind(self, context: C) -> BTreeMap<String, Handler> {
        let context = std::sync::Arc::new(context);
        let bind = |(name, handler): (String, WithContext<C>)| {
            let context = context.clone();
            let bound: Handler = Box::new(move |violation: &Violation<'_>| handler(violation, &context));
            (name, bound)
        };
        self.by_name.into_iter().map(bind).collect()
    }
}

impl<C> Default for Handlers<C> {
    fn default() -> Handlers<C> {
        Handlers::new()
    }
}

impl<C> fmt::Debug for Handlers<C> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_set().entries(self.names()).finish()
    }
}
