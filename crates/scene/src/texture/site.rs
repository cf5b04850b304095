//! Where a point of a painted surface lies in a picture.

use glam::{DVec2, DVec3};

/// A point of a painted surface, as functions of a picture see it.
#[derive(Clone, Copy, Debug)]
pub struct Site {
    /// u and v of the primitive.
    pub surface: DVec2,
    /// u comes round: 1 is where 0 is.
    pub closed: bool,
    /// In the coordinates of the factor that the paint is written at.
    pub point: DVec3,
    /// Outward, in the same coordinates; of any length but 0.
    pub normal: DVec3,
    /// Height of the picture over its width.
    pub aspect: f64,
}

/// A place in a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Placed {
    /// In widths from the left edge and in heights from the lower edge.
    pub place: DVec2,
    /// What is beyond the edges, from left to right and from below upward.
    pub edges: [Edge; 2],
    /// This far along the width the same point of the surface comes again; infinite if it does not.
    pub period: f64,
}

/// What is beyond an edge of a picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Edge {
    /// The picture again.
    Tiled,
    /// The picture again up to this many of them, then the last of its pixels.
    Held(f64),
    /// Nothing.
    Once,
}

/// The words for where u and v of a picture come from.
pub(super) const MAPPINGS: &[&str] = &["surface", "planar", "cylindrical", "spherical", "box"];
const PLANAR: u32 = 1;
const CYLINDRICAL: u32 = 2;
const SPHERICAL: u32 = 3;
const BOX: u32 = 4;

/// u and v by a mapping, and how they end.
#[derive(Clone, Copy, Debug)]
pub(super) struct Mapped {
    pub(super) uv: DVec2,
    /// u comes round after 1.
    pub(super) closed: bool,
    /// u and v stay in 0…1.
    pub(super) bounded: [bool; 2],
    /// The surface looks to where the picture comes from.
    pub(super) faces: bool,
}

/// u and v of a site by the mapping of this number.
pub(super) fn mapped(mapping: u32, site: &Site) -> Mapped {
    let Site { surface, closed, point: p, normal, .. } = *site;
    let plane = |u: f64, v: f64| DVec2::new(0.5 * (u + 1.0), 0.5 * (v + 1.0));
    let free = |uv| Mapped { uv, closed: false, bounded: [false; 2], faces: true };
    match mapping {
        PLANAR => Mapped { faces: normal.z > 0.0, ..free(plane(p.x, p.y)) },
        CYLINDRICAL => {
            let uv = DVec2::new(turn(p.y, p.z), p.x);
            Mapped { closed: true, bounded: [true, false], ..free(uv) }
        }
        SPHERICAL => {
            let across = (p.x * p.x + p.z * p.z).sqrt();
            let v = 0.5 + libm::atan2(p.y, across) / std::f64::consts::PI;
            let uv = DVec2::new(turn(p.x, -p.z), v);
            Mapped { closed: true, bounded: [true; 2], ..free(uv) }
        }
        BOX => {
            let size = normal.abs();
            // As it is read from outside, upright on the sides, with its foot to the front above.
            free(if size.x > size.y && size.x > size.z {
                plane(if normal.x > 0.0 { -p.z } else { p.z }, p.y)
            } else if size.y > size.z {
                plane(p.x, if normal.y > 0.0 { -p.z } else { p.z })
            } else {
                plane(if normal.z > 0.0 { p.x } else { -p.x }, p.y)
            })
        }
        _ => Mapped { uv: surface, closed, bounded: [true; 2], faces: true },
    }
}

/// Angle of (a, b) as a share of a turn in 0…1.
fn turn(a: f64, b: f64) -> f64 {
    let turn = libm::atan2(b, a) / std::f64::consts::TAU;
    if turn < 0.0 { turn + 1.0 } else { turn }
}
