//! Names of outputs: what cannot be written is refused before any work.

use std::path::Path;

use super::{UsageError, is_stream};
use crate::exchange::Format;
use crate::exchange::endings;

/// Formats that one program alone writes: what to say to who asks another for it.
const ELSEWHERE: [(&str, &str); 4] = [
    ("gif", "iencode writes .gif"),
    ("six", "iencode writes .six"),
    ("sixel", "iencode writes .sixel"),
    ("lut", "ilut writes .lut"),
];

/// Refuses the name of an output whose ending stands for no format that is written: a program
/// calls this before it reads anything. `others` are the endings that it writes besides those of
/// [`write_image`](crate::exchange::write_image); `gif` is one of these, as only indices make one.
/// Without an ending, IDF is written; `-` is standard output.
///
/// # Errors
///
/// If the ending is another; the message lists those there are.
pub fn check_output(name: &Path, others: &[&str]) -> Result<(), UsageError> {
    let Some(ending) = name.extension().filter(|_| !is_stream(name)) else { return Ok(()) };
    let ending = ending.to_string_lossy().to_ascii_lowercase();
    let format = Format::of(name);
    let is_written = match format {
        Some(Format::Gif) | None => others.contains(&&*ending),
        Some(format) => format.is_written(),
    };
    if is_written {
        return Ok(());
    }
    let usual = endings(true);
    let usual = usual.split(' ').filter(|&found| found != ".gif").map(str::to_owned);
    let expected: Vec<String> =
        usual.chain(others.iter().map(|other| format!(".{other}"))).collect();
    let elsewhere = ELSEWHERE.iter().find(|(other, _)| *other == ending);
    let hint = match (elsewhere, format) {
        (Some((_, hint)), _) => (*hint).to_owned(),
        (None, Some(_)) => format!(".{ending} is only read; .png is as widely known"),
        (None, None) => format!("as an IDF image: {}.idf", name.display()),
    };
    Err(UsageError(format!(
        "cannot write `{}`: found .{ending}, expected a name that ends in {}, or one without an \
         ending for IDF; {hint}",
        name.display(),
        expected.join(" ")
    )))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_what_can_be_written_passes() {
        for name in ["x", "x.idf", "a/x.PNG", "x.exr", "x.ppm", "x.pam", "-", "v1.2/x"] {
            assert_eq!(check_output(Path::new(name), &[]), Ok(()), "{name}");
        }
        for name in ["x.jpg", "x.webp", "x.tga", "x.gif", "x.lut", "v1.2", "x."] {
            assert!(check_output(Path::new(name), &[]).is_err(), "{name}");
        }
        for name in ["x.gif", "x.LUT"] {
            assert_eq!(check_output(Path::new(name), &["gif", "lut"]), Ok(()), "{name}");
        }
    }

    #[test]
    fn the_message_says_what_would_do() {
        let message = |name: &str, others: &[&str]| {
            check_output(Path::new(name), others).unwrap_err().to_string()
        };
        assert_eq!(
            message("a/x.jpg", &["six"]),
            "cannot write `a/x.jpg`: found .jpg, expected a name that ends in .idf .png .exr .ppm \
             .pgm .pbm .pnm .pam .six, or one without an ending for IDF; .jpg is only read; .png \
             is as widely known"
        );
        assert!(message("x.gif", &[]).ends_with("; iencode writes .gif"));
        assert!(message("x.lut", &["gif"]).contains(".pam .gif, or"));
        assert!(message("v1.2", &[]).ends_with("; as an IDF image: v1.2.idf"));
    }
}
