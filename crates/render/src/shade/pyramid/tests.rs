//! Levels by hand, and means against sums over texels.

use super::*;

fn placed(x: f64, y: f64, edge: Edge) -> Placed {
    Placed { place: DVec2::new(x, y), edges: [edge; 2], period: f64::INFINITY }
}

fn gray(columns: usize, rows: usize, of: impl Fn(usize, usize) -> f32) -> Pyramid<1> {
    let texels = (0..columns * rows).map(|i| [of(i % columns, i / columns)]).collect();
    Pyramid::new(columns, rows, texels)
}

const POINT: [DVec2; 2] = [DVec2::ZERO; 2];

#[test]
fn the_first_row_is_the_top() {
    let picture = gray(2, 2, |column, row| [[0.1, 0.2], [0.3, 0.4]][row][column]);
    for (x, y, expected) in
        [(0.25, 0.75, 0.1), (0.75, 0.75, 0.2), (0.25, 0.25, 0.3), (0.75, 0.25, 0.4)]
    {
        let [found] = picture.mean(&placed(x, y, Edge::Tiled), POINT, Between::Straight);
        assert!((found - expected).abs() < 1e-6, "{x} {y}: {found}");
    }
    // In the middle of all four, and on the edge between the columns.
    let [found] = picture.mean(&placed(0.5, 0.5, Edge::Tiled), POINT, Between::Straight);
    assert!((found - 0.25).abs() < 1e-6, "{found}");
    let [found] = picture.mean(&placed(0.5, 0.75, Edge::Once), POINT, Between::Straight);
    assert!((found - 0.15).abs() < 1e-6, "{found}");
}

#[test]
fn edges_are_kept() {
    let picture = gray(2, 1, |column, _| [0.0, 1.0][column]);
    for (x, edge, expected) in [
        // The edge of a tile lies between its last and its first texel.
        (0.0, Edge::Tiled, 0.5),
        (1.0, Edge::Tiled, 0.5),
        (-0.25, Edge::Tiled, 1.0),
        (5.75, Edge::Tiled, 1.0),
        (0.0, Edge::Held(1.0), 0.0),
        (1.0, Edge::Held(1.0), 1.0),
        (1.0, Edge::Held(2.0), 0.5),
        (2.0, Edge::Held(2.0), 1.0),
        (1.0, Edge::Once, 0.5),
        (1.3, Edge::Once, 0.0),
        (-0.3, Edge::Once, 0.0),
        (1e300, Edge::Tiled, 0.0),
    ] {
        let at = Placed { place: DVec2::new(x, 0.5), edges: [edge, Edge::Tiled], period: 1.0 };
        let [found] = picture.mean(&at, POINT, Between::Straight);
        assert!((found - expected).abs() < 1e-6, "{x} {edge:?}: {found}");
    }
}

#[test]
fn every_level_has_the_mean_of_the_picture() {
    for (columns, rows) in [(1, 1), (2, 2), (3, 5), (64, 64), (100, 37), (1, 9), (31, 2)] {
        let picture =
            gray(columns, rows, |column, row| ((column * 7 + row * 3) % 11) as f32 / 10.0);
        let mean = |level: &Level<1>| {
            let sum: f64 = level.texels.iter().map(|[value]| f64::from(*value)).sum();
            sum / level.texels.len() as f64
        };
        let expected = mean(&picture.levels[0]);
        for level in &picture.levels {
            let found = mean(level);
            assert!((found - expected).abs() < 1e-5, "{columns} x {rows}: {found}, not {expected}");
        }
        let last = picture.levels.last().unwrap();
        assert_eq!((last.columns, last.rows), (1, 1), "{columns} x {rows}");
    }
}

#[test]
fn the_axes_of_an_ellipse() {
    // Half edges a, b are conjugate radii: the longest and shortest of a cos t + b sin t, looked for.
    for (a, b) in [
        (DVec2::new(3.0, 0.0), DVec2::new(0.0, 1.0)),
        (DVec2::new(0.0, 1.0), DVec2::new(3.0, 1.0)),
        (DVec2::new(1.0, 1.0), DVec2::new(2.0, 2.5)),
        (DVec2::new(1.0, 0.0), DVec2::new(1.0, 0.0)),
    ] {
        let radius = |i: u32| {
            let angle = f64::from(i) * std::f64::consts::TAU / 100_000.0;
            (libm::cos(angle) * a + libm::sin(angle) * b).length()
        };
        let most = (0..100_000).map(radius).fold(0.0, f64::max);
        let least = (0..100_000).map(radius).fold(f64::INFINITY, f64::min);
        let [major, minor] = axes([a, b]);
        assert!((major.length() - most).abs() < 1e-6, "{a} {b}: {major}");
        assert!((minor.length() - least).abs() < 1e-4, "{a} {b}: {minor}");
        assert!(major.dot(minor).abs() < 1e-12, "{a} {b}");
    }
}

#[test]
fn means_are_near_sums_over_the_part() {
    // A picture of stripes and spots, and slanted parts of it: the probes against 64 × 64 places, a triangle as wide as a
    // texel about each.
    let picture = gray(128, 128, |column, row| {
        f32::from(u8::from((column / 5 + row / 9) % 2 == 0)) * 0.8
            + (column * row % 7) as f32 * 0.02
    });
    let mut worst: f64 = 0.0;
    for i in 0..60 {
        let f = f64::from(i);
        let place = placed(f * 0.618 % 1.0, f * 0.377 % 1.0, Edge::Tiled);
        let (angle, long) = (f * 0.7, 0.01 + 0.004 * f);
        let (sine, cosine) = (libm::sin(angle), libm::cos(angle));
        let edges = [long * DVec2::new(cosine, sine), 0.02 * DVec2::new(-sine, cosine)];
        let mut sum = 0.0;
        for k in 0..4096_u32 {
            let (a, b) =
                ((f64::from(k % 64) + 0.5) / 64.0 - 0.5, (f64::from(k / 64) + 0.5) / 64.0 - 0.5);
            let at = place.place + a * edges[0] + b * edges[1];
            sum += picture.mean(&placed(at.x, at.y, Edge::Tiled), POINT, Between::Straight)[0];
        }
        let [found] = picture.mean(&place, edges, Between::Straight);
        worst = worst.max((found - sum / 4096.0).abs());
    }
    assert!(worst < 0.12, "{worst}");
}

#[test]
fn curves_have_no_steps_in_their_slope() {
    let picture = gray(8, 1, |column, _| f32::from(u8::from(column == 3)));
    let at = |x: f64| {
        let at = Placed { place: DVec2::new(x, 0.5), edges: [Edge::Tiled; 2], period: 1.0 };
        picture.mean(&at, POINT, Between::Curved)[0]
    };
    // A quadratic B-spline has 3/4 in the middle, 1/2 half a texel off, 1/8 a whole one, and nothing from 3/2 on.
    for (x, expected) in [(3.5, 0.75), (3.0, 0.5), (4.5, 0.125), (5.0, 0.0), (2.0, 0.0)] {
        let found = at(x / 8.0);
        assert!((found - expected).abs() < 1e-6, "{x}: {found}");
    }
    for i in 0..800 {
        let (x, step) = (f64::from(i) / 800.0, 1e-4);
        let slope = |x: f64| (at(x + step) - at(x)) / step;
        assert!((slope(x + step) - slope(x)).abs() < 128.0 * 1.1 * step + 1e-6, "at {x}");
    }
}
