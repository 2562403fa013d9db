//! rosbag2's SQLite files: tables of topics, messages and, in newer ones, definitions.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use lapwing_stream::Time;
use rusqlite::{Connection, OpenFlags, OptionalExtension};

use super::types::{Declared, Said, message_type};
use super::{Channel, Head, Source};
use crate::definition::{Library, normal_name};
use crate::error::{Losses, OpenError, Place, Position, ReadError};
use crate::options::Limits;

/// What every SQLite file begins with.
pub(crate) const MAGIC: &[u8] = b"SQLite format 3\0";
/// Rows asked for at a time, without their data.
const BATCH: i64 = 4096;

/// A rosbag2 SQLite file.
pub(crate) struct Sqlite {
    db: Connection,
    path: PathBuf,
    limits: Limits,
    channels: Vec<Channel>,
    by_topic: BTreeMap<i64, usize>,
    /// Row, topic and stamp of the next messages, the last first.
    batch: Vec<(i64, i64, i64)>,
    row: i64,
    last_row: i64,
    data: Vec<u8>,
    /// Bytes of the file and bytes that it says it has, where these are more.
    cut_off: Option<(u64, u64)>,
    /// The row after which none can be read, and why.
    broken: Option<(i64, String)>,
    ended: bool,
}

/// A query that failed, and what for.
struct Fault(rusqlite::Error);

impl From<rusqlite::Error> for Fault {
    fn from(error: rusqlite::Error) -> Fault {
        Fault(error)
    }
}

impl Sqlite {
    /// Opens a file. `shown` is what it is called in messages.
    pub fn open(path: &Path, shown: &Path, library: &Library, limits: &Limits) -> Result<Sqlite, OpenError> {
        let cut_off = cut_off(path).map_err(|error| OpenError::Io { path: shown.to_owned(), error })?;
        let damaged = |error: rusqlite::Error| {
            let cut = cut_off
                .map_or_else(String::new, |(have, want)| format!("only {have} of its {want} bytes are there, and "));
            let what = format!("{cut}it cannot be read as a rosbag2 database: {error}{}", rescue(shown, &error));
            OpenError::Damaged { at: Place::new(shown, Position::Whole), what }
        };
        let db = Connection::open_with_flags(path, OpenFlags::SQLITE_OPEN_READ_ONLY | OpenFlags::SQLITE_OPEN_NO_MUTEX)
            .map_err(damaged)?;
        if cut_off.is_some() {
            // SQLite refuses a database that lacks pages, unless it is about to be mended; the file stays as it is, being opened to be read.
            db.pragma_update(None, "writable_schema", true).map_err(damaged)?;
        }
        let mut sqlite = Sqlite {
            db,
            path: shown.to_owned(),
            limits: limits.clone(),
            channels: Vec::new(),
            by_topic: BTreeMap::new(),
            batch: Vec::new(),
            row: i64::MIN,
            last_row: i64::MAX,
            data: Vec::new(),
            cut_off,
            broken: None,
            ended: false,
        };
        sqlite.learn(library).map_err(|Fault(error)| damaged(error))?;
        Ok(sqlite)
    }

    fn learn(&mut self, library: &Library) -> Result<(), Fault> {
        let definitions = self.definitions()?;
        let mut topics = self.db.prepare("SELECT id, name, type, serialization_format FROM topics ORDER BY id")?;
        let mut rows = topics.query([])?;
        let mut declared: BTreeMap<(String, String), Arc<Declared>> = BTreeMap::new();
        while let Some(row) = rows.next()? {
            if self.channels.len() >= self.limits.names {
                break;
            }
            let (id, topic, name, format): (i64, String, String, String) =
                (row.get(0)?, row.get(1)?, row.get(2)?, row.get(3)?);
            let (encoding, definition) = definitions.get(&name).map_or(("", ""), |(e, d)| (e, d));
            let said = Said { name: &name, encoding, definition: definition.as_bytes(), messages: &format };
            self.by_topic.insert(id, self.channels.len());
            self.channels.push(Channel {
                topic: Arc::from(topic),
                type_name: normal_name(&name),
                ty: message_type(&said, library),
                note: String::new(),
                messages: None,
                declared: Some(
                    declared.entry((name.clone(), format.clone())).or_insert_with(|| Arc::new(said.declared())).clone(),
                ),
            });
        }
        drop(rows);
        drop(topics);
        let last_row = self.db.query_row("SELECT max(rowid) FROM messages", [], |row| row.get::<_, Option<i64>>(0));
        self.last_row = match last_row {
            Ok(row) => row.unwrap_or(0),
            // The last page is the first to be missing, and those before it can be read.
            Err(_) if self.cut_off.is_some() => 0,
            Err(error) => return Err(error.into()),
        };
        Ok(())
    }

    /// The definitions that the file carries, by their type; older ones carry none.
    fn definitions(&self) -> Result<BTreeMap<String, (String, String)>, Fault> {
        let table = "SELECT 1 FROM sqlite_master WHERE type = 'table' AND name = 'message_definitions'";
        if self.db.query_row(table, [], |_| Ok(())).optional()?.is_none() {
            return Ok(BTreeMap::new());
        }
        let mut all = BTreeMap::new();
        let mut query =
            self.db.prepare("SELECT topic_type, encoding, encoded_message_definition FROM message_definitions")?;
        let mut rows = query.query([])?;
        while let Some(row) = rows.next()? {
            if all.len() >= self.limits.names {
                break;
            }
            all.insert(row.get(0)?, (row.get(1)?, row.get(2)?));
        }
        Ok(all)
    }

    /// Counts the messages of each topic, which reads the whole table: for a file without metadata.
    pub fn count(&mut self) {
        let counted = || -> Result<Vec<(i64, i64)>, rusqlite::Error> {
            let mut query = self.db.prepare("SELECT topic_id, count(*) FROM messages GROUP BY topic_id")?;
            let rows = query.query_map([], |row| Ok((row.get(0)?, row.get(1)?)))?;
            rows.collect()
        };
        // Without counts nothing is lost: a damaged table says so when it is read.
        let Ok(counts) = counted() else { return };
        for channel in &mut self.channels {
            channel.messages = Some(0);
        }
        for (topic, count) in counts {
            if let Some(channel) = self.by_topic.get(&topic) {
                self.channels[*channel].messages = u64::try_from(count).ok();
            }
        }
    }

    fn refill(&mut self) -> Result<(), Fault> {
        let mut query = self.db.prepare_cached(
            "SELECT rowid, topic_id, timestamp FROM messages WHERE rowid > ?1 ORDER BY rowid LIMIT ?2",
        )?;
        let mut rows = query.query([self.row, BATCH])?;
        let mut before = self.row;
        while let Some(row) = rows.next()? {
            let one: (i64, i64, i64) = (row.get(0)?, row.get(1)?, row.get(2)?);
            // A damaged tree may lead back: reading would then never end.
            if one.0 <= before {
                return Err(Fault(rusqlite::Error::IntegralValueOutOfRange(0, one.0)));
            }
            before = one.0;
            self.batch.push(one);
        }
        self.batch.reverse();
        Ok(())
    }

    fn fetch(&mut self) -> Result<(), Fault> {
        let mut query = self.db.prepare_cached("SELECT data FROM messages WHERE rowid = ?1")?;
        let mut rows = query.query([self.row])?;
        self.data.clear();
        if let Some(row) = rows.next()? {
            self.data.extend_from_slice(row.get_ref(0)?.as_bytes().map_err(|_| rusqlite::Error::QueryReturnedNoRows)?);
        }
        Ok(())
    }
}

/// What may save more of a damaged database than can be read of it.
fn rescue(path: &Path, error: &rusqlite::Error) -> String {
    match error.sqlite_error_code() {
        Some(rusqlite::ErrorCode::DatabaseCorrupt | rusqlite::ErrorCode::NotADatabase) => {
            format!("; `sqlite3 {} .recover | sqlite3 recovered.db3` may save what else is there", path.display())
        }
        _ => String::new(),
    }
}

/// Whether a database lacks its end. SQLite takes what lacks for zeros, which would pass for a shorter recording.
fn cut_off(path: &Path) -> io::Result<Option<(u64, u64)>> {
    let mut head = Vec::new();
    let file = File::open(path)?;
    let have = file.metadata()?.len();
    file.take(100).read_to_end(&mut head)?;
    let number = |at: usize| head.get(at..at + 4).and_then(|b| b.try_into().ok()).map_or(0, u32::from_be_bytes);
    let page = match head.get(16..18) {
        Some([0, 1]) => 65_536,
        Some([high, low]) => u64::from(*high) << 8 | u64::from(*low),
        _ => 0,
    };
    // The number of pages is that of the file only where the last writer kept it: both counters of changes say so.
    let pages = if number(24) == number(92) { u64::from(number(28)) } else { 0 };
    let want = pages * page;
    Ok((have < want).then_some((have, want)))
}

impl Source for Sqlite {
    fn channels(&self) -> &[Channel] {
        &self.channels
    }

    fn advance(&mut self, losses: &mut Losses) -> Result<Option<(Time, Head)>, ReadError> {
        loop {
            if self.batch.is_empty() && !self.ended {
                if let Err(Fault(error)) = self.refill() {
                    self.ended = true;
                    self.batch.reverse();
                    let last = self.batch.first().map_or(self.row, |(row, ..)| *row);
                    let rescue = rescue(&self.path, &error);
                    self.broken =
                        Some((last.max(0), format!("the rows after this one cannot be read ({error}){rescue}")));
                }
                self.ended |= self.batch.is_empty();
            }
            let Some((row, topic, time)) = self.batch.pop() else {
                if let Some((row, what)) = self.broken.take() {
                    losses.add(Place::new(&self.path, Position::Row(row)), what);
                }
                if let Some((have, want)) = self.cut_off.take() {
                    let what = format!(
                        "the file was cut off here, {} bytes before its end: what was there is lost",
                        want - have
                    );
                    losses.add(Place::new(&self.path, Position::Byte(have)), what);
                }
                return Ok(None);
            };
            self.row = row;
            match self.by_topic.get(&topic) {
                Some(channel) => return Ok(Some((Time(time), Head::Message(*channel)))),
                None => losses.add(
                    self.place(),
                    format!("a message belongs to topic {topic}, which is not in the table: it is lost"),
                ),
            }
        }
    }

    fn payload(&mut self) -> Result<&[u8], String> {
        if let Err(Fault(error)) = self.fetch() {
            return Err(format!("its data cannot be read ({error})"));
        }
        if self.data.len() as u64 > self.limits.record {
            return Err(format!("it has {} bytes, more than the limit: raise Limits::record", self.data.len()));
        }
        Ok(&self.data)
    }

    fn place(&self) -> Place {
        Place::new(&self.path, Position::Row(self.row))
    }

    /// In rows: how large each is, the database does not say.
    fn progress(&self) -> (u64, u64) {
        (self.row.max(0) as u64, self.last_row.max(0) as u64)
    }
}
