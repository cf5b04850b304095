//! `docs/gallery.html`: pictures, the text behind each in the colours of its words, and how long it takes.
//!
//! The page is made here of the scenes and of their table; `UPDATE_REFERENCE=1` writes it.

#![expect(clippy::unwrap_used, reason = "the lint does not know helpers of tests as tests")]

use std::fmt::Write;
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};

use compile::SourceMap;
use compile::vocabulary::{Kind, Piece, entries, pieces};
use idf::exchange::read_image;
use idf::{Image, ReadOptions, Samples};

use crate::support::root;

/// A picture of the page: its file and the description behind it, below `scenes`, and what it is.
struct Entry {
    picture: &'static str,
    scene: &'static str,
    title: &'static str,
    about: &'static str,
}

/// Pictures in the order of the page.
#[rustfmt::skip]
const ENTRIES: &[Entry] = &[
    Entry { picture: "station/station.png", scene: "station/station.sdl", title: "A space station",
        about: "Nine texture functions and seven texture files in one scene; the stars are another picture, composited \
                through the windows." },
    Entry { picture: "solids/solids.png", scene: "solids/solids.sdl", title: "A machine part",
        about: "All solids and operators, in classes that are made of classes. What is cut off leaves red walls." },
    Entry { picture: "wine-glass/wine-glass.png", scene: "wine-glass/wine-glass.sdl", title: "The wine glass",
        about: "The listing of the paper, unchanged: glass and wine touch, and nothing says which displaces which." },
    Entry { picture: "spindles/spindles.png", scene: "spindles/spindles.sdl", title: "Spindles",
        about: "Wood and marble whose grain runs through the whole." },
    Entry { picture: "fog/fog.png", scene: "fog/fog.sdl", title: "The machine part in fog",
        about: "The same file, included, and one statement more." },
    Entry { picture: "cylinders/cylinders.png", scene: "cylinders/cylinders.sdl", title: "Cylinders",
        about: "Painted with bricks, smooth, and ribbed by subtraction." },
    Entry { picture: "gallery/aquarium.png", scene: "gallery/aquarium.sdl", title: "An aquarium",
        about: "Glass, water, a stone, a bubble and a glass of wine: their walls touch, and each has the space it should." },
    Entry { picture: "gallery/gears.png", scene: "gallery/gears.sdl", title: "Gears",
        about: "Four wheels from one class with parameters, turned by expressions so that they mesh." },
    Entry { picture: "gallery/lenses.png", scene: "gallery/lenses.sdl", title: "Lenses",
        about: "A lens is what two balls share; light is bent by it as by glass of index 1.52." },
    Entry { picture: "gallery/section.png", scene: "gallery/section.sdl", title: "A section",
        about: "A building, intersected with a block. What is cut through is red." },
    Entry { picture: "gallery/cheese.png", scene: "gallery/cheese.sdl", title: "Swiss cheese",
        about: "One block without 10 000 balls." },
    Entry { picture: "gallery/flake.png", scene: "gallery/flake.sdl", title: "A flake",
        about: "Sixteen classes that stand for 2·10¹⁵ spheres, in under 20 MB." },
    Entry { picture: "gallery/pendulums.gif", scene: "gallery/pendulums.sdl", title: "Pendulums",
        about: "48 pictures from one file, with one table of colours for all of them." },
    Entry { picture: "gallery/planet.png", scene: "gallery/planet.sdl", title: "A glass on a planet",
        about: "The ground is a sphere of radius 6.4·10⁶, under eyes 1.7 high." },
    Entry { picture: "gallery/trillion.png", scene: "gallery/trillion.sdl", title: "A trillion spheres",
        about: "10¹² of them in twelve classes." },
    Entry { picture: "gallery/rings.png", scene: "gallery/rings.sdl", title: "Rings",
        about: "Solids beyond the paper: torus, paraboloid, prism and terrain, cut and of glass." },
];

const STYLE: &str = "\
:root { color-scheme: light dark; --paper: #fbfaf7; --ink: #23262b; --soft: #62676f; --line: #dcd9d1; --panel: #f2f0ea;
  --statement: #7a2f8f; --clause: #8a4b12; --look: #0b6b58; --solid: #0f5aa8; --number: #a1321f; --text: #4d6a10; }
@media (prefers-color-scheme: dark) {
  :root { --paper: #14171c; --ink: #d8dbe0; --soft: #969ca6; --line: #2c323b; --panel: #1b1f26;
    --statement: #d8a3ea; --clause: #e3b07a; --look: #74d3bb; --solid: #86bdf5; --number: #f09a86; --text: #b9d67c; }
}
body { margin: 0 auto; max-width: 60rem; padding: 1.5rem 1rem 4rem; background: var(--paper); color: var(--ink);
  font: 1rem/1.55 system-ui, sans-serif; }
h1 { font-size: 1.9rem; margin: 0 0 .3rem; } h2 { font-size: 1.3rem; margin: 0 0 .2rem; }
p { margin: .3rem 0 .6rem; } a { color: var(--solid); }
section { margin-top: 3rem; border-top: 1px solid var(--line); padding-top: 1.4rem; }
img { display: block; max-width: 100%; height: auto; border-radius: 6px; margin: .7rem 0; }
.cost { color: var(--soft); font-size: .9rem; } summary { cursor: pointer; color: var(--soft); }
pre { overflow-x: auto; background: var(--panel); border: 1px solid var(--line); border-radius: 6px; padding: .8rem;
  font: .8rem/1.45 ui-monospace, monospace; max-height: 32rem; }
.s { color: var(--statement); font-weight: 600; } .c { color: var(--clause); } .l { color: var(--look); }
.o { color: var(--solid); } .n { color: var(--number); } .t { color: var(--text); }
.m { color: var(--soft); font-style: italic; }
";

/// A text with what HTML means by its signs written out.
fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// The class of a piece in the page.
fn class(piece: Piece, word: &str) -> Option<&'static str> {
    let kind = match piece {
        Piece::Word(kind) => kind,
        // A word that means something in its place only.
        Piece::Name => {
            entries().into_iter().find(|entry| entry.word == word.to_ascii_lowercase())?.kind
        }
        Piece::Number => return Some("n"),
        Piece::Text => return Some("t"),
        Piece::Sign | Piece::Bad => return None,
    };
    Some(match kind {
        Kind::Statement => "s",
        Kind::Clause | Kind::Transform => "c",
        Kind::Attribute | Kind::Color | Kind::Texture | Kind::Mapping => "l",
        Kind::Solid => "o",
        Kind::Function | Kind::Number => "n",
    })
}

/// A description with its words in their colours; what stands between pieces and is no space is a comment.
fn colored(text: &str) -> String {
    let sources = SourceMap::from_reader(Path::new("scene.sdl"), text.as_bytes()).unwrap();
    let (mut html, mut end) = (String::new(), 0);
    let comment = |between: &str| match between.trim() {
        "" => between.to_owned(),
        _ => format!("<span class=\"m\">{}</span>", escaped(between)),
    };
    for (span, piece) in pieces(&sources) {
        let [start, stop] = [span.start, span.end].map(|at| at as usize);
        html.push_str(&comment(&text[end..start]));
        let word = &text[start..stop];
        match class(piece, word) {
            Some(class) => {
                write!(html, "<span class=\"{class}\">{}</span>", escaped(word)).unwrap();
            }
            None => html.push_str(&escaped(word)),
        }
        end = stop;
    }
    html + &comment(&text[end..])
}

/// Rays and seconds of a scene from the table of `scenes/README.md`.
fn cost(list: &str, scene: &str) -> [String; 2] {
    let row = list.lines().find(|line| line.starts_with(&format!("| `{scene}`")));
    let cells: Vec<&str> = row.unwrap_or_else(|| panic!("{scene} has a row")).split('|').collect();
    [cells[3], cells[4]].map(|cell| cell.trim().to_owned())
}

fn page() -> String {
    let scenes = root().join("scenes");
    let list = fs::read_to_string(scenes.join("README.md")).unwrap();
    let mut html = format!(
        "<!doctype html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n\
         <meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n\
         <title>PORTRAY: a gallery</title>\n<style>\n{STYLE}</style>\n</head>\n<body>\n\
         <h1>Gallery</h1>\n<p>Each picture is one text. Rays and seconds are those of one core for 512 × 512 pixels with one \
         sample each; the pictures have more. <a href=\"sdl.md\">The language</a> · \
         <a href=\"textures.md\">Textures</a> · <a href=\"toolkit.md\">The image toolkit</a></p>\n"
    );
    for Entry { picture, scene, title, about } in ENTRIES {
        let text = fs::read_to_string(scenes.join(scene)).unwrap();
        let [columns, rows] = size(&scenes.join(picture));
        let [rays, seconds] = cost(&list, scene);
        let lines = text.lines().count();
        write!(
            html,
            "<section>\n<h2>{title}</h2>\n<p>{about}</p>\n\
             <img src=\"../scenes/{picture}\" alt=\"{title}\" width=\"{columns}\" height=\"{rows}\">\n\
             <p class=\"cost\">{rays} rays, {seconds} s · <a href=\"../scenes/{scene}\">{scene}</a></p>\n\
             <details><summary>{lines} lines</summary>\n<pre><code>{}</code></pre>\n</details>\n</section>\n",
            colored(&text)
        )
        .unwrap();
    }
    html + "</body>\n</html>\n"
}

/// Columns and rows of a PNG or a GIF.
fn size(path: &Path) -> [u32; 2] {
    let bytes = fs::read(path).unwrap();
    if bytes.starts_with(b"GIF") {
        return [6, 8].map(|at| u32::from(u16::from_le_bytes([bytes[at], bytes[at + 1]])));
    }
    [16, 20].map(|at| u32::from_be_bytes(bytes[at..at + 4].try_into().unwrap()))
}

fn path() -> PathBuf {
    root().join("docs/gallery.html")
}

#[test]
fn the_page_is_that_of_the_scenes() {
    let made = page();
    if std::env::var_os("UPDATE_REFERENCE").is_some() {
        fs::write(path(), &made).unwrap();
    }
    let found = fs::read_to_string(path()).unwrap();
    assert!(
        found == made,
        "docs/gallery.html is not what the scenes make: set UPDATE_REFERENCE to write it"
    );
}

#[test]
fn the_page_links_what_is_there() {
    let text = fs::read_to_string(path()).unwrap();
    let mut links = 0;
    for start in ["src=\"", "href=\""] {
        for (at, _) in text.match_indices(start) {
            let name = text[at + start.len()..].split('"').next().unwrap();
            assert!(!name.contains(':') && !name.starts_with("//"), "{name} is no local file");
            assert!(root().join("docs").join(name).is_file(), "{name} is there");
            links += 1;
        }
    }
    assert_eq!(links, 3 + 2 * ENTRIES.len());
    for outside in ["<script", "@import", "url(", "<link"] {
        assert!(!text.contains(outside), "{outside}");
    }
}

#[test]
fn words_have_their_colours() {
    let html = colored(
        "object is /* a < b */ shiny red Torus (0.2) at (1, 2, 3) // \"end\"\nlet a = sin(3)\n",
    );
    let expected = "<span class=\"s\">object</span> <span class=\"c\">is</span>\
        <span class=\"m\"> /* a &lt; b */ </span><span class=\"l\">shiny</span> <span class=\"l\">red</span> \
        <span class=\"o\">Torus</span> (<span class=\"n\">0.2</span>) <span class=\"c\">at</span> \
        (<span class=\"n\">1</span>, <span class=\"n\">2</span>, <span class=\"n\">3</span>)\
        <span class=\"m\"> // &quot;end&quot;\n</span><span class=\"s\">let</span> a = \
        <span class=\"n\">sin</span>(<span class=\"n\">3</span>)\n";
    assert_eq!(html, expected);
}

/// A browser without a window, if one is installed.
fn browser() -> Option<&'static str> {
    let is_there = |name: &&str| {
        Command::new(name).arg("--version").output().is_ok_and(|output| output.status.success())
    };
    ["chromium", "chromium-browser", "google-chrome"].into_iter().find(is_there)
}

fn looked_at(browser: &str, folder: &Path, width: u32, words: &[&str]) -> Output {
    let profile = format!("--user-data-dir={}", folder.join("profile").display());
    let output = Command::new("timeout")
        .args(["120", browser, "--headless", "--no-sandbox", "--disable-gpu", "--hide-scrollbars"])
        .args([
            "--disable-dev-shm-usage",
            "--enable-logging=stderr",
            "--force-device-scale-factor=1",
        ])
        .args([profile, format!("--window-size={width},1000")])
        .args(words)
        .current_dir(folder)
        .output()
        .unwrap();
    assert!(output.status.success(), "{output:?}");
    let said = String::from_utf8_lossy(&output.stderr);
    assert!(!said.contains(":CONSOLE"), "the browser complains: {said}");
    output
}

/// How many colours a picture has.
fn distinct(image: &Image) -> usize {
    let planes: Vec<&[u8]> = image
        .planes()
        .iter()
        .map(|plane| match &plane.samples {
            Samples::U8(samples) => samples.as_slice(),
            other => panic!("{other:?}"),
        })
        .collect();
    let mut colors: Vec<Vec<u8>> =
        (0..planes[0].len()).map(|at| planes.iter().map(|plane| plane[at]).collect()).collect();
    colors.sort_unstable();
    colors.dedup();
    colors.len()
}

#[test]
fn a_browser_shows_the_page() {
    let Some(browser) = browser() else {
        return idf::command::print(
            "skipped: no chromium is installed to look at docs/gallery.html\n",
        );
    };
    let folder = tempfile::tempdir().unwrap();
    let text = fs::read_to_string(path()).unwrap();
    // A copy that says how wide it came out, and how many pictures are missing.
    let base = format!("<head>\n<base href=\"file://{}/docs/\">", root().display());
    let probe = "<script>addEventListener('load', () => { const d = document; \
        for (const x of d.querySelectorAll('details')) x.open = true; \
        d.title = [innerWidth, d.documentElement.scrollWidth, \
        [...d.images].filter(x => x.naturalWidth === 0).length, d.images.length].join(' '); })</script></body>";
    let copy = folder.path().join("page.html");
    fs::write(&copy, text.replacen("<head>", &base, 1).replacen("</body>", probe, 1)).unwrap();
    let address = format!("file://{}", copy.display());
    for width in [400, 1280] {
        let shot = "--screenshot=shot.png";
        looked_at(browser, folder.path(), width, &[shot, &address]);
        let image = read_image(&folder.path().join("shot.png"), &ReadOptions::default()).unwrap();
        assert!(distinct(&image) > 200, "the page at {width} shows {} colours", distinct(&image));
        let output = looked_at(browser, folder.path(), width, &["--dump-dom", &address]);
        let html = String::from_utf8_lossy(&output.stdout).into_owned();
        let title = html.split("<title>").nth(1).unwrap().split('<').next().unwrap();
        let figures: Vec<usize> = title.split(' ').map(|word| word.parse().unwrap()).collect();
        let [inner, scrolled, missing, images] = figures[..] else { panic!("{title}") };
        assert!(
            inner.abs_diff(width as usize) <= 100,
            "the window is {inner} wide, {width} was asked for"
        );
        assert!(scrolled <= inner, "the page is {scrolled} wide in a window of {inner}");
        assert_eq!((missing, images), (0, ENTRIES.len()), "pictures");
    }
}
