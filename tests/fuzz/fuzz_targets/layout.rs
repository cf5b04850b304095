//! libFuzzer target for `suite_tests::layout`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| suite_tests::layout(bytes));
