//! `--watch`: the program serves its page to a client that is no browser.

use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::net::TcpStream;
use std::path::Path;
use std::process::{Child, Command, Stdio};
use std::time::Duration;

use idf::Samples;
use tempfile::TempDir;

use super::{folder, portray, says};

/// A program that watches, and is ended with the test.
struct Watching {
    child: Child,
    host: String,
    token: String,
}

impl Drop for Watching {
    fn drop(&mut self) {
        self.child.kill().ok();
        self.child.wait().ok();
    }
}

struct Answer {
    status: u16,
    head: String,
    body: Vec<u8>,
}

impl Answer {
    fn field(&self, name: &str) -> &str {
        let start = format!("{name}: ");
        let line = self.head.lines().find_map(|line| line.strip_prefix(&start));
        line.unwrap_or_else(|| panic!("{name}: {}", self.head))
    }

    fn text(&self) -> &str {
        std::str::from_utf8(&self.body).unwrap()
    }
}

impl Watching {
    fn new(folder: &Path, arguments: &str) -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_portray"))
            .current_dir(folder)
            .args(arguments.split_whitespace())
            .arg("--watch")
            .stdout(Stdio::piped())
            .stderr(Stdio::null())
            .spawn()
            .unwrap();
        let mut line = String::new();
        BufReader::new(child.stdout.take().unwrap()).read_line(&mut line).unwrap();
        let address = line.trim().strip_prefix("http://").unwrap();
        let (host, path) = address.split_once('/').unwrap();
        let token = path.strip_suffix('/').unwrap();
        assert!(host.starts_with("127.0.0.1:") && token.len() == 32, "{line}");
        Self { child, host: host.into(), token: token.into() }
    }

    fn ask(&self, method: &str, path: &str, fields: &str, body: &str) -> Answer {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let length = body.len();
        let text = format!(
            "{method} {path} HTTP/1.1\r\n{fields}Connection: close\r\nContent-Length: {length}\r\n\r\n{body}"
        );
        stream.write_all(text.as_bytes()).unwrap();
        let mut bytes = Vec::new();
        stream.read_to_end(&mut bytes).unwrap();
        let end = bytes.windows(4).position(|four| four == b"\r\n\r\n").unwrap();
        let head = String::from_utf8(bytes[..end].to_vec()).unwrap();
        let status = head.split(' ').nth(1).unwrap().parse().unwrap();
        Answer { status, head, body: bytes[end + 4..].to_vec() }
    }

    fn here(&self, method: &str, path: &str, body: &str) -> Answer {
        let fields = format!("Host: {}\r\n", self.host);
        self.ask(method, &format!("/{}/{path}", self.token), &fields, body)
    }

    /// States of the page as they come, the last of those in between.
    fn events(&self) -> impl Iterator<Item = String> + use<> {
        let mut stream = TcpStream::connect(&self.host).unwrap();
        stream.set_read_timeout(Some(Duration::from_secs(60))).unwrap();
        let (token, host) = (&self.token, &self.host);
        write!(stream, "GET /{token}/events HTTP/1.1\r\nHost: {host}\r\n\r\n").unwrap();
        let mut silences = 0;
        let lines = BufReader::new(stream).lines().map(Result::unwrap);
        lines.filter_map(move |line| {
            // The server says so every ten seconds.
            silences += u32::from(line.starts_with(": still here"));
            assert!(silences < 12, "nothing happens");
            line.strip_prefix("data: ").map(str::to_owned)
        })
    }
}

/// What an image over its background is on a screen.
fn shown(folder: &Path, name: &str) -> Vec<u8> {
    let image =
        idf::exchange::read_image(&folder.join(name), &idf::ReadOptions::default()).unwrap();
    assert_eq!(image.planes().len(), 3, "the background is painted in");
    let planes: Vec<&[u8]> = image
        .planes()
        .iter()
        .map(|plane| match &plane.samples {
            Samples::U8(bytes) => bytes.as_slice(),
            other => panic!("8 bits: {other:?}"),
        })
        .collect();
    let pixels = planes[0].iter().zip(planes[1]).zip(planes[2]);
    pixels.flat_map(|((&r, &g), &b)| [r, g, b, 255]).collect()
}

#[test]
fn the_page_has_the_bytes_of_the_picture() {
    for options in ["--samples 1", "", "--samples 4 --dither-output", "--error 3 --filter tent"] {
        let folder = folder();
        let line = format!("good.sdl -o out.ppm --size 48x33 {options}");
        let output = portray(folder.path(), &line, "");
        assert_eq!((output.status.code(), says(&output)), (Some(0), String::new()), "{options}");
        let expected = shown(folder.path(), "out.ppm");
        let watching = Watching::new(folder.path(), &format!("good.sdl --size 48x33 {options}"));
        // Where nothing is asked for pictures get better than that.
        let mut pictures = Vec::new();
        for state in watching.events() {
            let answer = watching.here("GET", "picture", "");
            if answer.status == 200 {
                assert_eq!((answer.field("X-Columns"), answer.field("X-Rows")), ("48", "33"));
                pictures.push(answer.body == expected);
            }
            if state.contains(r#""stage":"finished""#) {
                break;
            }
        }
        if options.is_empty() {
            assert!(!pictures.is_empty());
        } else {
            assert_eq!(pictures.last(), Some(&true), "{options}: {pictures:?}");
        }
    }
}

#[test]
fn strangers_are_not_answered() {
    let folder = folder();
    let watching = Watching::new(folder.path(), "good.sdl --size 8x8");
    let Watching { host, token, .. } = &watching;
    let own = format!("Host: {host}\r\n");
    let port = host.split_once(':').unwrap().1;
    let wrong = token.chars().rev().collect::<String>();
    for (path, fields, status) in [
        (format!("/{token}/"), own.clone(), 200),
        (format!("/{token}/"), format!("{own}Origin: http://{host}\r\n"), 200),
        ("/".to_owned(), own.clone(), 404),
        ("/picture".to_owned(), own.clone(), 404),
        (format!("/{token}"), own.clone(), 404),
        (format!("/{wrong}/"), own.clone(), 404),
        (format!("/{}/", &token[..31]), own.clone(), 404),
        (format!("/{token}/../page.js"), own.clone(), 404),
        (format!("/{token}/"), "Host: example.org\r\n".to_owned(), 403),
        (format!("/{token}/"), format!("Host: localhost:{port}\r\n"), 403),
        (format!("/{token}/"), "Host: 127.0.0.1\r\n".to_owned(), 403),
        (format!("/{token}/"), format!("{own}{own}"), 403),
        (format!("/{token}/"), String::new(), 403),
        (format!("/{token}/"), format!("{own}Origin: http://example.org\r\n"), 403),
        (format!("/{token}/"), format!("{own}Origin: null\r\n"), 403),
    ] {
        let answer = watching.ask("GET", &path, &fields, "");
        let right = if status == 200 { "<!doctype html>" } else { "not here" };
        assert_eq!(answer.status, status, "{path} {fields}");
        assert!(answer.text().starts_with(right), "{path} {fields}: {}", answer.text());
    }
    let page = watching.here("GET", "", "");
    assert!(page.field("Content-Security-Policy").starts_with("default-src 'none'"));
    for outside in ["http://", "https://", "//cdn"] {
        for file in ["", "page.css", "page.js"] {
            let text = watching.here("GET", file, "");
            assert!(!text.text().contains(outside), "{file} needs nothing of {outside}");
        }
    }
    assert_eq!(watching.here("PUT", "view", "").status, 405);
    assert_eq!(watching.here("POST", "view", &" ".repeat(5000)).status, 413);
    assert_eq!(watching.here("POST", "view", "{}").status, 400);
    assert_eq!(watching.here("GET", "pixel?x=1", "").status, 400);
}

/// Waits for a state that a text is in.
fn wait(events: &mut impl Iterator<Item = String>, text: &str) -> String {
    events.find(|state| state.contains(text)).unwrap_or_else(|| panic!("no state with {text}"))
}

#[test]
fn a_scene_is_edited() {
    let folder = TempDir::new().unwrap();
    let write = |name: &str, text: &str| fs::write(folder.path().join(name), text).unwrap();
    write("part.sdl", "object ball is red sphere\n");
    write(
        "scene.sdl",
        "include \"part.sdl\"\nobject is blue block at (1.5, 0, 0) scale (0.1, 0.1, 0.1)\nambient intensity 1\ncamera at (0, 0, 9)\n",
    );
    let watching = Watching::new(folder.path(), "scene.sdl --size 21x21 --samples 1");
    let mut events = watching.events();
    wait(&mut events, r#""stage":"finished""#);
    let middle = |answer: &Answer| answer.body[(10 * 21 + 10) * 4..][..4].to_vec();
    assert_eq!(middle(&watching.here("GET", "picture", "")), [255, 0, 0, 255]);

    let pixel = watching.here("GET", "pixel?x=10&y=10", "");
    for part in [
        r#""object":1"#,
        r#""name":"ball""#,
        r#""line":1"#,
        r#"part.sdl""#,
        r#""depth":8"#,
        r#""normal":["#,
        r#""text":"object ball is red sphere""#,
    ] {
        assert!(pixel.text().contains(part), "{part}: {}", pixel.text());
    }
    assert_eq!(watching.here("GET", "pixel?x=0&y=0", "").text(), r#"{"found":null}"#);
    assert_eq!(watching.here("GET", "pixel?x=21&y=0", "").text(), r#"{"found":null}"#);

    // A file that is included counts as the scene does.
    write("part.sdl", "object ball is green sphere\n");
    wait(&mut events, r#""picture":2"#);
    let green = middle(&watching.here("GET", "picture", ""));
    assert!(green[1] > green[0], "{green:?}");

    // The last good picture stays, with what is wrong beside it.
    write("part.sdl", "// a\nobject ball is gren sphere\n");
    let state = wait(&mut events, r#""error":true"#);
    assert!(state.contains(r#""line":2"#) && state.contains("part.sdl"), "{state}");
    assert!(state.contains("^^^^") && state.contains("hint: "), "caret and hint: {state}");
    assert_eq!(middle(&watching.here("GET", "picture", "")), green);
    write("part.sdl", "object ball is white sphere\n");
    // What is wrong and the picture come in any order.
    events
        .find(|state| state.contains(r#""problems":[]"#) && state.contains(r#""picture":3"#))
        .unwrap();
    assert_eq!(middle(&watching.here("GET", "picture", "")), [255; 4]);

    // What is missing may come.
    fs::remove_file(folder.path().join("part.sdl")).unwrap();
    let state = wait(&mut events, r#""error":true"#);
    assert!(state.contains("cannot read"), "{state}");
    write("part.sdl", "object ball is red sphere\n");
    wait(&mut events, r#""picture":4"#);
    assert_eq!(middle(&watching.here("GET", "picture", "")), [255, 0, 0, 255]);
}

#[test]
fn pictures_from_elsewhere_are_those_of_their_statement() {
    let folder = folder();
    let watching = Watching::new(folder.path(), "good.sdl --size 32x24 --samples 1");
    let mut events = watching.events();
    wait(&mut events, r#""stage":"finished""#);
    let view = |settle: bool| {
        format!(
            r#"{{"position":[3,2.5,8],"target":[0,0.5,0],"focal_length":40,"parallel":false,"settle":{settle}}}"#
        )
    };
    let look = watching.here("POST", "view", &view(false));
    assert_eq!(look.status, 200, "{}", look.text());
    let statement = look.field("X-Camera").to_owned();
    assert_eq!(statement, "camera at (3, 2.5, 8) target at (0, 0.5, 0) focal length 40");
    // The page's picture of the board stays until the movement ends.
    assert_eq!(watching.here("POST", "view", &view(true)).status, 204);
    let state = wait(&mut events, r#""picture":2"#);
    assert!(state.contains(&statement), "{state}");
    let settled = watching.here("GET", "picture", "");

    // With the statement in the text the program makes the same; while the camera moves, faint rays are left out.
    let text = fs::read_to_string(folder.path().join("good.sdl")).unwrap();
    let text = text.replace("camera at (0, 1, 9)", &statement);
    fs::write(folder.path().join("moved.sdl"), text).unwrap();
    for (weight, expected) in [("", settled.body), ("--min-weight 0.015625", look.body)] {
        let line = format!("moved.sdl --size 32x24 --samples 1 {weight} -o moved.ppm");
        let output = portray(folder.path(), &line, "");
        assert_eq!(output.status.code(), Some(0), "{}", says(&output));
        assert!(shown(folder.path(), "moved.ppm") == expected, "{line}");
    }

    // Back to where the text says.
    assert_eq!(watching.here("POST", "reset", "").status, 204);
    let state = wait(&mut events, r#""picture":3"#);
    assert!(state.contains("camera at (0, 1, 9) target at (0, 0, 0) focal length 50"), "{state}");
}

#[test]
fn a_picture_in_the_scene_is_read_again_when_it_changes() {
    let folder = TempDir::new().unwrap();
    let color = |channels: &str| {
        let text = format!("P3 1 1 255 {channels}\n");
        fs::write(folder.path().join("paper.ppm"), text).unwrap();
    };
    color("255 0 0");
    let text =
        "object is paint image (\"paper.ppm\") block\nambient intensity 1\ncamera at (0, 0, 9)\n";
    fs::write(folder.path().join("scene.sdl"), text).unwrap();
    let watching = Watching::new(folder.path(), "scene.sdl --size 9x9 --samples 1");
    let mut events = watching.events();
    wait(&mut events, r#""stage":"finished""#);
    let middle = |answer: Answer| answer.body[(4 * 9 + 4) * 4..][..4].to_vec();
    let view = r#"{"position":[1,0,8],"target":[0,0,0],"focal_length":50,"parallel":false,"settle":false}"#;
    assert_eq!(middle(watching.here("GET", "picture", "")), [255, 0, 0, 255]);
    // The text is the same, and the length of the file too.
    color("0 0 255");
    wait(&mut events, r#""picture":2"#);
    assert_eq!(middle(watching.here("GET", "picture", "")), [0, 0, 255, 255]);
    fs::remove_file(folder.path().join("paper.ppm")).unwrap();
    let state = wait(&mut events, r#""error":true"#);
    assert!(state.contains("paper.ppm") && state.contains(r#""line":1"#), "{state}");
    // The last good scene can still be looked at from elsewhere: what was read is kept.
    let look = watching.here("POST", "view", view);
    assert_eq!(look.status, 200, "{}", look.text());
    assert_eq!(middle(look), [0, 0, 255, 255]);
    color("0 255 0");
    wait(&mut events, r#""picture":3"#);
    assert_eq!(middle(watching.here("GET", "picture", "")), [0, 255, 0, 255]);
}

#[test]
fn watching_refuses_what_has_no_effect() {
    let folder = folder();
    for (line, expected) in [
        ("good.sdl --watch -o x.png", "cannot be used with"),
        ("good.sdl --watch --frames 1..2", "cannot be used with"),
        ("good.sdl --watch --part 0/2", "cannot be used with"),
        ("good.sdl --watch --window 0,0,8,8", "cannot be used with"),
        ("good.sdl --watch --stats x.json", "cannot be used with"),
        ("good.sdl --watch --seconds 3", "cannot be used with"),
        ("good.sdl --watch --channels rgb", "cannot be used with"),
        ("good.sdl --watch --raw", "cannot be used with"),
        ("good.sdl --watch --terminal --open", "cannot be used with"),
        ("good.sdl --terminal", "--watch"),
        ("good.sdl --open", "--watch"),
        ("good.sdl bad.sdl --watch", "unexpected argument"),
        ("- --watch", "found `-`"),
        ("good.sdl --watch --error 0", "--error 0"),
    ] {
        let output = portray(folder.path(), line, "");
        assert_eq!(output.status.code(), Some(2), "{line}: {}", says(&output));
        assert!(says(&output).contains(expected), "{line}: {}", says(&output));
    }
    let output = portray(folder.path(), "none.sdl --watch", "");
    assert_eq!(output.status.code(), Some(1));
    assert!(says(&output).contains("none.sdl"), "{}", says(&output));
}

#[test]
fn a_scene_without_a_picture_yet_can_be_watched() {
    let folder = folder();
    let watching = Watching::new(folder.path(), "bad.sdl --size 8x8 --samples 1");
    let mut events = watching.events();
    let state = wait(&mut events, r#""error":true"#);
    assert!(state.contains("glas") && state.contains(r#""picture":0"#), "{state}");
    assert_eq!(watching.here("GET", "picture", "").status, 404);
    let view = r#"{"position":[0,0,1],"target":[0,0,0],"focal_length":50,"parallel":false,"settle":false}"#;
    assert_eq!(watching.here("POST", "view", view).status, 409);
    // No camera: found when it is loaded, not when it is compiled.
    fs::write(folder.path().join("bad.sdl"), "object is sphere").unwrap();
    wait(&mut events, "no camera");
    fs::write(folder.path().join("bad.sdl"), "object is sphere camera at (0, 0, 9)").unwrap();
    wait(&mut events, r#""picture":1"#);
}

#[test]
#[cfg(unix)]
fn the_terminal_gets_the_finished_picture() {
    use std::os::unix::fs::PermissionsExt;

    let folder = folder();
    // It keeps what it is given, and fails, so that the program ends.
    let ishow = folder.path().join("ishow");
    fs::write(&ishow, "#!/bin/sh\ncat > got.png\nexit 3\n").unwrap();
    fs::set_permissions(&ishow, fs::Permissions::from_mode(0o755)).unwrap();
    let path = std::env::var("PATH").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_portray"))
        .current_dir(folder.path())
        .args(["good.sdl", "--watch", "--terminal", "--size", "40x30"])
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .output()
        .unwrap();
    assert_eq!(output.status.code(), Some(1), "{}", says(&output));
    assert!(says(&output).contains("ishow: exit status: 3"), "{}", says(&output));
    assert!(output.stdout.is_empty(), "no address: there is no page");
    let written = portray(folder.path(), "good.sdl -o out.ppm --size 40x30", "");
    assert_eq!(written.status.code(), Some(0));
    assert_eq!(shown(folder.path(), "got.png"), shown(folder.path(), "out.ppm"));
}

#[test]
#[cfg(unix)]
fn a_signal_waits_until_the_terminal_is_put_back() {
    use std::os::unix::fs::PermissionsExt;
    use std::os::unix::process::ExitStatusExt;

    let folder = folder();
    // The program is told to end while this one has the terminal.
    let ishow = folder.path().join("ishow");
    let script = "#!/bin/sh\ncat > got.png\nkill -INT $PPID\ni=0\nwhile [ $i -lt 30000 ]; do i=$((i + 1)); done\n\
                  touch put-back\nexit 3\n";
    fs::write(&ishow, script).unwrap();
    fs::set_permissions(&ishow, fs::Permissions::from_mode(0o755)).unwrap();
    let path = std::env::var("PATH").unwrap();
    let output = Command::new(env!("CARGO_BIN_EXE_portray"))
        .current_dir(folder.path())
        .args(["good.sdl", "--watch", "--terminal", "--size", "16x12"])
        .env("PATH", format!("{}:{path}", folder.path().display()))
        .output()
        .unwrap();
    assert_eq!(output.status.signal(), Some(2), "{}", says(&output));
    assert!(folder.path().join("put-back").exists(), "it was waited for");
    assert!(!says(&output).contains("ishow"), "{}", says(&output));
}
