//! A relief: the surface looks raised by the weight of another function times `height`.

use super::{Domain, Function, Parameter, Range, Weight};

pub(super) const FUNCTION: Function = Function {
    keyword: "bump",
    domain: Domain::Surface,
    parameters: &[Parameter { name: "height", default: 0.1, range: Range::Any }],
    weight: Weight::Relief,
};
