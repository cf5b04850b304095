//! A solid as one flat post-order array, and the frames its leaves stand in.

use crate::class::AttributesId;
use crate::form::Form;
use crate::primitive::Primitive;
use crate::transform::{Map, Placement};

/// Index of a class in its scene; a class refers only to earlier ones.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct ClassId(pub u32);

/// Index of a frame in its solid.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FrameId(pub u32);

/// Index of a solid with arguments in the solid it is a part of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct FormId(pub u32);

/// Where a factor stands and what is said of it there: a primitive, an instance, or a group about them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// The group it is in; a frame refers only to earlier ones.
    pub parent: Option<FrameId>,
    /// Scale, rotation and place within that group.
    pub placement: Placement,
    /// Attributes written here; those written further in win.
    pub attributes: AttributesId,
}

/// One step of a solid in post-order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Node {
    /// A primitive in its frame.
    Primitive {
        /// Which solid.
        kind: Primitive,
        /// Its own frame.
        frame: FrameId,
    },
    /// A solid with arguments in its frame.
    Form {
        /// Which of [`Solid::forms`].
        form: FormId,
        /// Its own frame.
        frame: FrameId,
    },
    /// An instance of a class in its frame.
    Instance {
        /// Which class.
        class: ClassId,
        /// Its own frame.
        frame: FrameId,
    },
    /// Union of the last `n` operands, at least 2.
    Union(u32),
    /// Intersection of the last `n` operands, at least 2.
    Intersection(u32),
    /// Complement of the last operand. It stands only as an operand, not the first, of an intersection:
    /// `A − B` is `A B complement intersection(2)`.
    Complement,
}

/// A solid: frames in order of mention, nodes in post-order that leave one operand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Solid {
    /// Frames; parents stand before their children.
    pub frames: Vec<Frame>,
    /// Post-order expression, not empty.
    pub nodes: Vec<Node>,
    /// Solids with arguments that the nodes name.
    pub forms: Vec<Form>,
}

impl Solid {
    /// A single primitive with no attributes of its own.
    #[must_use]
    pub fn primitive(kind: Primitive, placement: Placement) -> Self {
        let frame = Frame { parent: None, placement, attributes: AttributesId::NONE };
        let nodes = vec![Node::Primitive { kind, frame: FrameId(0) }];
        Self { frames: vec![frame], nodes, forms: Vec::new() }
    }

    /// A solid with arguments that a node names.
    ///
    /// # Panics
    ///
    /// If there is none of that number.
    #[must_use]
    pub fn form(&self, form: FormId) -> &Form {
        &self.forms[form.0 as usize]
    }

    /// The index of `form` among the solids with arguments, added unless it is one of the last few.
    ///
    /// # Panics
    ///
    /// With more than 2³² of them.
    pub fn add_form(&mut self, form: Form) -> FormId {
        /// A solid of one shape many times stands in a row.
        const RECENT: usize = 8;
        let first = self.forms.len().saturating_sub(RECENT);
        let known = self.forms[first..].iter().position(|other| *other == form);
        let index = known.map_or(self.forms.len(), |place| first + place);
        if known.is_none() {
            self.forms.push(form);
        }
        FormId(u32::try_from(index).expect("fewer than 2³² solids"))
    }

    /// The map of every frame: to the space of the solid from the frame's own.
    #[must_use]
    pub fn maps(&self) -> Vec<Map> {
        let mut maps = Vec::with_capacity(self.frames.len());
        self.maps_into(&mut maps);
        maps
    }

    /// [`Self::maps`] in place of what `maps` holds.
    pub(crate) fn maps_into(&self, maps: &mut Vec<Map>) {
        maps.clear();
        for frame in &self.frames {
            let own = frame.placement.map();
            maps.push(frame.parent.map_or(own, |parent| maps[parent.0 as usize].then_inner(&own)));
        }
    }
}

impl Frame {
    /// The frame's index as an array index.
    #[must_use]
    pub fn parent_index(&self) -> Option<usize> {
        self.parent.map(|parent| parent.0 as usize)
    }
}
