//! The Python package: a wheel is built, installed into a fresh environment, and tried beside the programs of the suite.

use crate::shell::Shell;

/// Exit status of the script where something is not installed.
const MISSING: i32 = 77;

#[test]
fn the_wheel_passes_its_tests() {
    let shell = Shell::new();
    let output = shell.output("scripts/test-python.sh");
    let said = String::from_utf8_lossy(&output.stdout);
    let errors = String::from_utf8_lossy(&output.stderr);
    if output.status.code() == Some(MISSING) {
        assert!(errors.contains("skipped: "), "{errors}");
        return idf::command::print(&errors);
    }
    assert!(output.status.success(), "{said}\n{errors}");
    let ran = errors.lines().find(|line| line.starts_with("Ran "));
    let count: Option<u32> = ran.and_then(|line| line.split(' ').nth(1)?.parse().ok());
    assert!(count.is_some_and(|count| count >= 30), "{errors}");
    // The programs are there, so nothing was left out.
    assert!(errors.trim_end().ends_with("OK"), "{errors}");
}

#[test]
fn the_script_explains_itself() {
    let shell = Shell::new();
    assert!(shell.run("scripts/test-python.sh -h").contains("  test-python.sh [-r]"));
    let refused = shell.output("scripts/test-python.sh -z");
    assert_eq!(refused.status.code(), Some(2), "{refused:?}");
}
