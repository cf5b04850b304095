//! libFuzzer target for `suite_tests::sdl`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| suite_tests::sdl(bytes));
