//! The solids with arguments: a torus as a quartic, and a prism as the points of a line between its planes.

use scene::Form;

use super::body::{End, Surface};
use super::dd::{Dd, Vec3, along, dot, unit};

/// What a form reaches about the origin of its own space.
pub(crate) fn reach(form: &Form) -> f64 {
    match form.row().keyword {
        "torus" => 1.0 + form.arguments()[0],
        _ => form.arguments().iter().fold(1.0, |most, x| f64::max(most, x.abs())),
    }
}

/// The spans of a line inside of a form, with gradients in its own space at their ends.
pub(crate) fn spans(form: &Form, o: &Vec3, d: &Vec3) -> Vec<[End; 2]> {
    let arguments: Vec<Dd> = form.arguments().iter().copied().map(Dd::from).collect();
    match form.row().keyword {
        "torus" => torus(arguments[0], o, d),
        "prism" => prism(&arguments, o, d),
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
    (0..degree).map(|k| polynomial[k] * Dd::from(u32::try_from(degree - k).unwrap())).collect()
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
        End { t: nearest + u, outward, surface: Surface::Curved }
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
        ends.push(End { t: -o[2] / d[2], outward: normal(-Dd::ONE), surface: Surface::Curved });
        ends.push(End {
            t: (Dd::ONE - o[2]) / d[2],
            outward: normal(Dd::ONE),
            surface: Surface::Curved,
        });
    }
    for (k, a) in points.iter().enumerate() {
        let b = &points[(k + 1) % points.len()];
        let outward = [(b[1] - a[1]) * sign, (a[0] - b[0]) * sign, Dd::ZERO];
        let toward = outward[0] * d[0] + outward[1] * d[1];
        if toward != Dd::ZERO {
            let off = outward[0] * (a[0] - o[0]) + outward[1] * (a[1] - o[1]);
            ends.push(End { t: off / toward, outward, surface: Surface::Curved });
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
