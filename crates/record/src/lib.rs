//! Recordings and message definitions: files of many formats in, decoded fields out.
