//! The real program in a pseudo terminal, whose other end the test plays.
#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::ffi::OsString;
use std::fs::{File, OpenOptions};
use std::io::{Read, Write};
use std::os::unix::ffi::OsStringExt as _;
use std::os::unix::fs::OpenOptionsExt as _;
use std::os::unix::process::ExitStatusExt as _;
use std::path::Path;
use std::process::{Command, ExitStatus, Stdio};
use std::thread;

use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use idf::exchange::read_stream;
use idf::{Image, Kind, Plane, ReadOptions, Samples, WriteOptions, write};
use rustix::fs::OFlags;
use rustix::io::ioctl_fionread;
use rustix::process::{Pid, Signal, kill_process};
use rustix::pty::{OpenptFlags, grantpt, openpt, ptsname, unlockpt};
use rustix::termios::{LocalModes, OptionalActions, Winsize, tcgetattr, tcsetattr, tcsetwinsize};

/// Ends what a terminal got; no program writes it.
const END: &[u8] = b"\x1b[~end";
/// The last question.
const ATTRIBUTES: &[u8] = b"\x1b[c";

/// What the terminal does when it is asked.
#[derive(Clone, Copy)]
enum Reply {
    /// Answers.
    Bytes(&'static [u8]),
    /// Nothing, but the program gets a signal.
    Signal(Signal),
    /// Nothing.
    Silence,
}

/// What came of a run.
struct Outcome {
    status: ExitStatus,
    /// What the terminal got, its line ends as they were written.
    drawn: String,
    errors: String,
}

/// A folder with `wine`: 40 x 30, red, covered but for its upper half.
fn folder() -> tempfile::TempDir {
    let folder = tempfile::tempdir().unwrap();
    let plane = |kind, samples| Plane { kind, samples: Samples::U8(samples) };
    let coverage = (0..40 * 30).map(|at| if at < 40 * 15 { 0 } else { 255 });
    let coverage: Vec<u8> = coverage.collect();
    let planes = vec![
        plane(Kind::Red, coverage.clone()),
        plane(Kind::Grn, vec![0; 40 * 30]),
        plane(Kind::Blu, vec![0; 40 * 30]),
        plane(Kind::Cvg, coverage),
    ];
    let wine = Image::new(40, 30, planes).unwrap();
    write(&folder.path().join("wine"), &wine, &WriteOptions::default()).unwrap();
    folder
}

/// Runs `ishow wine` with `arguments` in a terminal of 80 x 24, and checks that it leaves the
/// terminal as it was, with nothing to read on it.
fn shown(arguments: &str, environment: [&str; 2], reply: Reply) -> Outcome {
    let (outcome, left) = typed("", arguments, environment, reply);
    assert_eq!(left, "", "nothing is left to read");
    outcome
}

/// The same after some keys, and what is left to read in the end.
fn typed(keys: &str, arguments: &str, environment: [&str; 2], reply: Reply) -> (Outcome, String) {
    let folder = folder();
    let flags = OpenptFlags::RDWR | OpenptFlags::NOCTTY;
    let controller = openpt(flags).unwrap();
    grantpt(&controller).unwrap();
    unlockpt(&controller).unwrap();
    let size = Winsize { ws_row: 24, ws_col: 80, ws_xpixel: 0, ws_ypixel: 0 };
    tcsetwinsize(&controller, size).unwrap();
    let name = OsString::from_vec(ptsname(&controller, Vec::new()).unwrap().into_bytes());
    let no_control = i32::try_from(OFlags::NOCTTY.bits()).unwrap();
    let mut terminal =
        OpenOptions::new().read(true).write(true).custom_flags(no_control).open(name).unwrap();
    let before = tcgetattr(&terminal).unwrap();
    let mut controller = File::from(controller);
    controller.write_all(keys.as_bytes()).unwrap();
    let mut program = Command::new(env!("CARGO_BIN_EXE_ishow"))
        .arg("wine")
        .args(arguments.split_whitespace())
        .current_dir(folder.path())
        .env("TERM", environment[0])
        .env("COLORTERM", environment[1])
        .stdin(terminal.try_clone().unwrap())
        .stdout(terminal.try_clone().unwrap())
        .stderr(Stdio::piped())
        .spawn()
        .unwrap();
    let process = Pid::from_child(&program);
    let player = thread::spawn(move || play(controller, process, reply));
    let status = program.wait().unwrap();
    let mut errors = String::new();
    program.stderr.take().unwrap().read_to_string(&mut errors).unwrap();
    let after = tcgetattr(&terminal).unwrap();
    assert_eq!(format!("{before:?}"), format!("{after:?}"), "the modes are as before");
    terminal.write_all(END).unwrap();
    let (controller, drawn) = player.join().unwrap();
    // Without line editing all input is to be seen, not only whole lines.
    let mut plain = after;
    plain.local_modes.remove(LocalModes::ICANON);
    tcsetattr(&terminal, OptionalActions::Now, &plain).unwrap();
    let mut left = vec![0; usize::try_from(ioctl_fionread(&terminal).unwrap()).unwrap()];
    terminal.read_exact(&mut left).unwrap();
    drop(controller);
    (Outcome { status, drawn, errors }, String::from_utf8(left).unwrap())
}

/// Plays the terminal until [`END`] comes; what it got till then.
fn play(mut controller: File, process: Pid, reply: Reply) -> (File, String) {
    let contains = |bytes: &[u8], part: &[u8]| bytes.windows(part.len()).any(|at| at == part);
    let (mut got, mut is_asked) = (Vec::new(), false);
    while !contains(&got, END) {
        let mut some = [0; 4096];
        let count = controller.read(&mut some).unwrap();
        got.extend_from_slice(&some[..count]);
        if !is_asked && contains(&got, ATTRIBUTES) {
            is_asked = true;
            match reply {
                Reply::Bytes(bytes) => controller.write_all(bytes).unwrap(),
                Reply::Signal(signal) => kill_process(process, signal).unwrap(),
                Reply::Silence => {}
            }
        }
    }
    got.truncate(got.len() - END.len());
    (controller, String::from_utf8(got).unwrap().replace("\r\n", "\n"))
}

/// What is drawn after the questions, by a program that ends well.
fn drawn(arguments: &str, environment: [&str; 2], answers: &'static [u8]) -> String {
    let outcome = shown(arguments, environment, Reply::Bytes(answers));
    assert!(outcome.status.success() && outcome.errors.is_empty(), "{}", outcome.errors);
    let (questions, drawn) = outcome.drawn.split_once("\x1b[c").unwrap();
    assert!(questions.contains("\x1b_Gi=31,"), "{questions:?}");
    drawn.to_owned()
}

/// The picture of one kitty transmission.
fn kitty(drawn: &str) -> Image {
    let mut text = String::new();
    for chunk in drawn.split("\x1b\\").filter(|chunk| chunk.starts_with("\x1b_G")) {
        text.push_str(chunk.split_once(';').unwrap().1);
    }
    let png = STANDARD.decode(text).unwrap();
    read_stream(Path::new("x"), &png[..], &ReadOptions::default()).unwrap()
}

/// The colour of the first pixel.
fn corner(image: &Image) -> [u8; 3] {
    idf::plane::COLOR.map(|kind| match image.plane(kind) {
        Some(Samples::U8(samples)) => samples[0],
        other => panic!("{other:?}"),
    })
}

const KITTY: &[u8] = b"\x1b_Gi=31;OK\x1b\\\x1b]11;rgb:0000/8080/ffff\x1b\\\x1b[6;20;10t\x1b[?62;c";
const SIXEL: &[u8] = b"\x1b[?1;0;16S\x1b[6;20;10t\x1b[?62;4;22c";
const PLAIN: &[u8] = b"\x1b[?6c";
const XTERM: [&str; 2] = ["xterm", ""];

#[test]
fn kitty_gets_a_png_over_its_background() {
    let text = drawn("", XTERM, KITTY);
    assert!(text.starts_with("\x1b_Ga=T,f=100,q=2,m=0;") && text.ends_with("\x1b\\\n"), "{text:?}");
    assert_eq!(kitty(&text).size(), [40, 30]);
    assert_eq!(corner(&kitty(&text)), [0, 128, 255]);
    assert_eq!(corner(&kitty(&drawn("--matte #102030", XTERM, KITTY))), [0x10, 0x20, 0x30]);
    // 30 x 9 characters of 10 x 20 pixels are 300 x 180.
    assert_eq!(kitty(&drawn("--size 30x9", XTERM, KITTY)).size(), [240, 180]);
}

#[test]
fn sixel_is_drawn_in_the_registers_there_are() {
    let text = drawn("", XTERM, SIXEL);
    assert!(text.starts_with("\x1bP0;0;0q\"1;1;40;30#0;2;"), "{text:?}");
    assert!(text.ends_with("\x1b\\\n"), "{text:?}");
    assert!(text.contains("#1;2;100;0;0") && !text.contains("#2;2"), "two colours: {text:?}");
}

#[test]
fn others_get_half_blocks_in_the_colors_that_are_promised() {
    for (environment, red) in [
        (["xterm-256color", "truecolor"], "48;2;255;0;0"),
        (["xterm-256color", ""], "48;5;196"),
        (["xterm", ""], "101"),
    ] {
        let text = drawn("", environment, PLAIN);
        assert_eq!(text.matches('\n').count(), 15, "{text:?}");
        let last = text.lines().last().unwrap();
        assert_eq!(last, format!("\x1b[{red}m{}\x1b[0m", " ".repeat(40)));
        // Row 15 is the first red one, below the last black one.
        assert_eq!(text.lines().nth(7).unwrap().matches('▀').count(), 40);
    }
    let text = drawn("--colors 16", ["xterm-256color", "truecolor"], PLAIN);
    assert!(text.contains("\x1b[101m"), "{text:?}");
}

#[test]
fn the_protocol_can_be_chosen() {
    assert!(drawn("--blocks --colors true", XTERM, KITTY).starts_with("\x1b[48;2;0;128;255m "));
    assert!(drawn("--sixel", XTERM, KITTY).starts_with("\x1bP"));
    assert!(drawn("--kitty", XTERM, PLAIN).starts_with("\x1b_Ga=T"));
}

#[test]
fn keys_typed_before_are_left_to_the_shell() {
    // A line, and the beginning of the next.
    for keys in ["ls\n", "ls", "ls\nrm"] {
        let (outcome, left) = typed(keys, "", ["xterm-256color", ""], Reply::Silence);
        assert!(outcome.status.success(), "{}", outcome.errors);
        assert_eq!(left, keys);
        assert!(outcome.errors.contains("keys were typed before"), "{}", outcome.errors);
        assert!(outcome.drawn.contains('▀') && !outcome.drawn.contains("\x1b_G"), "not asked");
        let (outcome, left) = typed(keys, "--sixel", ["xterm", ""], Reply::Silence);
        assert_eq!((left.as_str(), outcome.errors.as_str()), (keys, ""));
    }
}

#[test]
fn keys_typed_after_the_answers_are_left_to_the_shell() {
    let reply = Reply::Bytes(b"\x1b[?62;4cls\n");
    let (outcome, left) = typed("", "", ["xterm", ""], reply);
    assert!(outcome.status.success() && outcome.drawn.contains("\x1bP"), "{}", outcome.errors);
    assert_eq!(left, "ls\n");
}

#[test]
fn keys_among_the_answers_are_not_drawn() {
    let text = drawn("", XTERM, b"ls\r\x1b[A\x1b_Gi=31;OK\x1b\\\x1b[?62;c");
    assert!(text.starts_with("\x1b_Ga=T"), "{text:?}");
}

#[test]
fn terminals_that_would_show_the_questions_are_not_asked() {
    let outcome = shown("", ["dumb", ""], Reply::Silence);
    assert!(outcome.status.success(), "{}", outcome.errors);
    // Red over the black of nothing, in text alone.
    assert!(outcome.drawn.contains("░░░"), "{:?}", outcome.drawn);
    assert!(!outcome.drawn.contains('\x1b'), "{:?}", outcome.drawn);
    for term in ["linux", ""] {
        let outcome = shown("", [term, ""], Reply::Silence);
        assert!(outcome.status.success(), "{}", outcome.errors);
        assert!(outcome.drawn.starts_with("\x1b[40m "), "{:?}", outcome.drawn);
    }
}

#[test]
fn a_terminal_that_does_not_answer_gets_half_blocks() {
    let outcome = shown("", XTERM, Reply::Silence);
    assert!(outcome.status.success(), "{}", outcome.errors);
    assert!(outcome.drawn.contains('▀'), "{:?}", outcome.drawn);
}

#[test]
fn signals_end_the_wait_and_the_program() {
    for signal in [Signal::INT, Signal::TERM, Signal::HUP, Signal::QUIT] {
        let outcome = shown("", XTERM, Reply::Signal(signal));
        assert_eq!(outcome.status.signal(), Some(signal.as_raw()));
        assert!(outcome.drawn.ends_with("\x1b[c"), "nothing is drawn: {:?}", outcome.drawn);
    }
}
