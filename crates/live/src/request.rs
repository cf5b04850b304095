//! What the page sends, taken apart.

use glam::DVec3;
use scene::Camera;
use serde_json::Value;

/// The largest coordinate: larger ones are no place in a scene, and their digits no statement.
const LARGEST: f64 = 1e15;

/// A camera, and whether the picture is to get better from there.
pub(crate) fn view(body: &[u8]) -> Result<(Camera, bool), String> {
    let value: Value = serde_json::from_slice(body).map_err(|error| error.to_string())?;
    let number = |value: &Value, name: &str| {
        let number = value.as_f64().filter(|number| number.abs() <= LARGEST);
        number.ok_or_else(|| format!("{name}: expected a number up to {LARGEST:e}, found {value}"))
    };
    let vector = |name: &str| match value[name].as_array().map(Vec::as_slice) {
        Some([x, y, z]) => Ok(DVec3::new(number(x, name)?, number(y, name)?, number(z, name)?)),
        _ => Err(format!("{name}: expected three numbers, found {}", value[name])),
    };
    let flag =
        |name: &str| value[name].as_bool().ok_or_else(|| format!("{name}: expected true or false"));
    let camera = Camera {
        position: vector("position")?,
        target: vector("target")?,
        focal_length_mm: number(&value["focal_length"], "focal_length")?,
        parallel: flag("parallel")?,
    };
    if camera.focal_length_mm <= 0.0 {
        return Err("focal_length: expected a number above 0".into());
    }
    if camera.position == camera.target {
        return Err("target: expected another point than position".into());
    }
    Ok((camera, flag("settle")?))
}

/// Column and row, as `x=3&y=4`.
pub(crate) fn pixel(query: &str) -> Result<[u32; 2], String> {
    let value = |name: &str| {
        let mut pairs = query.split('&').filter_map(|pair| pair.split_once('='));
        let text = pairs.find(|(key, _)| *key == name).map(|(_, value)| value);
        text.and_then(|text| text.parse().ok())
            .ok_or_else(|| format!("{name}: expected a whole number"))
    };
    Ok([value("x")?, value("y")?])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn views_are_checked() {
        let good = r#"{"position":[0,1,9],"target":[0,0.5,0],"focal_length":35,"parallel":false,"settle":true}"#;
        let (camera, settle) = view(good.as_bytes()).unwrap();
        assert_eq!(camera.position, DVec3::new(0.0, 1.0, 9.0));
        assert_eq!(camera.target, DVec3::new(0.0, 0.5, 0.0));
        assert!((camera.focal_length_mm - 35.0).abs() < 1e-12 && settle && !camera.parallel);
        for (from, to, expected) in [
            ("[0,1,9]", "[0,1]", "position: expected three numbers"),
            ("[0,1,9]", "[0,1,1e16]", "position: expected a number up to 1e15"),
            ("[0,1,9]", "[0,1,\"9\"]", "position: expected a number"),
            ("[0,1,9]", "[0,0.5,0]", "another point than position"),
            ("35", "0", "focal_length: expected a number above 0"),
            ("35", "null", "focal_length: expected a number"),
            ("false", "0", "parallel: expected true or false"),
            ("true", "1", "settle: expected true or false"),
            ("}", "", "EOF"),
        ] {
            let error = view(good.replacen(from, to, 1).as_bytes()).unwrap_err();
            assert!(error.contains(expected), "{to}: {error}");
        }
        let deep = "[".repeat(100_000);
        assert!(view(deep.as_bytes()).is_err(), "nesting takes no stack");
    }

    #[test]
    fn pixels_are_two_numbers() {
        assert_eq!(pixel("x=3&y=4").unwrap(), [3, 4]);
        for query in ["", "x=3", "x=3&y=-1", "x=3&y=4.5", "x=3&y=99999999999"] {
            assert!(pixel(query).is_err(), "{query}");
        }
    }
}
