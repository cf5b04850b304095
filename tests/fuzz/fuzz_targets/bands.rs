//! libFuzzer target for `suite_tests::bands`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| suite_tests::bands(bytes));
