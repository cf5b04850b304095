//! Files as the protocol names them.

use std::path::{Path, PathBuf};

use lsp_types::Uri;

/// The path that a URI stands for. What is no file keeps its URI for a name.
pub(crate) fn path(uri: &Uri) -> PathBuf {
    let text = uri.as_str();
    let Some(rest) = text.strip_prefix("file://") else { return PathBuf::from(text) };
    // A host may stand in front of the path.
    let path = rest.find('/').map_or(rest, |start| &rest[start..]);
    let path = decoded(path);
    // A drive: /c:/scenes.
    let drive = cfg!(windows) && path.as_bytes().get(2) == Some(&b':');
    PathBuf::from(if drive { &path[1..] } else { &path })
}

/// The URI of a path; `None` if it is not absolute.
pub(crate) fn from_path(path: &Path) -> Option<Uri> {
    let path = if path.is_absolute() { path.to_owned() } else { path.canonicalize().ok()? };
    let mut text = String::from("file://");
    let path = path.to_string_lossy().replace(std::path::MAIN_SEPARATOR, "/");
    if !path.starts_with('/') {
        text.push('/');
    }
    for byte in path.bytes() {
        if byte.is_ascii_alphanumeric() || b"-._~/".contains(&byte) {
            text.push(char::from(byte));
        } else {
            text.push_str(&format!("%{byte:02X}"));
        }
    }
    text.parse().ok()
}

fn decoded(text: &str) -> String {
    let mut bytes = Vec::with_capacity(text.len());
    let mut rest = text.as_bytes();
    while let [byte, after @ ..] = rest {
        let pair = after.get(..2).filter(|_| *byte == b'%');
        let value =
            pair.and_then(|pair| u8::from_str_radix(std::str::from_utf8(pair).ok()?, 16).ok());
        bytes.push(value.unwrap_or(*byte));
        rest = if value.is_some() { &after[2..] } else { after };
    }
    String::from_utf8_lossy(&bytes).into_owned()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[cfg(unix)]
    #[test]
    fn paths_by_hand() {
        for (uri, expected) in [
            ("file:///a/b.sdl", "/a/b.sdl"),
            ("file:///a%20b/%C3%9F.sdl", "/a b/ß.sdl"),
            ("file://host/a.sdl", "/a.sdl"),
            ("untitled:Untitled-1", "untitled:Untitled-1"),
        ] {
            assert_eq!(path(&uri.parse().unwrap()), Path::new(expected), "{uri}");
        }
        assert_eq!(
            from_path(Path::new("/a b/ß.sdl")).unwrap().as_str(),
            "file:///a%20b/%C3%9F.sdl"
        );
        assert_eq!(decoded("100%"), "100%", "no pair");
    }
}
