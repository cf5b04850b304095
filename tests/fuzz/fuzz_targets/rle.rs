//! libFuzzer target for `suite_tests::rle`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| suite_tests::rle(bytes));
