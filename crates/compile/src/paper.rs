//! The expanded form of a scene, as the first scene compiler wrote it: primitives only, in scene space, under binary
//! operators. `docs/compiled-scene.md` is its grammar.

use std::fmt;
use std::io::{self, BufWriter, Write};

use glam::{DMat3, DVec3};
use scene::optics::Optics;
use scene::transform::apply;
use scene::{
    Attributes, Bounds, Frame, FrameId, Index, Map, Node, Object, Paint, Primitive, Scene, Solid,
    bound, format,
};

/// How many primitives a scene may stand for unless told otherwise.
pub const LIMIT: u64 = 10_000_000;

/// Why a scene was not printed.
#[derive(Debug)]
#[non_exhaustive]
pub enum PaperError {
    /// The classes stand for too many primitives; nothing was printed.
    TooMany {
        /// How many, or `u64::MAX` for that many and more.
        primitives: u64,
        /// How many are allowed.
        limit: u64,
    },
    /// A matrix or a box has left the range of numbers.
    NotFinite {
        /// Which object holds it, counted from 0.
        object: usize,
    },
    /// The output failed.
    Write(io::Error),
}

impl fmt::Display for PaperError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::TooMany { primitives, limit } => {
                let more = if *primitives == u64::MAX { "at least " } else { "" };
                write!(f, "expanding gives {more}{primitives} primitives, more than {limit}")
            }
            Self::NotFinite { object } => {
                write!(f, "object {object} has a matrix that is not finite once it is expanded")
            }
            Self::Write(_) => write!(f, "cannot write the expanded scene"),
        }
    }
}

impl std::error::Error for PaperError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Write(error) => Some(error),
            Self::TooMany { .. } | Self::NotFinite { .. } => None,
        }
    }
}

impl From<io::Error> for PaperError {
    fn from(error: io::Error) -> Self {
        Self::Write(error)
    }
}

/// Prints the expanded form of a well-formed scene of at most `limit` primitives; memory grows with the scene, not
/// with what it stands for.
///
/// # Errors
///
/// More primitives than `limit`, before anything is printed; a matrix that overflows; what `out` says.
///
/// # Panics
///
/// When a solid is not well formed; the compiler and the reader of compiled scenes make no such solid.
pub fn print(scene: &Scene, limit: u64, out: &mut impl Write) -> Result<(), PaperError> {
    let primitives = count(scene);
    if primitives > limit {
        return Err(PaperError::TooMany { primitives, limit });
    }
    let mut out = BufWriter::new(out);
    writeln!(out, "portray expanded {}", format::VERSION)?;
    format::write_surroundings(scene, &mut out)?;
    let classes: Vec<Definition<'_>> =
        scene.classes.iter().map(|class| Definition::new(&class.solid, scene)).collect();
    for (number, Object { name, solid }) in scene.objects.iter().enumerate() {
        match name {
            Some(name) => writeln!(out, "object {name}")?,
            None => writeln!(out, "object")?,
        }
        let solid = Definition::new(solid, scene);
        expand(&solid, &classes, &mut Operands { boxes: Vec::new(), number, out: &mut out })?;
    }
    writeln!(out, "end")?;
    Ok(out.flush()?)
}

/// How many primitives the objects stand for.
fn count(scene: &Scene) -> u64 {
    let mut classes: Vec<u64> = Vec::with_capacity(scene.classes.len());
    let of = |solid: &Solid, classes: &[u64]| {
        solid.nodes.iter().fold(0, |sum: u64, node| match *node {
            Node::Primitive { .. } => sum.saturating_add(1),
            Node::Instance { class, .. } => sum.saturating_add(classes[class.0 as usize]),
            Node::Union(_) | Node::Intersection(_) | Node::Complement => sum,
        })
    };
    for class in &scene.classes {
        classes.push(of(&class.solid, &classes));
    }
    scene.objects.iter().fold(0, |sum, object| sum.saturating_add(of(&object.solid, &classes)))
}

/// A binary operator.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Operator {
    Union,
    Intersection,
    Subtraction,
}

/// A solid with all that is the same in each of its instances.
struct Definition<'a> {
    solid: &'a Solid,
    maps: Vec<Map>,
    /// Of each frame, with what the frames about it say.
    attributes: Vec<Attributes>,
    /// Of each frame, the nearest that is painted, itself or about it, and its coats.
    paint: Vec<Option<(FrameId, &'a [Paint])>>,
    /// The binary operators that follow each node.
    after: Vec<(Operator, u32)>,
}

impl<'a> Definition<'a> {
    fn new(solid: &'a Solid, scene: &'a Scene) -> Self {
        let mut attributes: Vec<Attributes> = Vec::with_capacity(solid.frames.len());
        let mut paint = Vec::with_capacity(solid.frames.len());
        for (id, Frame { parent, attributes: own, .. }) in (0..).map(FrameId).zip(&solid.frames) {
            let parent = parent.map(|parent| parent.0 as usize);
            let own = &scene.attributes[own.0 as usize];
            let outer = parent.map(|parent| &attributes[parent]);
            attributes.push(own.within(outer.unwrap_or(&Attributes::default())));
            let coats = (!own.paint.is_empty()).then_some((id, own.paint.as_slice()));
            paint.push(coats.or_else(|| parent.and_then(|parent| paint[parent])));
        }
        Self { solid, maps: solid.maps(), attributes, paint, after: binary(&solid.nodes) }
    }
}

/// The binary operators that follow each node when unions and intersections become balanced trees.
fn binary(nodes: &[Node]) -> Vec<(Operator, u32)> {
    let mut after = vec![(Operator::Union, 0); nodes.len()];
    // The last node of each operand.
    let mut operands: Vec<usize> = Vec::new();
    for (i, node) in nodes.iter().enumerate() {
        match *node {
            Node::Primitive { .. } | Node::Instance { .. } => operands.push(i),
            Node::Complement => *operands.last_mut().expect("an operand") = i,
            Node::Union(n) => {
                let start = operands.len() - n as usize;
                balance(&operands[start..], Operator::Union, &mut after);
                operands.truncate(start);
                operands.push(i);
            }
            Node::Intersection(n) => {
                let start = operands.len() - n as usize;
                let mut run = start;
                for at in start..operands.len() {
                    if nodes[operands[at]] == Node::Complement {
                        // What precedes is one operand; it begins the next run, in the place of the complement.
                        balance(&operands[run..at], Operator::Intersection, &mut after);
                        after[operands[at]] = (Operator::Subtraction, 1);
                        run = at;
                    }
                }
                balance(&operands[run..], Operator::Intersection, &mut after);
                operands.truncate(start);
                operands.push(i);
            }
        }
    }
    after
}

/// Joins operands as a balanced tree: one more operator after the last operand of each part of two or more.
fn balance(operands: &[usize], operator: Operator, after: &mut [(Operator, u32)]) {
    let mut parts = vec![operands];
    while let Some(part) = parts.pop() {
        if let [_, .., last] = part {
            let count = after[*last].1;
            after[*last] = (operator, count + 1);
            let (first, second) = part.split_at(part.len().div_ceil(2));
            parts.extend([first, second]);
        }
    }
}

/// A solid that is being printed.
struct Level<'a> {
    definition: &'a Definition<'a>,
    /// The next node.
    next: usize,
    /// Where the solid stands in the scene.
    map: Map,
    /// What is said of it there.
    attributes: Attributes,
    /// Coats for what has none of its own, and where their space stands in the scene.
    paint: Option<(&'a [Paint], Map)>,
}

/// Prints one object; instances are levels of a stack.
fn expand<'a, W: Write>(
    object: &'a Definition<'a>,
    classes: &'a [Definition<'a>],
    operands: &mut Operands<'_, W>,
) -> Result<(), PaperError> {
    let attributes = Attributes::default();
    let map = Map::IDENTITY;
    let mut levels = vec![Level { definition: object, next: 0, map, attributes, paint: None }];
    while let Some(level) = levels.last_mut() {
        let Level { definition, next, map, attributes, paint } = level;
        let definition: &'a Definition<'a> = definition;
        let Some(node) = definition.solid.nodes.get(*next) else {
            levels.pop();
            if let Some(Level { definition, next, .. }) = levels.last() {
                operands.join(definition.after[*next - 1])?;
            }
            continue;
        };
        *next += 1;
        let (Node::Primitive { frame, .. } | Node::Instance { frame, .. }) = *node else {
            operands.join(definition.after[*next - 1])?;
            continue;
        };
        let place = frame.0 as usize;
        let paint = match definition.paint[place] {
            Some((id, coats)) => Some((coats, map.then_inner(&definition.maps[id.0 as usize]))),
            None => *paint,
        };
        let map = map.then_inner(&definition.maps[place]);
        let attributes = definition.attributes[place].within(attributes);
        match *node {
            Node::Instance { class, .. } => {
                let definition = &classes[class.0 as usize];
                levels.push(Level { definition, next: 0, map, attributes, paint });
            }
            Node::Primitive { kind, .. } => {
                operands.primitive(kind, &map, &attributes.resolved(), paint)?;
                operands.join(definition.after[*next - 1])?;
            }
            Node::Union(_) | Node::Intersection(_) | Node::Complement => {}
        }
    }
    Ok(())
}

/// The printed operands of one object that are not yet joined.
struct Operands<'a, W: Write> {
    boxes: Vec<Bounds>,
    /// Which object it is.
    number: usize,
    out: &'a mut BufWriter<W>,
}

impl<W: Write> Operands<'_, W> {
    fn primitive(
        &mut self,
        kind: Primitive,
        map: &Map,
        optics: &Optics,
        paint: Option<(&[Paint], Map)>,
    ) -> Result<(), PaperError> {
        writeln!(self.out, "  {}", kind.keywords()[0])?;
        self.numbers("    matrix", &local_from_scene(map))?;
        self.numbers("    inverse", &rows(&map.linear, map.place))?;
        self.optics(optics)?;
        if let Some((coats, space)) = paint {
            coats.iter().try_for_each(|coat| self.coat(coat))?;
            if space != *map {
                self.numbers("    grain", &local_from_scene(&space))?;
            }
        }
        self.boxes.push(bound::placed(kind, map));
        Ok(())
    }

    /// Prints as many binary operators, each with its box.
    fn join(&mut self, (operator, count): (Operator, u32)) -> Result<(), PaperError> {
        for _ in 0..count {
            let second = self.boxes.pop().expect("two operands");
            let first = self.boxes.pop().expect("two operands");
            let (word, joined) = match operator {
                Operator::Union => ("union", first.hull(second)),
                Operator::Intersection => ("intersection", first.overlap(second)),
                Operator::Subtraction => ("subtraction", first),
            };
            writeln!(self.out, "  {word}")?;
            if joined.is_empty() {
                writeln!(self.out, "    box none")?;
            } else {
                let Bounds { low, high } = joined;
                self.numbers("    box", &[low.x, low.y, low.z, high.x, high.y, high.z])?;
            }
            self.boxes.push(joined);
        }
        Ok(())
    }

    fn optics(&mut self, optics: &Optics) -> io::Result<()> {
        let Optics { color, shininess, smoothness, pure, transparency, priority } = optics;
        let [r, g, b] = color.to_array();
        let pure = if *pure { "pure" } else { "composite" };
        write!(self.out, "    optics color {r:?} {g:?} {b:?}")?;
        write!(self.out, " shininess {shininess:?} smoothness {smoothness:?} {pure}")?;
        if let Some(transparency) = transparency {
            write!(self.out, " trans {:?}", transparency.half_distance)?;
            match transparency.index {
                Index::Refractive(index) => write!(self.out, " {index:?}")?,
                Index::Fake => write!(self.out, " fake")?,
            }
        }
        writeln!(self.out, " priority {priority}")
    }

    fn coat(&mut self, coat: &Paint) -> io::Result<()> {
        let function = coat.texture.function();
        write!(self.out, "    paint {}", function.keyword)?;
        for (parameter, value) in function.parameters.iter().zip(coat.texture.arguments()) {
            write!(self.out, " {} {value:?}", parameter.name)?;
        }
        let [r, g, b] = coat.color.to_array();
        writeln!(self.out, " color {r:?} {g:?} {b:?}")
    }

    fn numbers(&mut self, word: &str, values: &[f64]) -> Result<(), PaperError> {
        self.out.write_all(word.as_bytes())?;
        for value in values {
            if !value.is_finite() {
                return Err(PaperError::NotFinite { object: self.number });
            }
            write!(self.out, " {value:?}")?;
        }
        Ok(self.out.write_all(b"\n")?)
    }
}

/// The inverse of a map by rows.
fn local_from_scene(map: &Map) -> [f64; 12] {
    // Taken from 0, as a negated 0 would be printed as −0.
    rows(&map.inverse, DVec3::ZERO - apply(&map.inverse, map.place))
}

/// A matrix by rows, with `place` as last column.
fn rows(m: &DMat3, place: DVec3) -> [f64; 12] {
    let [x, y, z] = [m.x_axis, m.y_axis, m.z_axis];
    std::array::from_fn(|i| [x, y, z, place][i % 4][i / 4])
}

#[cfg(test)]
mod tests {
    use scene::class::AttributesTable;
    use scene::texture::Texture;
    use scene::{AttributesId, ClassId, Placement, Transparency};

    use super::*;

    fn printed(scene: &Scene, limit: u64) -> String {
        let mut text = Vec::new();
        print(scene, limit, &mut text).unwrap();
        String::from_utf8(text).unwrap()
    }

    fn at(x: f64, y: f64, z: f64) -> Frame {
        let placement = Placement { place: DVec3::new(x, y, z), ..Placement::default() };
        Frame { parent: None, placement, attributes: AttributesId::NONE }
    }

    fn instance(class: u32, frame: u32) -> Node {
        Node::Instance { class: ClassId(class), frame: FrameId(frame) }
    }

    /// Spheres 10 apart along x, then `operators`, as a scene of one object.
    fn row(n: u32, operators: &[(usize, Node)]) -> Scene {
        let frames = (0..n).map(|i| at(10.0 * f64::from(i), 0.0, 0.0)).collect();
        let leaf = |i| Node::Primitive { kind: Primitive::Sphere, frame: FrameId(i) };
        let mut nodes: Vec<Node> = (0..n).map(leaf).collect();
        for (place, operator) in operators {
            nodes.insert(*place, *operator);
        }
        let mut scene = Scene::default();
        scene.add_object(None, Solid { frames, nodes });
        scene
    }

    /// The one object with brackets about its operators and spheres by number, and its depth.
    fn tree(scene: &Scene) -> (String, u32) {
        let mut stack: Vec<(String, u32)> = Vec::new();
        let text = printed(scene, LIMIT);
        for line in text.lines() {
            let operator = match line.trim_start() {
                "union" => "+",
                "intersection" => "*",
                "subtraction" => "-",
                _ => {
                    if let Some(row) = line.strip_prefix("    inverse 1.0 0.0 0.0 ") {
                        let x: f64 = row.split(' ').next().unwrap().parse().unwrap();
                        stack.push((format!("{}", x / 10.0), 0));
                    }
                    continue;
                }
            };
            let (second, b) = stack.pop().unwrap();
            let (first, a) = stack.pop().unwrap();
            stack.push((format!("({first}{operator}{second})"), 1 + a.max(b)));
        }
        assert_eq!(stack.len(), 1, "one tree: {text}");
        stack.remove(0)
    }

    #[test]
    fn the_example_of_the_documentation_holds() {
        let page = include_str!("../../../docs/compiled-scene.md");
        let block = |first: &str| {
            let begin = page.find(&format!("```text\n{first}")).unwrap() + "```text\n".len();
            &page[begin..begin + page[begin..].find("```").unwrap()]
        };
        let scene = format::read(block("portray scene 1\n").as_bytes()).unwrap();
        assert_eq!(printed(&scene, LIMIT), block("portray expanded 1\n"), "expanded");
    }

    #[test]
    fn seven_terms_are_three_deep() {
        let (text, depth) = tree(&row(7, &[(7, Node::Union(7))]));
        assert_eq!((text.as_str(), depth), ("(((0+1)+(2+3))+((4+5)+6))", 3), "union");
        let (text, depth) = tree(&row(7, &[(7, Node::Intersection(7))]));
        assert_eq!((text.as_str(), depth), ("(((0*1)*(2*3))*((4*5)*6))", 3), "intersection");
        for n in 2_u32..70 {
            let (_, depth) = tree(&row(n, &[(n as usize, Node::Union(n))]));
            assert_eq!(depth, n.next_power_of_two().ilog2(), "{n} terms");
        }
    }

    #[test]
    fn subtractions_go_from_left_to_right() {
        let complement = Node::Complement;
        let cases = [
            (3, vec![(2, complement), (4, complement), (5, Node::Intersection(3))], "((0-1)-2)"),
            (
                3,
                vec![
                    (2, complement),
                    (3, Node::Intersection(2)),
                    (5, complement),
                    (6, Node::Intersection(2)),
                ],
                "((0-1)-2)",
            ),
            (
                3,
                vec![(3, Node::Union(2)), (4, complement), (5, Node::Intersection(2))],
                "(0-(1+2))",
            ),
            (
                6,
                vec![(3, complement), (7, complement), (8, Node::Intersection(6))],
                "(((((0*1)-2)*3)*4)-5)",
            ),
        ];
        for (n, operators, expected) in cases {
            assert_eq!(tree(&row(n, &operators)).0, expected, "{operators:?}");
        }
    }

    #[test]
    fn a_class_used_twice_is_printed_twice() {
        let mut scene = Scene::default();
        let mut table = AttributesTable::default();
        let trans = Transparency { half_distance: 3.0, index: Index::Refractive(1.5) };
        let glass = Attributes { transparency: Some(trans), ..Attributes::default() };
        let coat = Paint { texture: Texture::named("checker3d").unwrap(), color: DVec3::X };
        let red = Attributes {
            color: Some(DVec3::new(0.5, 0.0, 0.0)),
            smoothness: Some(0.125),
            paint: vec![coat],
            ..Attributes::default()
        };
        let (glass, red) = (table.intern(&mut scene, glass), table.intern(&mut scene, red));
        let stretched = Placement {
            scale: DVec3::new(2.0, 1.0, 4.0),
            place: DVec3::new(1.0, 0.0, 0.0),
            ..Placement::default()
        };
        let cut = Solid {
            frames: vec![
                Frame { parent: None, placement: stretched, attributes: glass },
                at(0.0, 0.5, 0.0),
            ],
            nodes: vec![
                Node::Primitive { kind: Primitive::Block, frame: FrameId(0) },
                Node::Primitive { kind: Primitive::Cone, frame: FrameId(1) },
                Node::Complement,
                Node::Intersection(2),
            ],
        };
        scene.add_class("cut".to_owned(), cut);
        let twice = Solid {
            frames: vec![at(0.0, 8.0, 0.0), Frame { attributes: red, ..at(0.0, -8.0, 0.0) }],
            nodes: vec![instance(0, 0), instance(0, 1), Node::Union(2)],
        };
        scene.add_object(Some("twice".to_owned()), twice);
        let text = printed(&scene, 4);
        let boxes: Vec<&str> =
            text.lines().filter_map(|line| line.strip_prefix("    box ")).collect();
        let text: String = text.split_inclusive('\n').filter(|l| !l.contains("box")).collect();
        assert_eq!(text, TWICE, "without the boxes");
        // Each block reaches from −1 to 3 along x, by 1 along y and by 4 along z.
        let expected = [
            [-1.0, 7.0, -4.0, 3.0, 9.0, 4.0],
            [-1.0, -9.0, -4.0, 3.0, -7.0, 4.0],
            [-1.0, -9.0, -4.0, 3.0, 9.0, 4.0],
        ];
        assert_eq!(boxes.len(), 3, "{boxes:?}");
        for (found, expected) in boxes.iter().zip(expected) {
            for (found, expected) in found.split(' ').zip(expected) {
                let found: f64 = found.parse().unwrap();
                assert!((found - expected).abs() < 1e-13, "{boxes:?}");
            }
        }
    }

    const TWICE: &str = "\
portray expanded 1
object twice
  block
    matrix 0.5 0.0 0.0 -0.5 0.0 1.0 0.0 -8.0 0.0 0.0 0.25 0.0
    inverse 2.0 0.0 0.0 1.0 0.0 1.0 0.0 8.0 0.0 0.0 4.0 0.0
    optics color 1.0 1.0 1.0 shininess 1.0 smoothness 0.25 composite trans 3.0 1.5 priority 0
  cone
    matrix 1.0 0.0 0.0 0.0 0.0 1.0 0.0 -8.5 0.0 0.0 1.0 0.0
    inverse 1.0 0.0 0.0 0.0 0.0 1.0 0.0 8.5 0.0 0.0 1.0 0.0
    optics color 1.0 1.0 1.0 shininess 0.0 smoothness 0.25 composite priority 0
  subtraction
  block
    matrix 0.5 0.0 0.0 -0.5 0.0 1.0 0.0 8.0 0.0 0.0 0.25 0.0
    inverse 2.0 0.0 0.0 1.0 0.0 1.0 0.0 -8.0 0.0 0.0 4.0 0.0
    optics color 0.5 0.0 0.0 shininess 1.0 smoothness 0.125 composite trans 3.0 1.5 priority 0
    paint checker3d scale 1.0 color 1.0 0.0 0.0
    grain 1.0 0.0 0.0 0.0 0.0 1.0 0.0 8.0 0.0 0.0 1.0 0.0
  cone
    matrix 1.0 0.0 0.0 0.0 0.0 1.0 0.0 7.5 0.0 0.0 1.0 0.0
    inverse 1.0 0.0 0.0 0.0 0.0 1.0 0.0 -7.5 0.0 0.0 1.0 0.0
    optics color 0.5 0.0 0.0 shininess 0.0 smoothness 0.125 composite priority 0
    paint checker3d scale 1.0 color 1.0 0.0 0.0
    grain 1.0 0.0 0.0 0.0 0.0 1.0 0.0 8.0 0.0 0.0 1.0 0.0
  subtraction
  union
end
";

    #[test]
    fn what_is_said_further_in_wins() {
        let mut scene = Scene::default();
        let mut table = AttributesTable::default();
        let coat = |color| Paint { texture: Texture::named("checker3d").unwrap(), color };
        let mut shiny = |shininess, smoothness, paint: &[Paint]| {
            let attributes = Attributes {
                shininess: Some(shininess),
                smoothness,
                paint: paint.to_vec(),
                ..Attributes::default()
            };
            table.intern(&mut scene, attributes)
        };
        let outer = shiny(0.125, Some(0.0), &[coat(DVec3::X)]);
        let group = shiny(0.25, None, &[coat(DVec3::Y), coat(DVec3::Z)]);
        let inner = shiny(0.5, None, &[]);
        let own = shiny(0.75, None, &[coat(DVec3::ONE)]);
        let within =
            |attributes, x| Frame { parent: Some(FrameId(0)), attributes, ..at(x, 0.0, 0.0) };
        let frames = vec![
            Frame { attributes: group, ..at(0.0, 4.0, 0.0) },
            within(inner, 1.0),
            within(own, 2.0),
        ];
        let leaf = |frame| Node::Primitive { kind: Primitive::Sphere, frame: FrameId(frame) };
        let pair = Solid { frames, nodes: vec![leaf(1), leaf(2), Node::Union(2)] };
        scene.add_class("pair".to_owned(), pair);
        let frames = vec![Frame { attributes: outer, ..at(0.0, 0.0, 8.0) }];
        scene.add_object(None, Solid { frames, nodes: vec![instance(0, 0)] });
        let text = printed(&scene, LIMIT);
        let said: Vec<&str> = text
            .lines()
            .filter_map(|line| {
                line.strip_prefix("    ").filter(|line| {
                    ["optics", "paint", "grain"].iter().any(|word| line.starts_with(word))
                })
            })
            .collect();
        let expected = [
            "optics color 1.0 1.0 1.0 shininess 0.5 smoothness 0.0 composite priority 0",
            "paint checker3d scale 1.0 color 0.0 1.0 0.0",
            "paint checker3d scale 1.0 color 0.0 0.0 1.0",
            "grain 1.0 0.0 0.0 0.0 0.0 1.0 0.0 -4.0 0.0 0.0 1.0 -8.0",
            "optics color 1.0 1.0 1.0 shininess 0.75 smoothness 0.0 composite priority 0",
            "paint checker3d scale 1.0 color 1.0 1.0 1.0",
        ];
        assert_eq!(said, expected, "{text}");
    }

    #[test]
    fn what_is_too_large_is_counted_and_refused() {
        let mut scene = row(1, &[]);
        for level in 0..40 {
            let frames = vec![at(1.0, 0.0, 0.0); 10];
            let kind = Primitive::Sphere;
            let mut nodes: Vec<Node> = match level {
                0 => (0..10).map(|i| Node::Primitive { kind, frame: FrameId(i) }).collect(),
                _ => (0..10).map(|i| instance(level - 1, i)).collect(),
            };
            nodes.push(Node::Union(10));
            scene.add_class(format!("level_{level}"), Solid { frames, nodes });
        }
        let sum = Solid { frames: vec![at(0.0, 0.0, 0.0)], nodes: vec![instance(2, 0)] };
        scene.add_object(None, sum.clone());
        let mut text = Vec::new();
        match print(&scene, 1000, &mut text) {
            Err(PaperError::TooMany { primitives: 1001, limit: 1000 }) => {}
            other => panic!("{other:?}"),
        }
        assert!(text.is_empty(), "nothing is printed");
        assert_eq!(printed(&scene, 1001).matches("optics").count(), 1001, "one more is allowed");
        scene.objects[1].solid.nodes = vec![instance(39, 0)];
        let message = print(&scene, LIMIT, &mut text).unwrap_err().to_string();
        assert!(message.contains("at least 18446744073709551615 primitives"), "{message}");
    }

    #[test]
    fn classes_nested_deeply_cost_no_stack_and_overflow_is_named() {
        let mut scene = row(1, &[]);
        let half = Placement { scale: DVec3::splat(0.5), ..Placement::default() };
        let frame = Frame { placement: half, ..at(0.0, 0.0, 0.0) };
        let once = |node| Solid { frames: vec![frame], nodes: vec![node] };
        let kind = Primitive::Cylinder;
        scene.add_class("c".to_owned(), once(Node::Primitive { kind, frame: FrameId(0) }));
        for class in 0..20_000 {
            scene.add_class("c".to_owned(), once(instance(class, 0)));
        }
        scene.objects[0].solid = once(instance(999, 0));
        assert!(printed(&scene, 1).contains("  cylinder\n"), "2⁻¹⁰⁰¹ is a number");
        scene.add_object(None, once(instance(20_000, 0)));
        match print(&scene, LIMIT, &mut io::sink()) {
            Err(PaperError::NotFinite { object: 1 }) => {}
            other => panic!("{other:?}"),
        }
    }
}
