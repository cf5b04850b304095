//! The same cases in POV-Ray: scenes in its language, its pictures, and how far they are from what they should be.

use std::fmt::Write;
use std::fs;
use std::io;
use std::path::Path;
use std::process::{Command, Stdio};

use glam::DVec3;
use render::Options;
use scene::{AttributesId, Index, LightKind, Map, Node, Primitive, Scene, Solid};

use crate::stability::case::{Case, Peer, Written};
use crate::stability::place::options;
use crate::stability::stud;
use crate::support::shown;

/// Steps of 255 by which a pixel is a different one where two programs are compared.
const STEPS: u8 = 8;

/// A picture of display values.
struct Picture {
    columns: usize,
    pixels: Vec<[u8; 3]>,
}

/// What POV-Ray makes of a case, as the page has it.
///
/// # Errors
///
/// When POV-Ray cannot be run, or gives no picture.
pub(crate) fn measured(case: &Case) -> io::Result<Option<String>> {
    let Some(peer) = &case.peer else { return Ok(None) };
    let (wrong, of) = match peer {
        Peer::Itself(written) => {
            let base = picture(&Written::new(written.file, &[]).scene(), &options())?;
            let other = picture(&written.scene(), &options())?;
            let apart = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|k| a[k].abs_diff(b[k]) > 1);
            let wrong = base.pixels.iter().zip(&other.pixels).filter(apart).count();
            (wrong, base.pixels.len())
        }
        Peer::Ours(written) => {
            let scene = written.scene();
            let ours = shown(&scene, &options());
            let ours = Picture { columns: ours.columns, pixels: ours.pixels };
            let theirs = picture(&scene, &options())?;
            (strangers(&theirs, &ours), theirs.pixels.len())
        }
        Peer::Own(written, safe) => {
            let (theirs, safe) =
                (picture(&written.scene(), &options())?, picture(&safe.scene(), &options())?);
            (strangers(&theirs, &safe), theirs.pixels.len())
        }
        Peer::Chain(operators) => match chain(*operators)? {
            Some(counts) => counts,
            None => return Ok(Some("crashes".to_owned())),
        },
    };
    Ok(Some(format!("{wrong} of {of}")))
}

/// Pixels of a block that change when balls are taken from it and put back; nothing where there is no picture.
fn chain(operators: u32) -> io::Result<Option<(usize, usize)>> {
    let source = "object is light gray block rotate (0, 30, 20)\ncamera at (1, 3, 6)\nlight beam toward (-1, -2, -3)";
    let compiled = compile::compile_text(source);
    let scene = compiled.scene.ok_or_else(|| io::Error::other("the block compiles"))?;
    let options = Options { columns: 5, rows: 5, ..options() };
    let base = text(&scene, &options);
    let (before, block) = base.split_at(base.find("box { -1,1").expect("there is a block"));
    let look = block.trim_start_matches("box { -1,1").trim_end();
    let count = operators / 2;
    let mut chain = before.to_owned() + &"merge { difference { ".repeat(count as usize) + block;
    for k in 0..count {
        let ball = format!("sphere {{ {},0.01 {look}", vector(stud(k, count)));
        let _ = writeln!(chain, "{ball} }} {ball} }}");
    }
    let alone = drawn(&base, &options)?;
    let Ok(all) = drawn(&chain, &options) else { return Ok(None) };
    let apart = |(a, b): &(&[u8; 3], &[u8; 3])| (0..3).any(|k| a[k].abs_diff(b[k]) > 1);
    let wrong = alone.pixels.iter().zip(&all.pixels).filter(apart).count();
    Ok(Some((wrong, alone.pixels.len())))
}

/// Pixels of `a` that are like none of `b` in their place or beside it.
fn strangers(a: &Picture, b: &Picture) -> usize {
    let rows = a.pixels.len() / a.columns;
    let beside = |at: usize, of: usize| at.saturating_sub(1)..(at + 2).min(of);
    let strange = |&i: &usize| {
        let (column, row) = (i % a.columns, i / a.columns);
        !beside(row, rows).any(|y| {
            beside(column, a.columns).any(|x| {
                let other = b.pixels[y * b.columns + x];
                (0..3).all(|k| a.pixels[i][k].abs_diff(other[k]) <= STEPS)
            })
        })
    };
    (0..a.pixels.len()).filter(strange).count()
}

fn picture(scene: &Scene, options: &Options) -> io::Result<Picture> {
    drawn(&text(scene, options), options)
}

fn drawn(text: &str, options: &Options) -> io::Result<Picture> {
    let folder = tempfile::tempdir()?;
    let (input, output) = (folder.path().join("scene.pov"), folder.path().join("picture.ppm"));
    fs::write(&input, text)?;
    let words = ["-D", "-A", "+FP", "File_Gamma=srgb", "+WT1"];
    let status = Command::new("povray")
        .args(words)
        .args([format!("+W{}", options.columns), format!("+H{}", options.rows)])
        .arg(format!("+I{}", input.display()))
        .arg(format!("+O{}", output.display()))
        .stdout(Stdio::null())
        .stderr(Stdio::null())
        .status()?;
    if status.success() { read(&output) } else { Err(io::Error::other("povray failed")) }
}

/// A PPM of 8 bits, as POV-Ray writes it.
fn read(path: &Path) -> io::Result<Picture> {
    let bytes = fs::read(path)?;
    let strange = || io::Error::other("no picture as expected");
    let mut at = 0;
    let mut words = Vec::new();
    while words.len() < 4 {
        let line = bytes[at..].iter().position(|&byte| byte == b'\n').ok_or_else(strange)?;
        let text = String::from_utf8_lossy(&bytes[at..at + line]).into_owned();
        if !text.starts_with('#') {
            words.extend(text.split_whitespace().map(str::to_owned));
        }
        at += line + 1;
    }
    let columns = words[1].parse().map_err(|_| strange())?;
    let pixels = bytes[at..].chunks_exact(3).map(|rgb| [rgb[0], rgb[1], rgb[2]]).collect();
    if words[3] == "255" { Ok(Picture { columns, pixels }) } else { Err(strange()) }
}

fn vector(v: DVec3) -> String {
    format!("<{:e},{:e},{:e}>", v.x, v.y, v.z)
}

/// The scene in POV-Ray's language.
fn text(scene: &Scene, options: &Options) -> String {
    let camera = scene.camera.expect("a camera");
    let view = camera.view(options.columns, options.rows);
    let mut text = String::from("#version 3.7;\n");
    let _ = writeln!(
        text,
        "global_settings {{ assumed_gamma 1 max_trace_level 16 ambient_light rgb {} }}\n\
         background {{ rgb {} }}\n\
         camera {{ location {} right {} up {} direction {} }}",
        vector(scene.ambient),
        vector(scene.background),
        vector(camera.position),
        vector(view.right * (2.0 * view.half[0])),
        vector(view.up * (2.0 * view.half[1])),
        vector(view.forward)
    );
    for light in &scene.lights {
        let color = vector(light.color);
        let _ = match light.kind {
            LightKind::Point { at } | LightKind::Spot { at, .. } => {
                writeln!(text, "light_source {{ {} rgb {color} }}", vector(at))
            }
            LightKind::Beam { at, toward } => {
                let (at, toward) = (vector(at), vector(toward));
                writeln!(text, "light_source {{ {at} rgb {color} parallel point_at {toward} }}")
            }
        };
    }
    for object in &scene.objects {
        text += &solid(scene, &object.solid, &Map::IDENTITY, &[]);
        text.push('\n');
    }
    text
}

/// A solid under a map, with the attributes around it from the inside out.
fn solid(scene: &Scene, solid_: &Solid, outer: &Map, around: &[AttributesId]) -> String {
    let maps = solid_.maps();
    let mut stack: Vec<String> = Vec::new();
    for node in &solid_.nodes {
        let part = match *node {
            Node::Primitive { frame, .. }
            | Node::Form { frame, .. }
            | Node::Instance { frame, .. } => {
                let map = outer.then_inner(&maps[frame.0 as usize]);
                let mut levels = Vec::new();
                let mut at = Some(frame);
                while let Some(id) = at {
                    let frame = &solid_.frames[id.0 as usize];
                    levels.push(frame.attributes);
                    at = frame.parent;
                }
                levels.extend_from_slice(around);
                match *node {
                    Node::Instance { class, .. } => {
                        solid(scene, &scene.classes[class.0 as usize].solid, &map, &levels)
                    }
                    Node::Form { form, .. } => {
                        let form = solid_.form(form);
                        assert_eq!(form.row().keyword, "torus", "the only form of these scenes");
                        let ring = format!("torus {{ 1,{:e} rotate z*90", form.arguments()[0]);
                        placed(scene, &ring, &map, &levels)
                    }
                    Node::Primitive { kind, .. } => placed(scene, body(kind), &map, &levels),
                    _ => unreachable!("leaves"),
                }
            }
            Node::Complement => {
                let part = stack.pop().expect("an operand");
                format!("{} inverse }}", part.trim_end_matches('}'))
            }
            Node::Union(n) | Node::Intersection(n) => {
                let parts = stack.split_off(stack.len() - n as usize).join(" ");
                let word = if matches!(node, Node::Union(_)) { "merge" } else { "intersection" };
                format!("{word} {{ {parts} }}")
            }
        };
        stack.push(part);
    }
    stack.pop().expect("one operand is left")
}

/// A solid in its own space, still open.
fn body(kind: Primitive) -> &'static str {
    match kind {
        Primitive::Sphere => "sphere { 0,1",
        Primitive::Block => "box { -1,1",
        Primitive::Cylinder => "cylinder { 0,x,1",
        Primitive::Cone => "cone { 0,0,x,1",
        Primitive::Paraboloid => {
            "intersection { quadric { <0,1,1>,0,<-1,0,0>,0 } plane { x,1 } bounded_by { box { <0,-1,-1>,1 } }"
        }
    }
}

fn placed(scene: &Scene, body: &str, map: &Map, levels: &[AttributesId]) -> String {
    let sets = || levels.iter().map(|id| &scene.attributes[id.0 as usize]);
    let color = sets().find_map(|set| set.color).unwrap_or(DVec3::ONE);
    let look = match sets().find_map(|set| set.transparency) {
        None => format!("pigment {{ rgb {} }} finish {{ ambient 1 diffuse 1 }}", vector(color)),
        Some(clear) => {
            let index = match clear.index {
                Index::Refractive(index) => index,
                Index::Fake => 1.0,
            };
            format!(
                "pigment {{ rgb {} filter 1 }} finish {{ ambient 0 diffuse 0 reflection {{ 0,1 fresnel }} conserve_energy }} \
                 interior {{ ior {index} fade_distance {:e} fade_power 1001 fade_color rgb {} }}",
                vector(color),
                clear.half_distance,
                vector(color)
            )
        }
    };
    let m = map.linear;
    let rows = [m.x_axis, m.y_axis, m.z_axis, map.place];
    let numbers = rows.map(|row| format!("{:e},{:e},{:e}", row.x, row.y, row.z)).join(",");
    format!("{body} matrix <{numbers}> {look} }}")
}
