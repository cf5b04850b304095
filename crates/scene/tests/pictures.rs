//! Pictures in the compiled scene file: round trips and messages.

use scene::format;

/// Pictures, and paint that shows them.
const PICTURES: &str = r#"portray scene 2
image 0 "a.png"
image 1 "b \"c\"\\d.png"
attributes 1
  paint image mapping box u 2.0 v 1.0 file 1
attributes 2
  paint bump height -0.1 of noise scale 1.0 octaves 2.0 color 1.0 0.0 0.0
  paint bump height 0.1 of decal mapping surface u 0.5 v 0.5 width 0.5 height 0.25 file 0
  paint projection at 0.0 0.0 4.0 toward 0.0 1.0 0.0 angle 30.0 file 0 color 0.0 0.0 1.0
end
"#;

#[test]
fn pictures_are_written_as_they_are_read() {
    let scene = format::read(PICTURES.as_bytes()).unwrap();
    let mut text = Vec::new();
    format::write(&scene, &mut text).unwrap();
    assert_eq!(String::from_utf8(text).unwrap(), PICTURES);
    let paths: Vec<&str> = scene.images.iter().map(|image| image.path.as_str()).collect();
    assert_eq!(paths, ["a.png", r#"b "c"\d.png"#]);
    assert_eq!((scene.images[1].line, scene.images[1].column), (3, 9), "for messages");
}

#[test]
fn pictures_that_are_not_there_are_refused() {
    for (from, to, message) in [
        ("image 1", "image 2", "line 3, column 7: expected number 1, the next in order, found `2`"),
        ("\"a.png\"", "a.png", "line 2, column 9: expected a file name in quotes, found `a.png`"),
        ("\"a.png\"", "\"\"", "line 2, column 9: expected a file name in quotes, found `\\\"\\\"`"),
        (
            "a.png\"",
            "a\\.png\"",
            "line 2, column 9: expected a file name in quotes, found `\\\"a\\\\.png\\\"`",
        ),
        ("a.png\"", "a.png", "line 2, column 9: expected a file name in quotes, found `\\\"a.png`"),
        ("file 1", "file 2", "line 5, column 44: expected an image from 0 to 1, found `2`"),
        ("box", "boxed", "line 5, column 23: expected an argument in its range, found `boxed`"),
        (
            "of noise",
            "of bump height 0.1 of noise",
            "line 7, column 29: expected a texture function that is no relief, found `bump`",
        ),
        (" file 0\n", "\n", "line 8, column 83: expected `file`, found the end of the line"),
        (
            "0.0 4.0 toward",
            "0.0 toward",
            "line 9, column 31: expected an argument in its range, found `toward`",
        ),
    ] {
        assert!(PICTURES.contains(from), "{from}");
        let text = PICTURES.replacen(from, to, 1);
        let error = format::read(text.as_bytes()).unwrap_err().to_string();
        assert_eq!(error, message, "{from} → {to}");
    }
}
