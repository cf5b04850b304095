//! The solids with arguments: a torus as a quartic, a prism as the points of a line between its planes, terrain as the
//! planes over the cells that a line passes.

use scene::{Form, Ray};

use super::body::{End, Surface};
use super::dd::{Dd, Vec3, along, dot, unit};

/// What a form reaches about the origin of its own space.
pub(crate) fn reach(form: &Form) -> f64 {
    match form.row().keyword {
        "torus" => 1.0 + form.arguments()[0],
        "terrain" => 1.0,
        _ => form.arguments().iter().fold(1.0, |most, x| f64::max(most, x.abs())),
    }
}

/// The spans of a line inside of a form, with gradients in its own space at their ends.
fn curved(t: Dd, outward: Vec3) -> End {
    End { t, outward, surface: Surface::Curved }
}

pub(crate) fn spans(form: &Form, o: &Vec3, d: &Vec3) -> Vec<[End; 2]> {
    let arguments: Vec<Dd> = form.arguments().iter().copied().map(Dd::from).collect();
    match form.row().keyword {
        "torus" => torus(arguments[0], o, d),
        "prism" => prism(&arguments, o, d),
        "terrain" => terrain(form, o, d),
        other => panic!("the oracle does not know {other}"),
    }
}

fn number(x: f64) -> Dd {
    Dd::from(x)
}

/// The value of a polynomial, highest coefficient first.
fn value(polynomial: &[Dd], u: Dd) -> Dd {
    polynomial.iter().fold(Dd::ZERO, |sum, &c| sum * u + c)
}

fn derivative(polynomial: &[Dd]) -> Vec<Dd> {
    let degree = polynomial.len() - 1;
    (0..degree)
        .map(|k| polynomial[k] * Dd::from(u32::try_from(degree - k).expect("a small degree")))
        .collect()
}

/// All roots between two bounds, each once: between the roots of the derivative the polynomial is monotone.
fn roots(polynomial: &[Dd], low: Dd, high: Dd) -> Vec<Dd> {
    if polynomial.len() < 2 {
        return Vec::new();
    }
    let slope = derivative(polynomial);
    let mut stops = vec![low];
    stops.extend(roots(&slope, low, high));
    stops.push(high);
    let mut found = Vec::new();
    for pair in stops.windows(2) {
        let (mut a, mut b) = (pair[0], pair[1]);
        let rises = value(polynomial, a) < Dd::ZERO;
        if rises == (value(polynomial, b) < Dd::ZERO) {
            continue;
        }
        let mut at = (a + b) * number(0.5);
        for step in 0..64 {
            let here = value(polynomial, at);
            if rises == (here < Dd::ZERO) {
                a = at;
            } else {
                b = at;
            }
            // Halved until Newton's steps stay inside and are as good.
            let next = at - here / value(&slope, at);
            let newton = step > 8 && a < next && next < b;
            at = if newton { next } else { (a + b) * number(0.5) };
        }
        found.push(at);
    }
    found
}

/// (|p|² + 1 − r²)² = 4 (y² + z²), from the point of the line nearest the centre.
fn torus(r: Dd, o: &Vec3, d: &Vec3) -> Vec<[End; 2]> {
    let a = dot(d, d);
    let nearest = -dot(o, d) / a;
    let p = along(o, nearest, d);
    let bound = (Dd::ONE + r) * (Dd::ONE + r) - dot(&p, &p);
    if bound <= Dd::ZERO {
        return Vec::new();
    }
    let bound = (bound / a).sqrt() * number(1.001);
    let k = dot(&p, &p) + Dd::ONE - r * r;
    let across = |v: &Vec3, w: &Vec3| v[1] * w[1] + v[2] * w[2];
    let four = number(4.0);
    let polynomial = [
        a * a,
        Dd::ZERO,
        (a * k + a * k) - four * across(d, d),
        -(four + four) * across(&p, d),
        k * k - four * across(&p, &p),
    ];
    let end = |u: Dd| {
        let q = along(&p, u, d);
        // Half the gradient of the quartic, halved once more.
        let w = dot(&q, &q) + Dd::ONE - r * r;
        let outward = [w * q[0], (w - Dd::ONE - Dd::ONE) * q[1], (w - Dd::ONE - Dd::ONE) * q[2]];
        curved(nearest + u, outward)
    };
    let found = roots(&polynomial, -bound, bound);
    found.chunks_exact(2).map(|pair| [end(pair[0]), end(pair[1])]).collect()
}

/// True if a point of the plane is inside of a polygon: the edges that pass it turn around it.
fn winds(points: &[[Dd; 2]], x: Dd, y: Dd) -> bool {
    let mut turns = 0;
    for (k, a) in points.iter().enumerate() {
        let b = &points[(k + 1) % points.len()];
        let left = (b[0] - a[0]) * (y - a[1]) - (x - a[0]) * (b[1] - a[1]);
        if a[1] <= y && b[1] > y && left > Dd::ZERO {
            turns += 1;
        } else if a[1] > y && b[1] <= y && left < Dd::ZERO {
            turns -= 1;
        }
    }
    turns != 0
}

fn prism(numbers: &[Dd], o: &Vec3, d: &Vec3) -> Vec<[End; 2]> {
    let points: Vec<[Dd; 2]> = numbers.chunks_exact(2).map(|pair| [pair[0], pair[1]]).collect();
    let twice = points.iter().enumerate().fold(Dd::ZERO, |sum, (k, a)| {
        let b = &points[(k + 1) % points.len()];
        sum + a[0] * b[1] - a[1] * b[0]
    });
    let sign = if twice < Dd::ZERO { -Dd::ONE } else { Dd::ONE };
    // Every plane that the line passes, with its outward normal.
    let mut ends: Vec<End> = Vec::new();
    if d[2] != Dd::ZERO {
        let normal = |z: Dd| [Dd::ZERO, Dd::ZERO, z];
        ends.push(curved(-o[2] / d[2], normal(-Dd::ONE)));
        ends.push(curved((Dd::ONE - o[2]) / d[2], normal(Dd::ONE)));
    }
    for (k, a) in points.iter().enumerate() {
        let b = &points[(k + 1) % points.len()];
        let outward = [(b[1] - a[1]) * sign, (a[0] - b[0]) * sign, Dd::ZERO];
        let toward = outward[0] * d[0] + outward[1] * d[1];
        if toward != Dd::ZERO {
            let off = outward[0] * (a[0] - o[0]) + outward[1] * (a[1] - o[1]);
            ends.push(curved(off / toward, outward));
        }
    }
    ends.sort_by(|a, b| a.t.partial_cmp(&b.t).expect("planes are met at numbers"));
    // Between two planes the line is inside or outside; what has no length is left out.
    let mut spans: Vec<[End; 2]> = Vec::new();
    let mut open: Option<End> = None;
    for pair in ends.windows(2) {
        let middle = along(o, (pair[0].t + pair[1].t) * number(0.5), d);
        let between = middle[2] > Dd::ZERO && middle[2] < Dd::ONE;
        let inside = pair[0].t < pair[1].t && between && winds(&points, middle[0], middle[1]);
        match (inside, open) {
            (true, None) => open = Some(facing(pair[0], &ends, d, -1.0)),
            (false, Some(from)) if pair[0].t < pair[1].t => {
                spans.push([from, facing(pair[0], &ends, d, 1.0)]);
                open = None;
            }
            _ => {}
        }
    }
    if let (Some(from), Some(last)) = (open, ends.last()) {
        spans.push([from, *last]);
    }
    spans
}

/// Of planes met at the same place the one that a line which enters (−1) or leaves (1) passes.
fn facing(end: End, ends: &[End], d: &Vec3, way: f64) -> End {
    let same = ends.iter().filter(|other| other.t == end.t);
    let best = same.max_by(|a, b| {
        let slope = |end: &End| way * dot(&unit(&end.outward), d).value();
        slope(a).total_cmp(&slope(b))
    });
    best.copied().unwrap_or(end)
}

/// Heights at the corners of the cells, asked for straight from above: what they are is no matter of geometry.
fn heights(form: &Form, cells: u32) -> Vec<Vec<Dd>> {
    let along = |k: u32| 2.0 * f64::from(k) / f64::from(cells) - 1.0;
    let height = |x: u32, z: u32| {
        let ray = Ray { origin: [along(x), 1.0, along(z)], direction: [0.0, -1.0, 0.0] };
        number(1.0 - form.span_at(&ray, f64::NEG_INFINITY).from)
    };
    (0..=cells).map(|z| (0..=cells).map(|x| height(x, z)).collect()).collect()
}

/// Every line of the grid is a place to stop; from one to the next the ground is a plane.
fn terrain(form: &Form, o: &Vec3, d: &Vec3) -> Vec<[End; 2]> {
    let cells =
        (0..10).find(|detail| f64::from(*detail) >= form.arguments()[2]).map_or(1, |k| 1 << k);
    let heights = heights(form, cells);
    let size = number(2.0 / f64::from(cells));
    let axis = |k: usize, sign: f64| -> Vec3 {
        std::array::from_fn(|i| if i == k { number(sign) } else { Dd::ZERO })
    };
    // The block.
    let (mut low, mut high): (Option<End>, Option<End>) = (None, None);
    for k in 0..3 {
        for sign in [-1.0, 1.0] {
            let (from, along) = (o[k] * number(sign), d[k] * number(sign));
            let end = || curved((Dd::ONE - from) / along, axis(k, sign));
            if along < Dd::ZERO && low.is_none_or(|low| low.t < end().t) {
                low = Some(end());
            } else if along > Dd::ZERO && high.is_none_or(|high| high.t > end().t) {
                high = Some(end());
            } else if along == Dd::ZERO && from > Dd::ONE {
                return Vec::new();
            }
        }
    }
    let (Some(low), Some(high)) = (low, high) else { return Vec::new() };
    let mut stops = vec![low.t, high.t];
    let mut stop = |from: Dd, along: Dd, place: Dd| {
        if along != Dd::ZERO {
            stops.push((place - from) / along);
        }
    };
    for k in 0..=2 * cells {
        let place = size * Dd::from(k) - number(2.0);
        stop(o[0], d[0], place + Dd::ONE);
        stop(o[2], d[2], place + Dd::ONE);
        // The diagonals, where x + z is a whole number of cells.
        stop(o[0] + o[2], d[0] + d[2], place);
    }
    stops.retain(|t| low.t <= *t && *t <= high.t);
    stops.sort_by(|a, b| a.partial_cmp(b).expect("numbers"));
    let mut pieces: Vec<[End; 2]> = Vec::new();
    for pair in stops.windows(2).filter(|pair| pair[0] < pair[1]) {
        let (a, b) = (along(o, pair[0], d), along(o, pair[1], d));
        let middle = along(o, (pair[0] + pair[1]) * number(0.5), d);
        let cell = |p: Dd| ((p + Dd::ONE) / size).value().floor().clamp(0.0, f64::from(cells - 1));
        let (x, z) = (cell(middle[0]), cell(middle[2]));
        let at =
            |p: &Vec3| [(p[0] + Dd::ONE) / size - number(x), (p[2] + Dd::ONE) / size - number(z)];
        #[expect(clippy::cast_possible_truncation, clippy::cast_sign_loss, reason = "a cell")]
        let corner = |right: usize, behind: usize| heights[z as usize + behind][x as usize + right];
        let upper = at(&middle)[0] + at(&middle)[1] > Dd::ONE;
        let (base, slope) = if upper {
            let slope = [corner(1, 1) - corner(0, 1), corner(1, 1) - corner(1, 0)];
            (corner(1, 1) - slope[0] - slope[1], slope)
        } else {
            (corner(0, 0), [corner(1, 0) - corner(0, 0), corner(0, 1) - corner(0, 0)])
        };
        let above = |p: &Vec3| p[1] - base - slope[0] * at(p)[0] - slope[1] * at(p)[1];
        let (first, second) = (above(&a), above(&b));
        let outward = [-slope[0] / size, Dd::ONE, -slope[1] / size];
        let crossing = || {
            let t = pair[0] + (pair[1] - pair[0]) * (first / (first - second));
            curved(t, outward)
        };
        let begin = if pair[0] == low.t { low } else { curved(pair[0], outward) };
        let end = if pair[1] == high.t { high } else { curved(pair[1], outward) };
        match (first < Dd::ZERO, second < Dd::ZERO) {
            (true, true) => pieces.push([begin, end]),
            (true, false) => pieces.push([begin, crossing()]),
            (false, true) => pieces.push([crossing(), end]),
            (false, false) => {}
        }
    }
    let mut spans: Vec<[End; 2]> = Vec::new();
    for [from, to] in pieces {
        match spans.last_mut() {
            // Two planes that meet on a line meet in a rounding of it.
            Some(last) if (from.t - last[1].t).value() < 1e-25 * (1.0 + from.t.value().abs()) => {
                last[1] = to;
            }
            _ => spans.push([from, to]),
        }
    }
    spans
}
