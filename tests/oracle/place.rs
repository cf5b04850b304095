//! Placements as maps in double-double.

use scene::Placement;

use super::dd::{Dd, Vec3, along, dot, minus, sin_cos_degrees};

type Rows = [Vec3; 3];

const IDENTITY: Rows =
    [[Dd::ONE, Dd::ZERO, Dd::ZERO], [Dd::ZERO, Dd::ONE, Dd::ZERO], [Dd::ZERO, Dd::ZERO, Dd::ONE]];

/// `outer = linear · inner + place`, and back.
#[derive(Clone, Debug)]
pub(crate) struct Affine {
    linear: Rows,
    inverse: Rows,
    pub(crate) place: Vec3,
}

fn apply(rows: &Rows, v: &Vec3) -> Vec3 {
    [dot(&rows[0], v), dot(&rows[1], v), dot(&rows[2], v)]
}

fn transpose(rows: &Rows) -> Rows {
    std::array::from_fn(|i| std::array::from_fn(|j| rows[j][i]))
}

fn product(a: &Rows, b: &Rows) -> Rows {
    let columns = transpose(b);
    std::array::from_fn(|i| std::array::from_fn(|j| dot(&a[i], &columns[j])))
}

/// Turns by `degrees` about an axis.
fn turn(axis: usize, degrees: f64) -> Rows {
    let (s, c) = sin_cos_degrees(degrees);
    let (j, k) = ((axis + 1) % 3, (axis + 2) % 3);
    let mut rows = IDENTITY;
    rows[j][j] = c;
    rows[k][k] = c;
    rows[j][k] = -s;
    rows[k][j] = s;
    rows
}

impl Affine {
    /// Moves by `by`.
    pub(crate) fn translation(by: Vec3) -> Self {
        Self { linear: IDENTITY, inverse: IDENTITY, place: by }
    }

    /// Scale, then turn about x, y and z, then move.
    pub(crate) fn new(placement: &Placement) -> Self {
        let angles = placement.rotation_degrees.to_array();
        let turned = (0..3).fold(IDENTITY, |sum, axis| product(&turn(axis, angles[axis]), &sum));
        let scale = placement.scale.to_array().map(Dd::from);
        let back = transpose(&turned);
        Self {
            linear: turned.map(|row| std::array::from_fn(|k| row[k] * scale[k])),
            inverse: std::array::from_fn(|k| back[k].map(|x| x / scale[k])),
            place: placement.place.to_array().map(Dd::from),
        }
    }

    /// The map that goes through `inner` first.
    pub(crate) fn then_inner(&self, inner: &Self) -> Self {
        Self {
            linear: product(&self.linear, &inner.linear),
            inverse: product(&inner.inverse, &self.inverse),
            place: along(&self.place, Dd::ONE, &apply(&self.linear, &inner.place)),
        }
    }

    pub(crate) fn point_inward(&self, point: &Vec3) -> Vec3 {
        apply(&self.inverse, &minus(point, &self.place))
    }

    pub(crate) fn direction_inward(&self, direction: &Vec3) -> Vec3 {
        apply(&self.inverse, direction)
    }

    /// The outer gradient of a function with this inner one.
    pub(crate) fn gradient_outward(&self, gradient: &Vec3) -> Vec3 {
        apply(&transpose(&self.inverse), gradient)
    }

    /// How far the map takes the unit cube from its centre, at most.
    pub(crate) fn half_extent(&self) -> f64 {
        let reach = |row: &Vec3| row.iter().map(|x| x.value().abs()).sum::<f64>();
        self.linear.iter().map(reach).fold(0.0, f64::max)
    }
}
