//! Clear bodies that a word written further out makes opaque.

use scene::{AttributesId, Frame, Node, Scene, Solid};

/// What is said of a leaf, as far as it matters here.
#[derive(Clone, Copy, Debug, Default)]
struct Said {
    clear: bool,
    /// A shininess is said, and whether it is 0.
    share: Option<bool>,
    /// It is a clear body, and further out its surface is said to be the dullest.
    dulled: bool,
}

impl Said {
    fn of(scene: &Scene, id: AttributesId) -> Self {
        let set = &scene.attributes[id.0 as usize];
        let share = set.shininess.map(|share| share <= 0.0);
        Self { clear: set.transparency.is_some(), share, dulled: false }
    }

    fn within(self, outer: Self) -> Self {
        let now = self.clear && outer.share == Some(true);
        Self {
            clear: self.clear || outer.clear,
            share: self.share.or(outer.share),
            dulled: self.dulled || self.share.is_none() && (outer.dulled || now),
        }
    }

    /// Nothing has been said yet of how much passes the surface of this clear body.
    fn is_open(self) -> bool {
        self.clear && self.share.is_none()
    }
}

/// Classes and objects that hold a clear body of which the dullest surface is said further out.
pub(super) struct Matte {
    /// Of each class, whether a clear body in it is open to what is said where the class is used.
    open: Vec<bool>,
    /// Whether there can be any.
    possible: bool,
}

impl Matte {
    pub(super) fn new(scene: &Scene) -> Self {
        let clear = scene.attributes.iter().any(|set| set.transparency.is_some());
        let dull = scene.attributes.iter().any(|set| set.shininess.is_some_and(|x| x <= 0.0));
        let mut matte = Self { open: Vec::new(), possible: clear && dull };
        if matte.possible {
            for class in &scene.classes {
                let open = matte.leaves(scene, &class.solid).any(Said::is_open);
                matte.open.push(open);
            }
        }
        matte
    }

    /// True if the solid makes a clear body dullest by what it says further out.
    pub(super) fn in_solid(&self, scene: &Scene, solid: &Solid) -> bool {
        self.possible && self.leaves(scene, solid).any(|said| said.dulled)
    }

    /// What is said of the leaves that are clear bodies, or hold one that is open.
    fn leaves<'a>(&'a self, scene: &'a Scene, solid: &'a Solid) -> impl Iterator<Item = Said> + 'a {
        let mut along: Vec<Said> = Vec::with_capacity(solid.frames.len());
        for &Frame { parent, attributes, .. } in &solid.frames {
            let own = Said::of(scene, attributes);
            // Both words at one place have their own warning.
            let own = if own.clear && own.share.is_some() { Said::default() } else { own };
            along.push(parent.map_or(own, |parent| own.within(along[parent.0 as usize])));
        }
        solid.nodes.iter().filter_map(move |node| match *node {
            Node::Primitive { frame, .. } | Node::Form { frame, .. } => {
                Some(along[frame.0 as usize])
            }
            Node::Instance { class, frame } => {
                let open = self.open[class.0 as usize];
                let inner = Said { clear: open, ..Said::default() };
                Some(inner.within(along[frame.0 as usize]))
            }
            Node::Union(_) | Node::Intersection(_) | Node::Complement => None,
        })
    }
}
