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

/// The number in the first line; it rises with every change of the grammar or of what a line means.
const VERSION: u32 = 1;

/// The solids of the paper.
const KNOWN: &[Primitive] =
    &[Primitive::Sphere, Primitive::Cylinder, Primitive::Cone, Primitive::Block];

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
    /// A solid that the first scene compiler had no word for; nothing was printed.
    NotOfThePaper {
        /// Its word.
        solid: &'static str,
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
            Self::NotOfThePaper { solid } => {
                write!(f, "`{solid}` has no expanded form: it knows ")?;
                let known: Vec<&str> = KNOWN.iter().map(|kind| kind.keywords()[0]).collect();
                write!(f, "{} only", known.join(", "))
            }
            Self::Write(_) => write!(f, "cannot write the expanded scene"),
        }
    }
}

impl std::error::Error for PaperError {
    fn source(&self) -> Option<&(dyn std::error::Error + 'static)> {
        match self {
            Self::Write(error) => Some(error),
            Self::TooMany { .. } | Self::NotOfThePaper { .. } | Self::NotFinite { .. } => None,
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
/// A solid that is not of the paper, or more primitives than `limit`, before anything is printed; a matrix that overflows; what `out` says.
///
/// # Panics
///
/// When a solid is not well formed; the compiler and the reader of compiled scenes make no such solid.
pub fn print(scene: &Scene, limit: u64, out: &mut impl Write) -> Result<(), PaperError> {
    if let Some(solid) = unknown(scene) {
        return Err(PaperError::NotOfThePaper { solid });
    }
    let primitives = count(scene);
    if primitives > limit {
        return Err(PaperError::TooMany { primitives, limit });
    }
    let mut out = BufWriter::new(out);
    writeln!(out, "portray expanded {VERSION}")?;
    format::write_surroundings(scene, &mut out)?;
    let images = scene.images.len();
    let classes: Vec<Definition<'_>> =
        scene.classes.iter().map(|class| Definition::new(&class.solid, scene)).collect();
    for (number, Object { name, solid }) in scene.objects.iter().enumerate() {
        match name {
            Some(name) => writeln!(out, "object {name}")?,
            None => writeln!(out, "object")?,
        }
        let solid = Definition::new(solid, scene);
        expand(
            &solid,
            &classes,
            &mut Operands { boxes: Vec::new(), number, images, out: &mut out },
        )?;
    }
    writeln!(out, "end")?;
    Ok(out.flush()?)
}

/// The word of a solid that is not of the paper, if any class or object has one.
fn unknown(scene: &Scene) -> Option<&'static str> {
    let classes = scene.classes.iter().map(|class| &class.solid);
    let solids = classes.chain(scene.objects.iter().map(|object| &object.solid));
    solids.flat_map(|solid| solid.nodes.iter().map(move |node| (solid, node))).find_map(
        |(solid, node)| match *node {
            Node::Primitive { kind, .. } if !KNOWN.contains(&kind) => Some(kind.keywords()[0]),
            Node::Form { form, .. } => Some(solid.form(form).row().keyword),
            _ => None,
        },
    )
}

/// How many primitives the objects stand for.
fn count(scene: &Scene) -> u64 {
    let mut classes: Vec<u64> = Vec::with_capacity(scene.classes.len());
    let of = |solid: &Solid, classes: &[u64]| {
        solid.nodes.iter().fold(0, |sum: u64, node| match *node {
            Node::Primitive { .. } | Node::Form { .. } => sum.saturating_add(1),
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
            Node::Primitive { .. } | Node::Form { .. } | Node::Instance { .. } => operands.push(i),
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
            // Forms have been refused.
            Node::Form { .. } | Node::Union(_) | Node::Intersection(_) | Node::Complement => {}
        }
    }
    Ok(())
}

/// The printed operands of one object that are not yet joined.
struct Operands<'a, W: Write> {
    boxes: Vec<Bounds>,
    /// Which object it is.
    number: usize,
    /// How many files of pictures there are.
    images: usize,
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
        write!(self.out, "    ")?;
        format::write_paint(coat, self.images, &mut self.out)?;
        writeln!(self.out)
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
mod tests;
