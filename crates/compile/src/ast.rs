//! The tree: one statement at a time, its solid flat.
//!
//! Numbers are checked and converted where they are read; what is left open here are names.

use std::sync::Arc;

use glam::DVec3;
use scene::{AttributesId, Form, Placement, Primitive, Rgb};

use crate::source::Span;
use crate::token::Symbol;

/// A value and where it is written.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Spanned<T> {
    pub(crate) value: T,
    pub(crate) span: Span,
}

/// A statement.
#[derive(Debug)]
pub(crate) struct Statement {
    /// Its keyword.
    pub(crate) span: Span,
    pub(crate) kind: StatementKind,
}

/// What a statement says.
#[derive(Debug)]
pub(crate) enum StatementKind {
    Include(Spanned<String>),
    Class(Class),
    Object(Object),
    Camera { at: DVec3, parallel: bool, lens: Option<Lens> },
    Target(DVec3),
    FocalLength(f64),
    Light(Light),
    Ambient(Rgb),
    Background(Rgb),
    Fog(f64),
}

/// The lens of a camera as written.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Lens {
    pub(crate) aperture: Spanned<f64>,
    /// Where it is sharp; the target if it is not said.
    pub(crate) focus: Option<Spanned<DVec3>>,
}

/// A name for a solid. A solid with errors is left out, its name is not.
#[derive(Debug)]
pub(crate) struct Class {
    pub(crate) name: Spanned<Symbol>,
    pub(crate) solid: Option<Solid>,
    /// With parameters: how it is made where it is used. The solid is then one that has been checked only.
    pub(crate) definition: Option<Arc<Definition>>,
}

/// A class with parameters, and where its text stands.
#[derive(Debug)]
pub(crate) struct Definition {
    pub(crate) name: Symbol,
    pub(crate) text: Arc<str>,
    /// Offset of the text among the sources.
    pub(crate) base: u32,
    /// Where the solid begins, and how long it is.
    pub(crate) start: usize,
    pub(crate) length: u64,
    pub(crate) parameters: Vec<Parameter>,
    /// How many classes precede it; it sees no others.
    pub(crate) sees: usize,
}

/// A parameter of a class.
#[derive(Debug)]
pub(crate) struct Parameter {
    pub(crate) name: Spanned<Symbol>,
    pub(crate) default: Option<Standard>,
}

/// The number of a parameter where none is given.
#[derive(Debug)]
pub(crate) struct Standard {
    /// Where its expression begins.
    pub(crate) start: usize,
    /// Its value; NaN if that depends on other parameters.
    pub(crate) value: f64,
    pub(crate) span: Span,
}

/// A solid in the scene.
#[derive(Debug)]
pub(crate) struct Object {
    pub(crate) name: Option<Spanned<Symbol>>,
    pub(crate) solid: Solid,
}

/// A light as written, its clauses not yet weighed against its kind.
#[derive(Debug)]
pub(crate) struct Light {
    pub(crate) kind: LightKind,
    pub(crate) at: Option<Spanned<DVec3>>,
    pub(crate) toward: Option<Spanned<DVec3>>,
    pub(crate) color: Rgb,
    pub(crate) shadows: bool,
    pub(crate) radius: f64,
}

/// Kind of a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum LightKind {
    Point,
    Beam,
    Spot { concentration: f64, half_angle_degrees: f64 },
}

/// A solid: frames with parents before children, nodes in post-order.
#[derive(Debug, Default)]
pub(crate) struct Solid {
    pub(crate) frames: Vec<Frame>,
    pub(crate) nodes: Vec<Node>,
    /// Solids with arguments that the nodes name.
    pub(crate) forms: Vec<Form>,
}

impl Solid {
    /// The node of a solid with arguments.
    pub(crate) fn form(&mut self, form: Form, frame: u32) -> Node {
        self.forms.push(form);
        let form = u32::try_from(self.forms.len() - 1).expect("fewer than 2³² solids are made");
        Node::Form { form, frame }
    }
}

/// Where a factor stands.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Frame {
    pub(crate) parent: Option<u32>,
    pub(crate) placement: Placement,
    pub(crate) attributes: AttributesId,
}

/// One step of a solid.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Node {
    Primitive {
        kind: Primitive,
        frame: u32,
    },
    /// A solid with arguments: which of those of the solid it is a part of.
    Form {
        form: u32,
        frame: u32,
    },
    Named {
        name: Symbol,
        span: Span,
        frame: u32,
    },
    /// A class with parameters: which of those that have been made.
    Made {
        instance: u32,
        frame: u32,
    },
    Union(u32),
    Intersection(u32),
    Complement,
}

impl Node {
    /// The frame of a solid or a class.
    pub(crate) fn frame(self) -> Option<u32> {
        match self {
            Self::Primitive { frame, .. }
            | Self::Form { frame, .. }
            | Self::Named { frame, .. }
            | Self::Made { frame, .. } => Some(frame),
            Self::Union(_) | Self::Intersection(_) | Self::Complement => None,
        }
    }
}
