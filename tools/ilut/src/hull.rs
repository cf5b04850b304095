//! The place nearest to a colour that mixes of a table's entries can show.

/// How near the nearest place of the hull must be found, as a square in display steps.
const CLOSE: f32 = 0.02;

/// The place nearest to `goal` in the hull of `entries`, of which there is one at least, after
/// at most so many `steps`; in `weights` the share that each entry has in it.
///
/// Weight goes from the entry that lies worst to the one that lies best (pairwise steps of Frank
/// and Wolfe; Lacoste-Julien and Jaggi, "On the global linear convergence of Frank-Wolfe
/// optimization variants", 2015).
pub fn nearest_in_hull(
    goal: [f32; 3],
    entries: &[[f32; 3]],
    steps: usize,
    weights: &mut Vec<f32>,
) -> [f32; 3] {
    let dot = |a: [f32; 3], b: [f32; 3]| a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
    let minus = |a: [f32; 3], b: [f32; 3]| -> [f32; 3] { std::array::from_fn(|i| a[i] - b[i]) };
    let square = |at: usize| dot(minus(entries[at], goal), minus(entries[at], goal));
    let mut first = (0, f32::MAX);
    for at in 0..entries.len() {
        first = if square(at) < first.1 { (at, square(at)) } else { first };
    }
    let first = first.0;
    weights.clear();
    weights.resize(entries.len(), 0.0);
    weights[first] = 1.0;
    let mut place = entries[first];
    for _ in 0..steps {
        let off = minus(place, goal);
        let (mut best, mut worst) = (first, None);
        for (at, &entry) in entries.iter().enumerate() {
            let along = dot(off, entry);
            best = if along < dot(off, entries[best]) { at } else { best };
            let is_worse = worst.is_none_or(|worst: usize| along > dot(off, entries[worst]));
            worst = if weights[at] > 0.0 && is_worse { Some(at) } else { worst };
        }
        let Some(worst) = worst else { break };
        let way = minus(entries[best], entries[worst]);
        let gap = -dot(off, way);
        if gap <= CLOSE || dot(off, off) <= CLOSE {
            break;
        }
        let step = (gap / dot(way, way)).min(weights[worst]);
        weights[worst] = if step < weights[worst] { weights[worst] - step } else { 0.0 };
        weights[best] += step;
        place = std::array::from_fn(|axis| place[axis] + step * way[axis]);
    }
    place
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_place_is_the_foot_on_the_face_and_the_mean_of_its_entries() {
        let entries = [[0.0; 3], [100.0, 0.0, 0.0], [0.0, 100.0, 0.0], [0.0, 0.0, 100.0]];
        let mut weights = Vec::new();
        for (goal, expected) in [
            ([10.0, 20.0, 30.0], [10.0, 20.0, 30.0]),
            ([20.0, 30.0, -50.0], [20.0, 30.0, 0.0]),
            ([200.0, 200.0, 200.0], [100.0 / 3.0; 3]),
            ([-9.0, -9.0, -9.0], [0.0; 3]),
            ([300.0, 0.0, 0.0], [100.0, 0.0, 0.0]),
        ] {
            let place = nearest_in_hull(goal, &entries, 100, &mut weights);
            assert!((weights.iter().sum::<f32>() - 1.0).abs() < 1e-5, "{weights:?}");
            assert!(weights.iter().all(|weight| *weight >= 0.0), "{weights:?}");
            for axis in 0..3 {
                let mean: f32 = entries.iter().zip(&weights).map(|(e, w)| e[axis] * w).sum();
                assert!((place[axis] - mean).abs() < 1e-3, "{place:?}, {weights:?}");
                assert!((place[axis] - expected[axis]).abs() < 0.5, "{goal:?}: {place:?}");
            }
        }
    }
}
