//! A stream that may have nothing to give for a long time, as standard input has, and is to be left all the same when the user stops.

use std::io::{self, Read};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, sync_channel};
use std::thread;
use std::time::Duration;

/// Bytes read at a time.
const BLOCK: usize = 1 << 16;
/// Blocks that are read ahead.
const AHEAD: usize = 2;
/// How often it is asked whether the user has stopped.
const PATIENCE: Duration = Duration::from_millis(50);

/// A stream, read by a thread of its own: one that waits for input cannot be woken.
pub(crate) struct Stream {
    blocks: Receiver<io::Result<Vec<u8>>>,
    block: Vec<u8>,
    /// How much of the block has been given.
    given: usize,
    stopped: fn() -> bool,
}

impl Stream {
    /// What `from` gives, until `stopped` says that nobody wants more: reading then fails.
    pub fn new(from: impl Read + Send + 'static, stopped: fn() -> bool) -> io::Result<Stream> {
        let (to, blocks) = sync_channel(AHEAD);
        thread::Builder::new().name("lapwing-input".to_owned()).spawn(move || pump(from, &to))?;
        Ok(Stream { blocks, block: Vec::new(), given: 0, stopped })
    }
}

/// Sends what can be read, to its end or as long as somebody receives.
fn pump(mut from: impl Read, to: &SyncSender<io::Result<Vec<u8>>>) {
    loop {
        let mut block = vec![0; BLOCK];
        let read = match from.read(&mut block) {
            Ok(0) => return,
            Ok(read) => Ok(read),
            Err(e) if e.kind() == io::ErrorKind::Interrupted => continue,
            Err(e) => Err(e),
        };
        let is_over = read.is_err();
        let sent = to.send(read.map(|read| {
            block.truncate(read);
            block
        }));
        if is_over || sent.is_err() {
            return;
        }
    }
}

impl Read for Stream {
    fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
        while self.given == self.block.len() {
            match self.blocks.recv_timeout(PATIENCE) {
                Ok(block) => (self.block, self.given) = (block?, 0),
                Err(RecvTimeoutError::Disconnected) => return Ok(0),
                Err(RecvTimeoutError::Timeout) if (self.stopped)() => return Err(io::Error::other("interrupted")),
                Err(RecvTimeoutError::Timeout) => {}
            }
        }
        let count = into.len().min(self.block.len() - self.given);
        into[..count].copy_from_slice(&self.block[self.given..self.given + count]);
        self.given += count;
        Ok(count)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Gives a few bytes, and then nothing for ever.
    struct Silent(bool);

    impl Read for Silent {
        fn read(&mut self, into: &mut [u8]) -> io::Result<usize> {
            while std::mem::replace(&mut self.0, true) {
                thread::park();
            }
            into[..3].copy_from_slice(b"abc");
            Ok(3)
        }
    }

    #[test]
    fn all_is_given_and_then_the_end() {
        let text: Vec<u8> = (0..300_000).map(|k| k as u8).collect();
        let mut read = Vec::new();
        Stream::new(io::Cursor::new(text.clone()), || true).unwrap().read_to_end(&mut read).unwrap();
        assert_eq!(read, text);
    }

    #[test]
    fn who_has_stopped_does_not_wait() {
        let mut stream = Stream::new(Silent(false), || true).unwrap();
        let mut bytes = [0; 8];
        assert_eq!(stream.read(&mut bytes).unwrap(), 3);
        assert_eq!(stream.read(&mut bytes).unwrap_err().to_string(), "interrupted");
    }
}
