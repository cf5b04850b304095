//! Normals under uneven scaling, by the paper's way: three points of the tangent plane are moved, and give the normal.

use glam::DVec3;
use scene::Placement;

use crate::oracle::author::Chance;

#[test]
fn three_points_of_the_plane_give_the_normal() {
    let mut chance = Chance::new(8);
    let (mut most, mut slant) = (0.0_f64, 0.0_f64);
    for _ in 0..4000 {
        let mut three = |low, high| DVec3::from_array([(); 3].map(|()| chance.between(low, high)));
        let sizes = three(-2.0, 2.0).to_array().map(libm::exp10);
        let scale = DVec3::from_array(sizes) * three(-1.0, 1.0).signum();
        let rotation_degrees = three(-360.0, 360.0);
        let map = Placement { scale, rotation_degrees, place: DVec3::ZERO }.map();
        let normal = three(-1.0, 1.0).normalize();
        let found = map.gradient_outward(normal).normalize();
        let (u, v) = normal.any_orthonormal_pair();
        // u, v and the normal are right-handed; a mirror turns them, by the sign of its scale.
        let [origin, a, b] = [DVec3::ZERO, u, v].map(|point| map.outward(point));
        let (along, across) = (a - origin, b - origin);
        let handed = normal.dot(u.cross(v)).signum() * scale.signum().element_product();
        let expected = handed * along.cross(across).normalize();
        most = most.max((found - expected).length());
        for tangent in [along, across] {
            slant = slant.max(found.dot(tangent.normalize()).abs());
        }
    }
    assert!(most < 1e-10, "{most:e} apart");
    assert!(slant < 1e-12, "{slant:e} off the plane");
}

#[test]
fn a_normal_by_hand() {
    let normal = DVec3::ONE.normalize();
    let turned = DVec3::new(0.0, 0.0, 30.0);
    for (scale, rotation_degrees, expected) in [
        ((2.0, 1.0, 0.5), DVec3::ZERO, (0.218_217_89, 0.436_435_78, 0.872_871_56)),
        ((2.0, 1.0, 0.5), turned, (-0.029_235_65, 0.487_073_42, 0.872_871_56)),
        ((-2.0, 1.0, 0.5), DVec3::ZERO, (-0.218_217_89, 0.436_435_78, 0.872_871_56)),
    ] {
        let map = Placement { scale: scale.into(), rotation_degrees, place: DVec3::ONE }.map();
        let found = map.gradient_outward(normal).normalize();
        let off = (found - DVec3::from(expected)).length();
        assert!(off < 1e-8, "{scale:?} {rotation_degrees}: {found}");
    }
}
