//! Scenes and files that are made to cost much, and disks that have no room.

use std::io;

use scene::{Frame, FrameId, Node, Placement, Primitive, Scene, Solid, format};

use super::{at, cups, frame, leaf, written};

#[test]
fn depth_and_width_cost_no_stack() {
    let n = 50_000;
    let mut chain =
        Solid { frames: vec![frame(at(1.0, 0.0, 0.0))], nodes: Vec::new(), ..Solid::default() };
    for i in 1..n {
        chain.frames.push(Frame { parent: Some(FrameId(i - 1)), ..frame(at(0.0, 0.5, 0.0)) });
    }
    // Every operand first, then every operator: the deepest tree to the right.
    chain.nodes.extend((0..n).map(|i| leaf(Primitive::Block, i)));
    chain.nodes.extend((1..n).map(|_| Node::Union(2)));
    let mut wide =
        Solid { frames: vec![frame(Placement::default())], nodes: Vec::new(), ..Solid::default() };
    wide.nodes.extend((0..n).map(|_| leaf(Primitive::Sphere, 0)));
    wide.nodes.push(Node::Union(n));
    let mut scene = Scene { camera: cups().camera, ..Scene::default() };
    scene.add_object(None, chain);
    scene.add_object(None, wide);
    let text = written(&scene);
    assert_eq!(format::read(&text), Ok(scene), "round trip");
}

#[test]
fn counts_that_lie_take_no_memory() {
    let head = "portray scene 2\nobject\n  frame 0\n  sphere frame 0\n";
    for line in [
        "union 4294967295",
        "intersection 4294967295",
        "union 1",
        "sphere in 4294967295",
        "sphere frame 1",
    ] {
        let text = format!("{head}  {line}\n");
        let error = format::read(text.as_bytes()).expect_err(line);
        assert_eq!(error.line, 5, "{error}");
    }
}

#[test]
fn a_full_disk_is_an_error() {
    let mut small = [0; 64];
    let error = format::write(&cups(), &mut &mut small[..]).unwrap_err();
    assert_eq!(error.kind(), io::ErrorKind::WriteZero, "{error}");
}
