//! How a description looked, so that what was written by hand stays when a part of it changes.

use std::fmt;

use super::Description;

/// Lines of the text that a description was parsed from. No part of what it says, so that all are
/// equal.
#[derive(Clone, Debug, Default)]
pub(super) struct Layout(Vec<Line>);

#[derive(Clone, Debug)]
struct Line {
    source: String,
    role: Role,
}

#[derive(Clone, Debug)]
enum Role {
    Blank,
    /// A comment alone, or a key that this version does not know.
    Kept,
    /// A known key.
    Known {
        key: String,
        /// The line as it is printed by default.
        plain: String,
        /// What follows from `#` on.
        comment: String,
    },
}

impl PartialEq for Layout {
    fn eq(&self, _: &Self) -> bool {
        true
    }
}

impl Layout {
    pub(super) fn push_blank(&mut self) {
        self.0.push(Line { source: String::new(), role: Role::Blank });
    }

    pub(super) fn push_kept(&mut self, source: &str) {
        self.0.push(Line { source: source.into(), role: Role::Kept });
    }

    pub(super) fn push_known(&mut self, key: &str, comment: &str, source: &str) {
        let (key, comment) = (key.to_owned(), comment.trim_end().to_owned());
        let role = Role::Known { key, plain: String::new(), comment };
        self.0.push(Line { source: source.into(), role });
    }

    /// Takes note of what the known lines say.
    pub(super) fn settle(&mut self, description: &Description) {
        let lines = description.known_lines();
        for line in &mut self.0 {
            if let Role::Known { key, plain, .. } = &mut line.role {
                let found = lines.iter().find(|(other, _)| other == key);
                *plain = found.map(|(_, line)| line.clone()).unwrap_or_default();
            }
        }
    }

    /// Prints `description` with the lines that still say the same as they were, those that do not
    /// in their place, and new ones at the end.
    pub(super) fn print(
        &self,
        description: &Description,
        f: &mut fmt::Formatter<'_>,
    ) -> fmt::Result {
        let mut left = description.known_lines();
        let is_kept = |line: &&Line| matches!(line.role, Role::Kept);
        let kept = self.0.iter().filter(is_kept).map(|line| &line.source);
        let all_kept = kept.eq(&description.unknown);
        if self.0.is_empty() {
            writeln!(f, "{}", left.remove(0).1)?;
        }
        for Line { source, role } in &self.0 {
            match role {
                Role::Blank => writeln!(f)?,
                Role::Kept if all_kept => writeln!(f, "{source}")?,
                Role::Kept => {}
                Role::Known { key, plain, comment } => {
                    let Some(at) = left.iter().position(|(other, _)| other == key) else {
                        continue;
                    };
                    let (_, line) = left.remove(at);
                    if line == *plain {
                        writeln!(f, "{source}")?;
                    } else if comment.is_empty() {
                        writeln!(f, "{line}")?;
                    } else {
                        writeln!(f, "{line} {comment}")?;
                    }
                }
            }
        }
        let channels = description.channels.len() + usize::from(description.log.is_some());
        let channels = channels.min(left.len());
        let (properties, channels) = left.split_at(left.len() - channels);
        for (_, line) in properties {
            writeln!(f, "{line}")?;
        }
        if !all_kept {
            for line in &description.unknown {
                writeln!(f, "{line}")?;
            }
        }
        for (_, line) in channels {
            writeln!(f, "{line}")?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::super::*;

    const BY_HAND: &str = "# mine

idf 1
   size   4 2       # columns rows
camera 35 mm        # unknown, kept
# light of the lamp
transfer linear     # as measured
red  \"x.red\"  4 2 8 rle  # first
\tcvg x.cvg 4 2 8 raw
# the end
";

    #[test]
    fn what_does_not_change_stays_as_it_was_written() {
        let description = parse(BY_HAND).unwrap();
        assert_eq!(description.to_string(), BY_HAND);
        assert_eq!(
            description.unknown,
            ["# mine", "camera 35 mm        # unknown, kept", "# light of the lamp", "# the end"]
        );
    }

    #[test]
    fn what_changes_keeps_its_place_and_comment() {
        let mut description = parse(BY_HAND).unwrap();
        description.transfer = Some(Transfer::Gamma(2.0));
        description.origin = [3, 4];
        description.channels[0].depth = Depth::U16;
        let enc = Channel { kind: Kind::Enc, ..description.channels.remove(1) };
        description.channels.push(enc);
        let expected = BY_HAND
            .replace("transfer linear     # as", "transfer gamma 2 # as")
            .replace("red  \"x.red\"  4 2 8 rle  # first", "red x.red 4 2 16 rle # first")
            .replace("\tcvg x.cvg 4 2 8 raw\n", "")
            + "window 3 4 4 2\nenc x.cvg 4 2 8 raw\n";
        assert_eq!(description.to_string(), expected);
        assert_eq!(parse(&expected), Ok(description));
    }

    #[test]
    fn other_kept_lines_take_the_place_of_all() {
        let mut description = parse("idf 1\n# a\nsize 1 1\n# b\ngrg g 1 1 8 raw").unwrap();
        description.unknown = vec!["camera 4".into()];
        let expected = "idf 1\nsize 1 1\ngrg g 1 1 8 raw\ncamera 4\n";
        assert_eq!(description.to_string(), expected);
    }
}
