//! A sum of sine waves, the same again in every cube with edges of `1 / scale`.

use glam::DVec3;

use super::filter::wave_left;
use super::lattice::split;
use super::whole;
use super::{Domain, Function, Parameter, Range, Spot, Weight};

/// Waves a cube along each axis, and the phase in turns. Amplitudes are inverse to the lengths; no two are parallel.
const WAVES: [(DVec3, f64); 12] = [
    (DVec3::new(1.0, 1.0, 0.0), 0.0),
    (DVec3::new(1.0, -1.0, 1.0), 0.375),
    (DVec3::new(0.0, 1.0, 2.0), 0.75),
    (DVec3::new(-2.0, 1.0, 1.0), 0.125),
    (DVec3::new(2.0, 2.0, -1.0), 0.5),
    (DVec3::new(1.0, -3.0, 0.0), 0.875),
    (DVec3::new(0.0, 2.0, -3.0), 0.25),
    (DVec3::new(3.0, 0.0, 2.0), 0.625),
    (DVec3::new(-3.0, -2.0, 2.0), 0.0625),
    (DVec3::new(2.0, 4.0, 1.0), 0.4375),
    (DVec3::new(4.0, -1.0, -3.0), 0.8125),
    (DVec3::new(-1.0, 4.0, 4.0), 0.1875),
];

pub(super) const FUNCTION: Function = Function {
    keyword: "fourier",
    domain: Domain::Solid,
    parameters: &[
        Parameter { name: "scale", default: 1.0, range: Range::Above(0.0) },
        Parameter { name: "waves", default: 12.0, range: Range::Whole(1, 12) },
    ],
    weight: Weight::Formula(|arguments, &Spot { point: p, width }| {
        let [x, y, z] = (p * arguments[0]).to_array().map(|along| split(along).1);
        let place = DVec3::new(x, y, z);
        let waves = WAVES.iter().take(whole(arguments[1]) as usize);
        let (sum, all) = waves.fold((0.0, 0.0), |(sum, all), &(k, phase)| {
            let share = 1.0 / k.length();
            let (_, turn) = split(k.dot(place) + phase);
            let across = k * width * arguments[0];
            let left = wave_left(across.x) * wave_left(across.y) * wave_left(across.z);
            (sum + left * share * libm::sin(std::f64::consts::TAU * turn), all + share)
        });
        0.5 + 0.5 * sum / all
    }),
};
