//! What has to hold of the values in a scene: the reader and the writer check the same.

use glam::DVec3;

use crate::csg::Node;

/// Which numbers are allowed; a number is finite in any case.
pub(super) struct Range {
    /// Follows `expected`.
    pub(super) words: &'static str,
    pub(super) holds: fn(f64) -> bool,
}

pub(super) const ANY: Range = Range { words: "a finite number", holds: |_| true };
pub(super) const SHARE: Range =
    Range { words: "a number from 0 to 1", holds: |x| (0.0..=1.0).contains(&x) };
pub(super) const ABOVE_ZERO: Range = Range { words: "a number above 0", holds: |x| x > 0.0 };
pub(super) const NOT_BELOW_ZERO: Range =
    Range { words: "a number not below 0", holds: |x| x >= 0.0 };
pub(super) const FACTOR: Range = Range { words: "a number other than 0", holds: |x| x.abs() > 0.0 };
pub(super) const HALF_ANGLE: Range =
    Range { words: "an angle above 0, at most 180", holds: |x| x > 0.0 && x <= 180.0 };

impl Range {
    pub(super) fn allows(&self, value: f64) -> bool {
        value.is_finite() && (self.holds)(value)
    }
}

/// True if there is a direction from `a` to `b`.
pub(super) fn apart(a: DVec3, b: DVec3) -> bool {
    let way = b - a;
    way.is_finite() && way != DVec3::ZERO
}

/// What is expected of two points that need a direction.
pub(super) const APART: &str = "two points a finite distance apart";

/// What is expected of placements.
pub(super) const FINITE: &str = "placements that make finite matrices and boxes";

/// True if `name` is one word of a line: the language is not case-sensitive, so names are kept in lower case.
pub(super) fn is_name(name: &str) -> bool {
    let inside = |c: char| !c.is_whitespace() && !c.is_control() && !c.is_ascii_uppercase();
    !name.is_empty() && name.chars().all(inside)
}

/// What is expected of a name.
pub(super) const NAME: &str = "a name in lower case without blanks";

/// An expression in post-order as far as it is known: for each operand not yet joined, whether it is a complement.
#[derive(Default)]
pub(super) struct Expression {
    operands: Vec<bool>,
}

impl Expression {
    pub(super) fn clear(&mut self) {
        self.operands.clear();
    }

    /// Takes the next node, or says what was expected in its place.
    pub(super) fn push(&mut self, node: &Node) -> Result<(), String> {
        match *node {
            Node::Primitive { .. } | Node::Form { .. } | Node::Instance { .. } => {
                self.operands.push(false);
            }
            Node::Union(n) => self.join(n, 0)?,
            Node::Intersection(n) => self.join(n, 1)?,
            Node::Complement => match self.operands.last_mut() {
                Some(complement @ false) => *complement = true,
                Some(true) => return Err("an operator other than a second complement".to_owned()),
                None => return Err("an operand before its complement".to_owned()),
            },
        }
        Ok(())
    }

    /// Joins the last `n` operands; those from the `free`th on may be complements, or none if `free` is 0.
    fn join(&mut self, n: u32, free: usize) -> Result<(), String> {
        let there = self.operands.len();
        let Some(start) = there.checked_sub(n as usize).filter(|_| n >= 2) else {
            return Err(format!("a number of operands from 2 to {there}, as many as precede"));
        };
        let bound = if free == 0 { there } else { start + free };
        if self.operands[start..bound].contains(&true) {
            return Err("complements only as operands, not the first, of intersections".to_owned());
        }
        self.operands.truncate(start);
        self.operands.push(false);
        Ok(())
    }

    /// Checks that one operand is left, or says what was expected.
    pub(super) fn finish(&self) -> Result<(), String> {
        match *self.operands {
            [false] => Ok(()),
            [true] => Err("an intersection about the complement".to_owned()),
            [] => Err("a primitive or an instance".to_owned()),
            _ => Err(format!("an operator that joins the {} operands", self.operands.len())),
        }
    }
}
