//! The image of a light in a mirror. Lights have no extent; their images have, so that mirrors show them.

use glam::DVec3;
use scene::Rgb;

use super::light::Arriving;

/// sin² of the angular radius of a light in a mirror, 0.25°: light of intensity 1 that comes from there alone is as
/// bright as this is small.
const DISC: f64 = 1.903_846_791_786_376e-5;
/// The square of the chord to its rim: 4 sin² of half the angle. Times π it is the solid angle of the disc.
const CHORD_SQUARED: f64 = 1.903_855_852_977_164e-5;

/// The disc in which rays that stand for a cone see a light.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Spark {
    chord_squared: f64,
    /// The share of the disc that is the light's.
    filled: f64,
    /// What is brighter is shown like this.
    white: f64,
}

impl Spark {
    /// Discs that are wider are filled by less than half a step of 8 bits of black: they need not be looked for in
    /// pictures that are clamped to white.
    pub(crate) const WIDEST: Self = Self { chord_squared: 0.125, filled: 1.0, white: 1.0 };

    /// Seen by mirrored rays that spread by `spread`, from edge to edge, over what one of them stands for, in a picture
    /// that shows no more than `white`.
    ///
    /// A cone wider than the light finds it more often, and is filled by it less: the disc grows by as much as it is
    /// dimmed. Without, a highlight on a small or strongly bent surface, or one seen in such, would be met by one ray
    /// in thousands, a white dot. It is dimmed after it is cut to `white`, so that few rays show what many show.
    pub(crate) fn seen_by(spread: f64, white: f64) -> Self {
        // The disc about a square: of rays side by side one is in it.
        let wide = CHORD_SQUARED + 0.5 * spread * spread;
        // No farther than all around.
        let chord_squared = if wide < 4.0 { wide } else { 4.0 };
        Self { chord_squared, filled: CHORD_SQUARED / chord_squared, white }
    }

    /// What a mirror that reflects `share` makes of a light, for each unit of the light that arrives.
    pub(crate) fn shine(&self, view: DVec3, normal: DVec3, light: &Arriving, share: Rgb) -> Rgb {
        let mirrored = 2.0 * normal.dot(view) * normal - view;
        if (mirrored - light.toward).length_squared() > self.chord_squared {
            return Rgb::ZERO;
        }
        let (whole, white) = (share / DISC, self.white / light.color);
        self.filled * Rgb::select(whole.cmplt(white), whole, white)
    }

    /// False only if what lies `offset` away is not in the disc about the unit `direction`: most does, and is found so
    /// without a root.
    pub(crate) fn may_hold(&self, offset: DVec3, direction: DVec3) -> bool {
        let (square, along) = (offset.length_squared(), direction.dot(offset));
        // sin² of twice the angle is no more than this; past a right angle nothing is said.
        let beside = 4.0 * self.chord_squared;
        !(1e-200..1e200).contains(&square)
            || beside >= 1.0
            || (along > 0.0 && along * along > (1.0 - beside) * square)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use scene::transform::sin_cos_degrees;

    fn arriving(toward: DVec3) -> Arriving {
        Arriving { toward, distance: f64::INFINITY, color: Rgb::ONE }
    }

    #[test]
    fn the_disc_is_a_quarter_degree() {
        let s = libm::sin(0.25 * std::f64::consts::PI / 180.0);
        let h = libm::sin(0.125 * std::f64::consts::PI / 180.0);
        assert!((DISC / (s * s) - 1.0).abs() < 1e-9, "{}", s * s);
        assert!((CHORD_SQUARED / (4.0 * h * h) - 1.0).abs() < 1e-9, "{}", 4.0 * h * h);
        let spark = Spark::seen_by(0.0, f64::INFINITY);
        for (angle, inside) in [(0.0, true), (0.249, true), (0.251, false), (90.0, false)] {
            let (s, c) = sin_cos_degrees(angle);
            let light = arriving(DVec3::new(s, 0.0, c));
            let expected = Rgb::splat(if inside { 0.3 / DISC } else { 0.0 });
            assert_eq!(
                spark.shine(DVec3::Z, DVec3::Z, &light, Rgb::splat(0.3)),
                expected,
                "{angle}°"
            );
        }
    }

    #[test]
    fn what_is_wider_than_the_widest_does_not_show() {
        let spread = (2.0 * Spark::WIDEST.chord_squared).sqrt();
        let spark = Spark::seen_by(spread, 1.0);
        assert!(spark.chord_squared > Spark::WIDEST.chord_squared, "{spark:?}");
        let steps = 255.0 * 12.92 * spark.filled;
        assert!(steps < 0.52, "of black: {steps}");
    }

    #[test]
    fn white_is_cut_before_it_is_spread() {
        let light = Arriving { color: Rgb::new(2.0, 0.5, 0.0), ..arriving(DVec3::Z) };
        for spread in [0.0, 0.01, 0.3] {
            let spark = Spark::seen_by(spread, 4.0);
            let found = light.color * spark.shine(DVec3::Z, DVec3::Z, &light, Rgb::splat(0.5));
            let expected = spark.filled * Rgb::new(4.0, 4.0, 0.0);
            assert!(found.abs_diff_eq(expected, 1e-12), "{spread}: {found}");
        }
        let faint = Rgb::splat(1e-6);
        let found = Spark::seen_by(0.0, 4.0).shine(DVec3::Z, DVec3::Z, &light, faint);
        assert_eq!(found, faint / DISC, "below white nothing is cut");
    }

    #[test]
    fn wide_rays_see_as_much_light() {
        for spread in [1e-9, 1e-4, 0.01, 0.1, 1.0, 3.0, 100.0] {
            let wide = Spark::seen_by(spread, f64::INFINITY);
            let off = wide.filled * wide.chord_squared / CHORD_SQUARED - 1.0;
            assert!(off.abs() < 1e-15 && wide.filled <= 1.0, "{spread}: {wide:?}");
            assert!(wide.filled * 4.0 >= CHORD_SQUARED, "{spread}: {wide:?}");
        }
    }

    /// A mirror of radius 1 that parallel rays `apart` from each other look at from above, with a light 40° off: what
    /// they see of it, of a light of irradiance π.
    fn sum_over_a_sphere(apart: f64, shift: (f64, f64), spark: &Spark) -> f64 {
        let (s, c) = sin_cos_degrees(40.0);
        let light = arriving(DVec3::new(s, 0.0, c));
        let at = |step: i32, shift: f64| (f64::from(step) + shift) * apart;
        let (mut sum, mut step) = (0.0, 0);
        while at(step, 0.0) < 1.0 {
            let ring = |k| [(k, step), (k, -step), (step, k), (-step, k)];
            for (i, j) in (-step..=step).flat_map(ring) {
                // Corners twice.
                let share = if i.abs() == j.abs() { 0.5 } else { 1.0 };
                let (x, y) = (at(i, shift.0), at(j, shift.1));
                let below = 1.0 - x * x - y * y;
                if below > 0.0 {
                    let normal = DVec3::new(x, y, below.sqrt());
                    sum += share * spark.shine(DVec3::Z, normal, &light, Rgb::ONE).x;
                }
            }
            step += 1;
        }
        sum * apart * apart
    }

    #[test]
    fn few_rays_see_what_many_see() {
        // The sphere sends what it gets, π · π, alike to all sides; what is cut to white is as much less.
        for (white, expected) in [
            (f64::INFINITY, std::f64::consts::FRAC_PI_4),
            (1.0, DISC * std::f64::consts::FRAC_PI_4),
        ] {
            for apart in [0.003, 0.02, 0.1] {
                let shifts = (0..64_u32).map(|k| (f64::from(k % 8) / 8.0, f64::from(k / 8) / 8.0));
                let all = |spark: Spark| -> Vec<f64> {
                    shifts.clone().map(|shift| sum_over_a_sphere(apart, shift, &spark)).collect()
                };
                // The normal turns by as much as the ray is wide, and the mirrored ray twice as much.
                let wide = all(Spark::seen_by(2.0 * apart, white));
                let small = all(Spark::seen_by(0.0, white));
                let mean = wide.iter().sum::<f64>() / 64.0;
                assert!((mean / expected - 1.0).abs() < 0.1, "{apart}: {mean}");
                let missed = |found: &[f64]| found.iter().filter(|f| **f < 0.2 * expected).count();
                assert_eq!(missed(&wide), 0, "{apart}: a highlight is missed: {wide:?}");
                assert!(apart < 0.01 || missed(&small) > 30, "{apart}: {}", missed(&small));
            }
        }
    }

    #[test]
    fn what_shows_in_a_mirror_may_be_held() {
        let (point, at) = (DVec3::new(300.0, -20.0, 40.0), DVec3::new(0.0, 1000.0, -100.0));
        let offset = at - point;
        let (toward, aside) = (offset.normalize(), DVec3::X.cross(offset).normalize());
        let (small, wide) = (Spark::seen_by(0.0, 1.0), Spark::seen_by(0.2, 1.0));
        for (degrees, expected) in
            [(0.0, [true; 2]), (0.26, [true; 2]), (0.6, [false, true]), (90.0, [false; 2])]
        {
            let (s, c) = sin_cos_degrees(degrees);
            let direction = c * toward + s * aside;
            let found = [small, wide].map(|spark| spark.may_hold(offset, direction));
            assert_eq!(found, expected, "{degrees}°");
        }
        assert!(small.may_hold(DVec3::ZERO, DVec3::X), "no direction from where the light is");
        assert!(Spark::seen_by(3.0, 1.0).may_hold(offset, -toward), "all around");
    }
}
