//! libFuzzer target for `suite_tests::compiled_scene`.
#![no_main]

libfuzzer_sys::fuzz_target!(|bytes: &[u8]| suite_tests::compiled_scene(bytes));
