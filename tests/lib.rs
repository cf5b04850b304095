//! The suite as a user meets it: only tests live in this package.
