//! As much of HTTP as XML-RPC needs: one request with a body and one answer with a body on each connection.
//!
//! What others send has limits. Requests are made in version 1.0, to which nobody answers in chunks.

use std::io::{self, BufRead, BufReader, ErrorKind, Read, Write};
use std::time::Instant;

use super::net::{Endpoint, Timed};

/// What stands before a body is not longer, in bytes.
const MOST_HEAD: u64 = 16 << 10;
/// A body is not longer, in bytes: a graph with ten thousand topics takes a tenth of it.
const MOST_BODY: usize = 16 << 20;

/// Sends a body to a server, and gives that of its answer.
pub(crate) fn post(to: &Endpoint, body: &str, deadline: Instant) -> io::Result<String> {
    let stream = to.connect(deadline)?;
    let mut timed = Timed { stream: &stream, deadline };
    let request = format!(
        "POST /RPC2 HTTP/1.0\r\nHost: {to}\r\nUser-Agent: lapwing\r\nContent-Type: text/xml\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    );
    timed.write_all(request.as_bytes())?;
    let (first, body) = read(timed)?;
    match first.split(' ').nth(1) {
        Some("200") => Ok(body),
        _ => Err(invalid(format!("it answers `{}`", first.chars().take(80).collect::<String>()))),
    }
}

/// The bytes of an answer that goes well.
pub(crate) fn answer(body: &str) -> String {
    format!(
        "HTTP/1.0 200 OK\r\nServer: lapwing\r\nContent-Type: text/xml\r\nConnection: close\r\nContent-Length: {}\r\n\r\n{body}",
        body.len()
    )
}

/// Reads a request or an answer: its first line and its body.
pub(crate) fn read(from: impl Read) -> io::Result<(String, String)> {
    let mut reader = BufReader::new(from);
    let (first, length) = read_head(&mut reader)?;
    let most = length.unwrap_or(MOST_BODY);
    if most > MOST_BODY {
        return Err(invalid(format!("a body of {most} bytes is announced, and {MOST_BODY} is the most")));
    }
    let mut body = Vec::new();
    // One byte more than may be: without a length, what is too long shows by it.
    let limit = if length.is_some() { most } else { most + 1 };
    reader.take(limit as u64).read_to_end(&mut body)?;
    match length {
        Some(length) if body.len() < length => Err(io::Error::new(ErrorKind::UnexpectedEof, "the body ends early")),
        None if body.len() > most => Err(invalid(format!("the body is longer than {MOST_BODY} bytes"))),
        _ => Ok((first, String::from_utf8(body).map_err(|_| invalid("the body is no UTF-8"))?)),
    }
}

/// The first line, and how long the body is, where that is said.
fn read_head(reader: &mut impl BufRead) -> io::Result<(String, Option<usize>)> {
    let mut head = reader.take(MOST_HEAD);
    let first = read_line(&mut head)?;
    let mut length = None;
    loop {
        let line = read_line(&mut head)?;
        if line.is_empty() {
            return Ok((first, length));
        }
        if let Some((name, value)) = line.split_once(':')
            && name.trim().eq_ignore_ascii_case("content-length")
        {
            length = Some(value.trim().parse().map_err(|_| invalid("its content length is no number"))?);
        }
    }
}

fn read_line(head: &mut impl BufRead) -> io::Result<String> {
    let mut line = String::new();
    head.read_line(&mut line)?;
    if !line.ends_with('\n') {
        return Err(io::Error::new(ErrorKind::UnexpectedEof, "the head ends early, or is too long"));
    }
    line.truncate(line.trim_end().len());
    Ok(line)
}

fn invalid(what: impl Into<String>) -> io::Error {
    io::Error::new(ErrorKind::InvalidData, what.into())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_was_written_is_read() {
        let (first, body) = read(answer("<a>é</a>").as_bytes()).unwrap();
        assert_eq!((first.as_str(), body.as_str()), ("HTTP/1.0 200 OK", "<a>é</a>"));
        let (_, body) = read(&b"HTTP/1.1 200 OK\ncontent-LENGTH:  2\n\nabcd"[..]).unwrap();
        assert_eq!(body, "ab");
        let (_, body) = read(&b"HTTP/1.1 200 OK\r\n\r\nup to the end"[..]).unwrap();
        assert_eq!(body, "up to the end");
    }

    #[test]
    fn lies_about_lengths_are_refused() {
        for (text, why) in [
            ("POST / HTTP/1.1\r\nContent-Length: 99999999999\r\n\r\n", "is announced"),
            ("POST / HTTP/1.1\r\nContent-Length: 5\r\n\r\nabc", "ends early"),
            ("POST / HTTP/1.1\r\nContent-Length: -5\r\n\r\nabc", "no number"),
            ("POST / HTTP/1.1\r\nA: b", "ends early"),
            ("", "ends early"),
        ] {
            let error = read(text.as_bytes()).unwrap_err().to_string();
            assert!(error.contains(why), "{text:?}: {error}");
        }
        let endless = std::io::repeat(b'a');
        assert!(read(endless).is_err());
        assert!(read(&b"POST / HTTP/1.1\r\nContent-Length: 1\r\n\r\n\xff"[..]).is_err());
    }
}
