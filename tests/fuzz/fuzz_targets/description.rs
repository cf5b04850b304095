//! libFuzzer target for `suite_tests::description`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| suite_tests::description(bytes));
