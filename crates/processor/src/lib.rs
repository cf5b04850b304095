//! Whether this processor can run what was built.
//!
//! Programs are built for a level of processor (`.cargo/config.toml`). On an older one they would stop at the first
//! instruction it does not know; a message is better. The standard library takes what was built for as given, so
//! the processor itself is asked.

/// Refuses to go on where the processor lacks what this program was built for.
///
/// # Errors
///
/// Says what is missing and how to build for this processor.
pub fn check() -> Result<(), String> {
    match missing() {
        [] => Ok(()),
        missing => Err(format!(
            "this processor lacks {}, which the program was built for; build it with \
             RUSTFLAGS=\"-C target-cpu=x86-64\"",
            missing.join(" and ")
        )),
    }
}

/// Names of what was built for and is not there, of the features that tell levels of processors apart.
#[cfg(all(target_arch = "x86_64", target_feature = "avx2"))]
fn missing() -> &'static [&'static str] {
    let extended = raw_cpuid::CpuId::new().get_extended_feature_info();
    if extended.is_some_and(|features| features.has_avx2() && features.has_bmi2()) {
        &[]
    } else {
        &["AVX2"]
    }
}

#[cfg(not(all(target_arch = "x86_64", target_feature = "avx2")))]
fn missing() -> &'static [&'static str] {
    &[]
}

#[cfg(test)]
mod tests {
    #[test]
    fn tests_run_on_the_processor_they_were_built_for() {
        assert_eq!(super::check(), Ok(()));
    }
}
