//! Decompression within a limit, of what is whole and of what was cut off.

use std::io::{self, Read};

/// A byte of LZ4 cannot stand for more bytes than this.
const LZ4_RATIO: usize = 255;

/// How the bytes of a chunk are compressed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Compression {
    None,
    Lz4,
    Zstd,
    Bz2,
}

impl Compression {
    /// By the name that MCAP and ROS 1 bags have for it.
    pub fn of(name: &[u8]) -> Option<Compression> {
        match name {
            b"" | b"none" => Some(Compression::None),
            b"lz4" => Some(Compression::Lz4),
            b"zstd" => Some(Compression::Zstd),
            b"bz2" => Some(Compression::Bz2),
            _ => None,
        }
    }
}

/// Decompresses into `out`, reusing its memory, and its working memory from one chunk to the next.
#[derive(Default)]
pub(crate) struct Decompressor {
    zstd: Option<zstd::bulk::Decompressor<'static>>,
}

impl Decompressor {
    /// All of `data`, which must come to exactly `size` bytes. The caller has held `size` against its limit.
    pub fn whole(&mut self, how: Compression, data: &[u8], size: usize, out: &mut Vec<u8>) -> Result<(), String> {
        if how != Compression::Lz4 {
            out.clear();
        }
        let done = match how {
            Compression::Zstd => self.zstd(data, size, out),
            Compression::Lz4 if size <= data.len().saturating_mul(LZ4_RATIO) => {
                fill(lz4::Decoder::new(data), size, out)
            }
            _ => part(how, data, size as u64 + 1, out),
        };
        done.map_err(|e| format!("it cannot be decompressed ({e})"))?;
        if out.len() != size {
            return Err(format!("it was to hold {size} bytes and holds {}", out.len()));
        }
        Ok(())
    }

    fn zstd(&mut self, data: &[u8], size: usize, out: &mut Vec<u8>) -> io::Result<()> {
        out.reserve_exact(size);
        let decompressor = match &mut self.zstd {
            Some(ready) => ready,
            none => none.insert(zstd::bulk::Decompressor::new()?),
        };
        decompressor.decompress_to_buffer(data, out).map(drop)
    }
}

/// As much of `data` as can be decompressed, up to `limit` bytes. What was got before an error is kept.
pub(crate) fn part(how: Compression, data: impl Read, limit: u64, out: &mut Vec<u8>) -> io::Result<()> {
    out.clear();
    match how {
        Compression::None => pour(data, limit, out),
        Compression::Lz4 => pour(lz4::Decoder::new(data)?, limit, out),
        Compression::Zstd => pour(zstd::stream::read::Decoder::new(data)?, limit, out),
        Compression::Bz2 => pour(bzip2::read::MultiBzDecoder::new(data), limit, out),
    }
}

/// PERF: into memory that is there already, where what is promised can be in the data.
fn fill(from: io::Result<impl Read>, size: usize, out: &mut Vec<u8>) -> io::Result<()> {
    let mut from = from?;
    // One byte more than promised, to see that nothing follows.
    out.resize(size + 1, 0);
    let mut filled = 0;
    while filled <= size {
        match from.read(&mut out[filled..])? {
            0 => break,
            read => filled += read,
        }
    }
    out.truncate(filled);
    Ok(())
}

fn pour(from: impl Read, limit: u64, out: &mut Vec<u8>) -> io::Result<()> {
    from.take(limit).read_to_end(out).map(drop)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_cut_off_chunk_gives_what_was_there() {
        let data: Vec<u8> = (0..200_000u32).flat_map(|n| (n.wrapping_mul(2_654_435_761)).to_le_bytes()).collect();
        let packed = zstd::bulk::compress(&data, 1).unwrap();
        let mut out = Vec::new();
        assert!(part(Compression::Zstd, &packed[..packed.len() / 2], 1 << 30, &mut out).is_err());
        assert!(out.len() > 1000 && data.starts_with(&out));
    }

    #[test]
    fn more_than_promised_is_refused() {
        let bomb = zstd::bulk::compress(&vec![0; 10_000_000], 1).unwrap();
        let mut out = Vec::new();
        assert!(Decompressor::default().whole(Compression::Zstd, &bomb, 1000, &mut out).is_err());
        assert!(out.capacity() < 100_000);
    }
}
