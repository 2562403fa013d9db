//! What is done with each column of a table.

use lapwing_stream::Name;

use super::super::signals::Signals;

/// What is done with each column.
#[derive(Debug)]
pub(super) struct Plan {
    /// In the order of the header.
    pub columns: Vec<Column>,
    /// The decimal places that the unit of time has in nanoseconds.
    pub unit: i64,
}

/// What is done with one column.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Column {
    /// It is the time of the row.
    Time,
    /// It goes to the value of that number.
    Value(usize),
    /// Nobody wants it.
    Unread,
}

impl Plan {
    /// Of a table whose time stands in that column and in that unit; `columns` are the names of the others.
    pub fn new(columns: &[Name], (time, unit): (usize, i64), signals: &Signals) -> Plan {
        let mut plan: Vec<Column> =
            columns.iter().map(|name| signals.slot(name).map_or(Column::Unread, Column::Value)).collect();
        plan.insert(time.min(plan.len()), Column::Time);
        Plan { columns: plan, unit }
    }
}
