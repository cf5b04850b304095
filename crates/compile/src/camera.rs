//! A camera as the statement that says it.

use glam::DVec3;
use scene::{Camera, Lens};

/// The statement of a camera, with its lens if it has one, on one line of ASCII: what it compiles to is the same camera.
/// Parallel rays have no lens.
///
/// ```
/// let camera = scene::Camera {
///     position: glam::DVec3::new(0.0, 1.5, 9.0),
///     target: glam::DVec3::ZERO,
///     focal_length_mm: 35.0,
///     parallel: false,
/// };
/// let text = compile::camera::statement(&camera, None);
/// assert_eq!(text, "camera at (0, 1.5, 9) target at (0, 0, 0) focal length 35");
/// ```
#[must_use]
pub fn statement(camera: &Camera, lens: Option<&Lens>) -> String {
    let parallel = if camera.parallel { " parallel" } else { "" };
    let lens = lens.filter(|_| !camera.parallel).map_or_else(String::new, |lens| {
        format!(" aperture {} focus at {}", lens.aperture, vector(lens.focus))
    });
    format!(
        "camera{parallel} at {}{lens} target at {} focal length {}",
        vector(camera.position),
        vector(camera.target),
        camera.focal_length_mm
    )
}

/// Shortest digits that are read as the same number.
fn vector(place: DVec3) -> String {
    // Zero has no sign that a picture shows.
    let [x, y, z] = place.to_array().map(|number| number + 0.0);
    format!("({x}, {y}, {z})")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn statements_compile_to_the_camera_they_are_of() {
        let place = DVec3::new(-0.1, 1e-7, 12_345_678.25);
        for (parallel, lens) in [
            (false, None),
            (true, None),
            (false, Some(Lens { aperture: 2.8, focus: DVec3::new(0.5, 0.0, -3.0) })),
        ] {
            let camera = Camera {
                position: place,
                target: DVec3::new(0.0, -2.5, 1.0 / 3.0),
                focal_length_mm: 85.5,
                parallel,
            };
            let text = statement(&camera, lens.as_ref());
            let compiled = crate::compile_text(format!("object is sphere\n{text}"));
            let scene = compiled.scene.unwrap_or_else(|| panic!("{text}"));
            assert_eq!((scene.camera, scene.lens), (Some(camera), lens), "{text}");
        }
        let zero = Camera { position: DVec3::new(-0.0, 0.0, 1.0), ..sample() };
        assert!(statement(&zero, None).starts_with("camera at (0, 0, 1)"));
    }

    fn sample() -> Camera {
        Camera {
            position: DVec3::Z,
            target: DVec3::ZERO,
            focal_length_mm: Camera::FOCAL_LENGTH_MM,
            parallel: false,
        }
    }

    #[test]
    fn objects_know_where_they_are_written() {
        let text = "object is sphere\nrepeat i from 1 to 2 { object is sphere at (i, 0, 0) }\ncamera at (0, 0, 9)";
        let compiled = crate::compile_text(text);
        let line = |&span: &crate::Span| compiled.sources.locate(span).unwrap().line;
        assert_eq!(compiled.objects.iter().map(line).collect::<Vec<_>>(), [1, 2, 2]);
        assert_eq!(compiled.scene.unwrap().objects.len(), 3);
    }
}
