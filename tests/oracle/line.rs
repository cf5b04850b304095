//! Boundaries along a line: every body's span at once, boundaries that coincide joined to groups.

use super::body::{Body, Clear, End, Kind, Surface};
use super::dd::{Dd, Vec3, along, dot, largest};
use super::solid::Solids;

/// Rounding bound of a coordinate relative to the numbers it came from.
pub(crate) const ROUNDING: f64 = 32.0 * f64::EPSILON;

/// A ray, with what is known of where it starts.
#[derive(Clone, Debug)]
pub(crate) struct Ray {
    pub(crate) origin: Vec3,
    pub(crate) direction: Vec3,
    /// Bodies on whose surface it starts, and whether it goes into them. A ray that leaves a convex body never meets it
    /// again, and one that enters meets the far end of its span, so no distance has to be called small.
    pub(crate) on: Vec<(usize, bool)>,
}

/// A surface between two media.
#[derive(Clone, Debug)]
pub(crate) struct Crossing {
    pub(crate) t: Dd,
    pub(crate) point: Vec3,
    /// Unit, against the ray.
    pub(crate) normal: Vec3,
    pub(crate) cosine: Dd,
    /// What fills the side the ray comes from; `None` is air.
    pub(crate) near: Option<usize>,
    pub(crate) far: Option<usize>,
    /// Whose surface it is.
    pub(crate) owner: usize,
    /// The ray starts inside an opaque body: which surface it ends at is not said.
    pub(crate) buried: bool,
    pub(crate) surface: Surface,
    /// Bodies whose surface is passed, and whether the ray is then inside.
    passed: Vec<(usize, bool)>,
    /// Rounding bound here.
    pub(crate) rounding: f64,
}

impl Crossing {
    /// Bodies and sides for a ray that goes on from here.
    pub(crate) fn beyond(&self) -> Vec<(usize, bool)> {
        self.passed.clone()
    }

    /// Bodies and sides for a ray that turns back here.
    pub(crate) fn back(&self) -> Vec<(usize, bool)> {
        self.passed.iter().map(|&(body, inside)| (body, !inside)).collect()
    }
}

/// One body's boundary.
#[derive(Clone, Copy)]
struct Boundary {
    body: usize,
    end: End,
    cosine: f64,
    rounding: f64,
}

impl Boundary {
    /// How many rounding bounds lie between two surfaces where the ray passes: its way between them, seen from the one that it
    /// meets more steeply.
    fn apart(&self, other: &Self) -> f64 {
        let way = (other.end.t - self.end.t).value();
        way * self.cosine.max(other.cosine) / self.rounding.max(other.rounding)
    }
}

/// Surfaces farther apart than this many rounding bounds never coincide.
const FARTHEST: f64 = 4.0;
/// A pile of surfaces, each at most that far from the next, coincides as a whole if it is no thicker than this.
const SURE: f64 = 0.875;

/// Which of the boundaries along a ray coincide with the one before them.
///
/// With lots, any two neighbours in a pile that is thicker than sure may or may not.
fn coincide(solids: &Solids, ray: &Ray, ahead: &[Boundary]) -> Vec<bool> {
    let apart: Vec<f64> = ahead.windows(2).map(|pair| pair[0].apart(&pair[1])).collect();
    let mut joined = vec![false; ahead.len()];
    if solids.salt == 0 {
        for (joined, apart) in joined.iter_mut().skip(1).zip(&apart) {
            *joined = *apart <= solids.grain;
        }
        return joined;
    }
    let mut from = 0;
    while from < ahead.len() {
        let more = apart[from.min(apart.len())..].iter().take_while(|apart| **apart <= FARTHEST);
        let last = from + more.count();
        let sure = ahead[from].apart(&ahead[last]) <= SURE;
        for k in from + 1..=last {
            joined[k] = sure || lot(solids.salt, ray, ahead[k].body);
        }
        from = last + 1;
    }
    joined
}

fn lot(salt: u64, ray: &Ray, body: usize) -> bool {
    let bits = ray.direction.iter().fold(salt ^ (body as u64) << 32, |bits, x| {
        let bits = (bits ^ x.value().to_bits()).wrapping_mul(0x9E37_79B9_7F4A_7C15);
        bits ^ bits >> 29
    });
    bits >> 40 & 1 == 1
}

/// The medium of a filling; equal ones are one medium, and so are all opaque bodies.
fn medium(solids: &Solids, filling: Option<usize>) -> Option<(Option<Clear>, [f64; 3])> {
    let body = &solids.bodies[filling?];
    Some((body.clear, if body.clear.is_some() { body.color } else { [0.0; 3] }))
}

/// Whether a ray starts in a body that need not be convex, and the ends of its spans ahead. Where the ray starts on the
/// surface, it is at the nearest end that it may enter or leave by; no end so near is another one.
fn ahead_of_form(body: &Body, ray: &Ray, on: Option<bool>, ends: Vec<End>) -> (bool, Vec<End>) {
    let rounding = ROUNDING * body.magnitude.max(largest(&ray.origin));
    let off = |end: &End| (end.t * dot(&end.outward, &ray.direction)).value().abs();
    let starts = on.and_then(|goes_in| {
        let parity = usize::from(!goes_in);
        let near = (parity..ends.len()).step_by(2).filter(|&k| off(&ends[k]) < 64.0 * rounding);
        near.min_by(|&a, &b| ends[a].t.value().abs().total_cmp(&ends[b].t.value().abs()))
    });
    let behind = ends.iter().take_while(|end| end.t <= Dd::ZERO).count();
    let first = starts.map_or(behind, |end| end + 1);
    (first % 2 == 1, ends[first..].to_vec())
}

/// Which bodies the ray starts in, and the boundaries ahead of it in order.
fn boundaries(solids: &Solids, ray: &Ray) -> (Vec<bool>, Vec<Boundary>) {
    let mut inside = vec![false; solids.bodies.len()];
    let mut ahead = Vec::new();
    for (number, body) in solids.bodies.iter().enumerate() {
        let on = ray.on.iter().find(|on| on.0 == number).map(|on| on.1);
        if on == Some(false) && matches!(body.kind, Kind::Convex(_)) {
            continue;
        }
        let spans = body.spans(&ray.origin, &ray.direction);
        let Some(ends) = spans.first() else { continue };
        let ends = match body.kind {
            Kind::Convex(_) => {
                inside[number] =
                    on == Some(true) || (ends[0].t <= Dd::ZERO && ends[1].t > Dd::ZERO);
                let skipped = usize::from(inside[number]);
                ends[skipped..].iter().copied().filter(|end| end.t > Dd::ZERO).collect()
            }
            Kind::Form(_) => {
                let (begins, ends) = ahead_of_form(body, ray, on, spans.concat());
                inside[number] = begins;
                ends
            }
        };
        for end in ends {
            let point = along(&ray.origin, end.t, &ray.direction);
            let most = body.magnitude.max(largest(&point)).max(largest(&ray.origin));
            ahead.push(Boundary {
                body: number,
                end,
                cosine: dot(&end.outward, &ray.direction).value().abs(),
                rounding: ROUNDING * most,
            });
        }
        if on == Some(true) && spans.last().is_some_and(|last| last[1].t <= Dd::ZERO) {
            inside[number] = false;
        }
    }
    ahead.sort_by(|a, b| a.end.t.partial_cmp(&b.end.t).expect("spans are numbers"));
    (inside, ahead)
}

/// The first surface between two media before `limit`.
pub(crate) fn crossing(solids: &Solids, ray: &Ray, limit: Option<Dd>) -> Option<Crossing> {
    let (mut before, ahead) = boundaries(solids, ray);
    let joined = coincide(solids, ray, &ahead);
    let mut next = 0;
    while let Some(first) = ahead.get(next) {
        if limit.is_some_and(|limit| first.end.t >= limit) {
            return None;
        }
        let count = 1 + joined[next + 1..].iter().take_while(|joined| **joined).count();
        let group = &ahead[next..next + count];
        next += count;
        let mut after = before.clone();
        for boundary in group {
            after[boundary.body] = !after[boundary.body];
        }
        let (near, far) = (solids.filling(&before), solids.filling(&after));
        let sides = [medium(solids, near), medium(solids, far)];
        let buried = matches!(sides[0], Some((None, _)));
        if sides[0] == sides[1] && !buried {
            before = after;
            continue;
        }
        let owner = solids.owner([&before, &after]);
        let shown = group.iter().find(|boundary| boundary.body == owner).unwrap_or(first);
        let outward = shown.end.outward;
        let ahead = dot(&outward, &ray.direction) > Dd::ZERO;
        let normal = if ahead { outward.map(|x| -x) } else { outward };
        return Some(Crossing {
            t: shown.end.t,
            point: along(&ray.origin, shown.end.t, &ray.direction),
            normal,
            cosine: -dot(&normal, &ray.direction),
            // Inside an opaque body the ray ends at the first surface, whatever lies behind.
            near: if buried { None } else { near },
            far: if buried { near } else { far },
            owner,
            buried,
            surface: shown.end.surface,
            passed: group.iter().map(|b| (b.body, after[b.body])).collect(),
            rounding: group.iter().fold(0.0, |most, b| f64::max(most, b.rounding)),
        });
    }
    None
}
