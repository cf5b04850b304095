//! Gradient noise on the integer lattice and its sums of octaves (Perlin, "An Image Synthesizer", 1985).

use glam::DVec3;

/// Smooth noise of feature size 1, in −1…1, 0 at lattice points.
///
/// Past 2³¹ units from the origin neighbouring lattice points share their hash; the value stays in range.
pub(super) fn noise(p: DVec3) -> f64 {
    let cell = DVec3::new(libm::floor(p.x), libm::floor(p.y), libm::floor(p.z));
    let f = p - cell;
    let fade = |t: f64| t * t * t * (t * (t * 6.0 - 15.0) + 10.0);
    let (u, v, w) = (fade(f.x), fade(f.y), fade(f.z));
    let corner = |x: f64, y: f64, z: f64| {
        let offset = DVec3::new(x, y, z);
        slope(hash(cell + offset), f - offset)
    };
    let mix = |t: f64, a: f64, b: f64| a + t * (b - a);
    let sheet = |z: f64| {
        let near = mix(u, corner(0.0, 0.0, z), corner(1.0, 0.0, z));
        let far = mix(u, corner(0.0, 1.0, z), corner(1.0, 1.0, z));
        mix(v, near, far)
    };
    mix(w, sheet(0.0), sheet(1.0))
}

/// Sum of `octaves` of the absolute noise, each of half the size and half the weight of the one before; 0…2.
pub(super) fn turbulence(p: DVec3, octaves: u32) -> f64 {
    let (mut sum, mut scale) = (0.0, 1.0);
    for _ in 0..octaves {
        sum += noise(p * scale).abs() / scale;
        scale *= 2.0;
    }
    sum
}

/// One of twelve directions to the edges of a cube, dotted with `f`.
fn slope(hash: u32, f: DVec3) -> f64 {
    let h = hash % 12;
    let (a, b) = match h / 4 {
        0 => (f.x, f.y),
        1 => (f.x, f.z),
        _ => (f.y, f.z),
    };
    (if h & 1 == 0 { a } else { -a }) + (if h & 2 == 0 { b } else { -b })
}

fn hash(cell: DVec3) -> u32 {
    cell.to_array().into_iter().fold(0x9e37_79b9_u32, |state, coordinate| {
        #[expect(clippy::cast_possible_truncation, reason = "saturates, and wraps to its low half")]
        let bits = coordinate as i64 as i32;
        let mut x = (state ^ bits.cast_unsigned()).wrapping_mul(0x85eb_ca6b);
        x ^= x >> 13;
        x = x.wrapping_mul(0xc2b2_ae35);
        x ^ x >> 16
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_is_zero_on_the_lattice_and_smooth_between() {
        for i in -20..20 {
            let f = f64::from(i);
            assert!(noise(DVec3::new(f, 2.0 * f, -f)).abs() < 1e-15, "lattice point {i}");
            let p = DVec3::new(f * 0.37, f * 0.11, f * 0.73);
            let step = noise(p + DVec3::splat(1e-7)) - noise(p);
            assert!(step.abs() < 1e-6, "no jump at {p}");
        }
    }

    #[test]
    fn noise_is_balanced() {
        let (mut sum, mut square) = (0.0, 0.0);
        for i in 0..20_000 {
            let f = f64::from(i);
            let n = noise(DVec3::new(f * 0.618, f * 0.377, f * 0.271));
            sum += n;
            square += n * n;
        }
        assert!((sum / 20_000.0).abs() < 0.02, "mean {}", sum / 20_000.0);
        assert!(square / 20_000.0 > 0.03, "it varies: {}", square / 20_000.0);
    }
}
