//! What a render did: rays by kind, and what was cut.

/// Counts of one render.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct RayStats {
    /// Rays from the eye.
    pub primary: u64,
    /// Reflected and refracted rays.
    pub secondary: u64,
    /// Rays to lights.
    pub shadow: u64,
    /// Branches that ended at the depth limit.
    pub cut_by_depth: u64,
    /// Branches too faint to follow.
    pub cut_by_weight: u64,
    /// Sum of the weights of the branches that ended at the depth limit, in channel units over all samples.
    pub weight_cut_by_depth: f64,
    /// Sum of the weights of the branches too faint to follow.
    pub weight_cut_by_weight: f64,
}

impl RayStats {
    /// Adds the counts of another part of the picture.
    pub fn add(&mut self, other: &Self) {
        self.primary += other.primary;
        self.secondary += other.secondary;
        self.shadow += other.shadow;
        self.cut_by_depth += other.cut_by_depth;
        self.cut_by_weight += other.cut_by_weight;
        self.weight_cut_by_depth += other.weight_cut_by_depth;
        self.weight_cut_by_weight += other.weight_cut_by_weight;
    }

    /// What was cut at the depth limit, and what was too faint, as a mean over all samples in channel units: a bound on
    /// what the picture lacks.
    pub(crate) fn cut(&self) -> [f64; 2] {
        #[expect(clippy::cast_precision_loss, reason = "counts below 2⁵³")]
        let samples = self.primary.max(1) as f64;
        [self.weight_cut_by_depth / samples, self.weight_cut_by_weight / samples]
    }

    /// All rays traced.
    #[must_use]
    pub fn rays(&self) -> u64 {
        self.primary + self.secondary + self.shadow
    }
}
