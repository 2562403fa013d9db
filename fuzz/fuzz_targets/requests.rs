//! The target `requests`; what it does stands in `xtask::robust`.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|data: &[u8]| xtask::robust::target("requests")(data));
