//! Graded words: how shiny, how smooth, and what colour highlights have.

/// What a graded word says.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Grade {
    /// Specular share.
    Shininess(f64),
    /// Beckmann slope.
    Smoothness(f64),
    /// Highlights take the body colour.
    Pure(bool),
}

/// Every graded word. A new one is a new row.
pub(crate) const GRADES: &[(&str, Grade)] = &[
    // The ends are an exactly matte surface and an exact mirror; the steps between look even.
    ("dullest", Grade::Shininess(0.0)),
    ("duller", Grade::Shininess(0.05)),
    ("dull", Grade::Shininess(0.2)),
    ("shiny", Grade::Shininess(0.5)),
    ("shinier", Grade::Shininess(0.8)),
    ("shiniest", Grade::Shininess(1.0)),
    // Each step about doubles the width of a highlight.
    ("roughest", Grade::Smoothness(0.6)),
    ("rougher", Grade::Smoothness(0.4)),
    ("rough", Grade::Smoothness(0.25)),
    ("smooth", Grade::Smoothness(0.12)),
    ("smoother", Grade::Smoothness(0.05)),
    ("smoothest", Grade::Smoothness(0.0)),
    ("pure", Grade::Pure(true)),
    ("composite", Grade::Pure(false)),
];

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn grades_rise_and_stay_in_range() {
        let (mut shininess, mut smoothness) = (-1.0, 1.0);
        for &(word, grade) in GRADES {
            match grade {
                Grade::Shininess(x) => {
                    assert!(x > shininess && x <= 1.0, "{word} is shinier than the row above");
                    shininess = x;
                }
                Grade::Smoothness(x) => {
                    assert!(x < smoothness && x >= 0.0, "{word} is smoother than the row above");
                    smoothness = x;
                }
                Grade::Pure(_) => {}
            }
        }
    }

    #[test]
    fn defaults_have_words() {
        let default = scene::Optics::DEFAULT;
        assert!(GRADES.contains(&("dullest", Grade::Shininess(default.shininess))), "shininess");
        assert!(GRADES.contains(&("rough", Grade::Smoothness(default.smoothness))), "smoothness");
        assert!(GRADES.contains(&("composite", Grade::Pure(default.pure))), "pure");
    }
}
