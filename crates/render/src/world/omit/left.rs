//! How much is left of a scene.

use crate::world::{Step, World};

impl World {
    /// Primitives that rays of the picture can be asked about, each as often as classes are used: what
    /// [`World::stands_for`] is after passes that leave out. At most 2⁶⁴ − 1.
    #[must_use]
    pub fn primitives_left(&self) -> u64 {
        let mut counts: Vec<u64> = Vec::with_capacity(self.nodes.len());
        for node in &self.nodes {
            // Children stand before their parents.
            let of = |child: u32| counts[child as usize];
            let sum = |children: &mut dyn Iterator<Item = u32>| {
                children.fold(0, |sum: u64, child| sum.saturating_add(of(child)))
            };
            let count = match node.step {
                Step::Leaf(_) => 1,
                Step::Instance(number) => of(self.instances[number as usize].root),
                Step::Or { first, count, .. } | Step::And { first, count } => {
                    sum(&mut self.children(first, count).iter().map(|child| child.node))
                }
                Step::Chain(number) => {
                    sum(&mut self.chains[number as usize].links.iter().map(|link| link.node))
                }
            };
            counts.push(count);
        }
        let roots = self.whole.objects.iter();
        roots.fold(0, |sum: u64, &root| sum.saturating_add(counts[root as usize]))
    }
}
