//! Attributes looked up along the path to a leaf: each combination is worked out once.

use std::collections::HashMap;

use scene::{Attributes, AttributesId, Index, Optics, Scene};

use super::{Medium, MediumId, Strength};

/// Index of a combination of attribute sets along a path; paint is not part of it.
pub(super) type Merged = u32;

/// Nothing said along the path.
pub(super) const NOTHING: Merged = 0;

/// What follows from a combination for a leaf.
#[derive(Clone, Copy, Debug)]
pub(super) struct Looks {
    pub(super) surface: u32,
    pub(super) medium: MediumId,
    pub(super) strength: Strength,
}

/// All combinations met so far.
#[derive(Debug)]
pub(super) struct MergeTable {
    merged: Vec<Attributes>,
    by_pair: HashMap<(Merged, AttributesId), Merged>,
    by_text: HashMap<String, Merged>,
    looks: Vec<Looks>,
    pub(super) surfaces: Vec<Optics>,
    pub(super) media: Vec<Medium>,
    medium_by_text: HashMap<String, MediumId>,
    value_by_text: HashMap<String, u32>,
}

impl MergeTable {
    pub(super) fn new() -> Self {
        let opaque = Medium { value: 0, index: 1.0, rate: scene::Rgb::ZERO };
        let mut table = Self {
            merged: Vec::new(),
            by_pair: HashMap::new(),
            by_text: HashMap::new(),
            looks: Vec::new(),
            surfaces: Vec::new(),
            media: vec![opaque],
            medium_by_text: HashMap::new(),
            value_by_text: HashMap::new(),
        };
        table.intern(Attributes::default());
        table
    }

    /// `own` written inside of `outer`.
    pub(super) fn within(&mut self, scene: &Scene, outer: Merged, own: AttributesId) -> Merged {
        if own == AttributesId::NONE {
            return outer;
        }
        if let Some(&merged) = self.by_pair.get(&(outer, own)) {
            return merged;
        }
        let attributes = scene.attributes[own.0 as usize].within(&self.merged[outer as usize]);
        let merged = self.intern(attributes);
        self.by_pair.insert((outer, own), merged);
        merged
    }

    pub(super) fn looks(&self, merged: Merged) -> Looks {
        self.looks[merged as usize]
    }

    /// Equal combinations by different paths are one; the debug text tells any two apart to the last bit.
    fn intern(&mut self, attributes: Attributes) -> Merged {
        let text = format!("{attributes:?}");
        if let Some(&merged) = self.by_text.get(&text) {
            return merged;
        }
        let index = |n: usize| u32::try_from(n).expect("fewer than 2³² combinations of attributes");
        let merged = index(self.merged.len());
        let optics = attributes.resolved();
        let medium = self.medium(&optics);
        let strength = strength(&optics);
        self.looks.push(Looks { surface: index(self.surfaces.len()), medium, strength });
        self.surfaces.push(optics);
        self.merged.push(attributes);
        self.by_text.insert(text, merged);
        merged
    }

    fn medium(&mut self, optics: &Optics) -> MediumId {
        let Some(transparency) = optics.transparency else { return MediumId::OPAQUE };
        let text = format!("{transparency:?} {:?} {}", optics.color, optics.priority);
        let body = format!("{transparency:?} {:?}", optics.color);
        // 0 is the opaque body's.
        let values = u32::try_from(self.value_by_text.len() + 1).expect("fewer than 2³² media");
        let value = *self.value_by_text.entry(body).or_insert(values);
        let next = MediumId(u32::try_from(self.media.len()).expect("fewer than 2³² media"));
        *self.medium_by_text.entry(text).or_insert_with(|| {
            let index = match transparency.index {
                Index::Refractive(index) => index,
                Index::Fake => 1.0,
            };
            // Channel c halves every h / (1 + 8 (1 − colour_c)) units: clear for white, deeper with depth for the rest.
            let rate = (1.0 + 8.0 * (1.0 - optics.color)) / transparency.half_distance;
            self.media.push(Medium { value, index, rate });
            next
        })
    }
}

fn strength(optics: &Optics) -> Strength {
    let class = match optics.transparency.map(|t| t.index) {
        None => 0_u64,
        Some(Index::Refractive(_)) => 1,
        Some(Index::Fake) => 2,
    };
    // Higher priorities are lesser numbers: the sign bit flipped makes the order unsigned, the complement turns it.
    let priority = !(optics.priority.cast_unsigned() ^ 0x8000_0000);
    class << 32 | u64::from(priority)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn opaque_beats_refracting_beats_fake_and_priority_decides_within() {
        let body = |index: Option<Index>, priority| {
            let transparency = index.map(|index| scene::Transparency { half_distance: 1.0, index });
            strength(&Optics { transparency, priority, ..Optics::DEFAULT })
        };
        let glass = Some(Index::Refractive(1.5));
        assert!(body(None, -5) < body(glass, 99), "opaque first");
        assert!(body(glass, -5) < body(Some(Index::Fake), 99), "then refracting");
        assert!(body(glass, 1) < body(glass, 0), "higher priority");
        assert!(body(glass, 0) < body(glass, -1), "below the default");
        assert!(body(glass, i32::MAX) < body(glass, i32::MIN), "ends");
    }
}
