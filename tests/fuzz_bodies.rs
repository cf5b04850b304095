//! The fuzz bodies over a small corpus with seeded mutations.

/// A fixed sequence of numbers below `n`.
struct Numbers(u64);

impl Numbers {
    fn below(&mut self, n: usize) -> usize {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        usize::try_from(self.0 >> 33).expect("31 bits") % n.max(1)
    }
}

/// Runs `body` over `rounds` mutations of the corpus: bytes changed, taken out, doubled, pieces moved and spliced.
fn mutate(corpus: &[&[u8]], rounds: usize, body: fn(&[u8])) {
    let mut numbers = Numbers(0x5851_f42d_4c95_7f2d);
    for original in corpus {
        body(original);
    }
    for _ in 0..rounds {
        let mut bytes = corpus[numbers.below(corpus.len())].to_vec();
        for _ in 0..=numbers.below(6) {
            let at = numbers.below(bytes.len());
            let end = (at + numbers.below(24)).min(bytes.len());
            match numbers.below(6) {
                0 if !bytes.is_empty() => bytes[at] = numbers.below(256).to_le_bytes()[0],
                1 => drop(bytes.drain(at..end)),
                2 => {
                    let piece = bytes[at..end].to_vec();
                    bytes.splice(at..at, piece);
                }
                3 => {
                    let other = corpus[numbers.below(corpus.len())];
                    let from = numbers.below(other.len());
                    let to = (from + numbers.below(40)).min(other.len());
                    bytes.splice(at..at, other[from..to].iter().copied());
                }
                4 if !bytes.is_empty() => {
                    bytes[at] = b"()+-*.,0123456789e \n\"/"[numbers.below(22)];
                }
                _ => bytes.truncate(end),
            }
        }
        body(&bytes);
    }
}

const LISTING: &[u8] = include_bytes!("../scenes/wine-glass/wine-glass.sdl");
const SMALL: &[u8] = b"class a is smooth shiny red (sphere - block at (.5,0,0) rotate (1,2,3)) scale (1,2,3)
object o is trans (2, 1.5) a at (0,1,0) + paint checker (4) blue cylinder * cone
light beam at (1,1,1) light spot (2,30) at (0,9,0) toward (0,0,0) no shadows
ambient intensity .2 fog 30 background very light gray camera at (3,4,5) target at (0,0,0) focal length 35";

const NUMBERS: &[u8] = b"let n = 2 + 3 * -2 ^ 2 / 4 let r = max (1, abs (sin (30)))
class wheel (radius, width = radius / 5) is red cylinder scale (width, radius, radius) - block scale r
class car (w) is wheel (w) + wheel (radius = w, width = 1) at (frame, mod (7, 3), pi)
repeat i from 1 to 3 { let a = i * 20 repeat j from 1 to 0 step -.5 { object is car (j + 1) rotate (0, a, 0) }
light point at (i, 9, 0) intensity (1 / i) }
object is union of i from 1 to 4 (sphere scale (1 / i) at (i, 0, 0)) scale n * intersection of k from 1 to 2 (block scale k)
camera at (0, 0, 9)";

const COMMENTS: &[u8] = b"// a wheel\nclass wheel (r) is /* round */ cylinder // and flat\n\n  scale (.2, r, r)
/* two\n   lines */ object is wheel /* of */ (1) // here\n - ( block // a hole\n at (1,0,0) ) let /* n */ n = ( 1 // one\n + 2 )
repeat i from 1 to n { // each\n object is red-orange sphere at (i,0,0) /* last */ } // end\ncamera at (0,0,9)";

#[test]
fn scene_descriptions() {
    mutate(&[LISTING, SMALL, NUMBERS], 60_000, suite_tests::sdl);
}

#[test]
fn layouts() {
    mutate(&[LISTING, SMALL, NUMBERS, COMMENTS], 20_000, suite_tests::layout);
}

#[test]
fn compiled_scenes() {
    let compile = |text: &[u8]| {
        let scene = compile::compile_text(text).scene.expect("the corpus compiles");
        let mut bytes = Vec::new();
        scene::format::write(&scene, &mut bytes).expect("written to memory");
        bytes
    };
    let [listing, small, numbers] = [LISTING, SMALL, NUMBERS].map(compile);
    mutate(&[&listing, &small, &numbers], 40_000, suite_tests::compiled_scene);
}

#[test]
fn descriptions() {
    let corpus: &[u8] = b"idf 1\nsize 4 3\nwindow 1 2 4 3\ntransfer gamma 2.2\nmatte straight\n\
        background 0.8 0.8 0.8\nred \"a b.red\" 4 3 8 rle\ngrn a.grn 4 3 16 raw\nblu a.blu 4 3 32f raw\n\
        lut a.lut 256 3 8 raw\nlog a.log\nother words kept\n";
    mutate(&[corpus], 20_000, suite_tests::description);
}

#[test]
fn coded_rows() {
    let corpus: &[u8] = &[7, 0xfe, 1, 2, 3, 4, 5, 0x81, 0, 1, 2, 0xfd, 9];
    mutate(&[corpus, &[255; 40], &[0; 3]], 50_000, suite_tests::rle);
}

/// A channel of noise in the middle and flat rows about it, as [`suite_tests::bands`] takes it.
fn channel(form: u8, width: usize) -> Vec<u8> {
    let (columns, rows) = (9_usize, 6_usize);
    let mut numbers = Numbers(9);
    let row = |row: usize| -> Vec<u8> {
        let mut byte = |at: usize| {
            if row == 2 { numbers.below(256).to_le_bytes()[0] } else { (at / 20).to_le_bytes()[0] }
        };
        (0..columns * width).map(&mut byte).collect()
    };
    let plain: Vec<Vec<u8>> = (0..rows).map(row).collect();
    let data = if form & 1 == 0 {
        plain.concat()
    } else {
        let coded = plain.iter().map(|row| {
            let mut coded = Vec::new();
            idf::rle::encode_row(row, &mut coded);
            coded
        });
        let coded: Vec<Vec<u8>> = coded.collect();
        let length = |row: &Vec<u8>| u32::try_from(row.len()).expect("a short row").to_le_bytes();
        [coded.iter().flat_map(length).collect(), coded.concat()].concat()
    };
    [vec![8, 5, form, 1], data].concat()
}

#[test]
fn bands_of_images() {
    let corpus = [(0, 1), (1, 1), (2, 2), (3, 2), (4, 4), (5, 4)].map(|(f, w)| channel(f, w));
    let corpus: Vec<&[u8]> = corpus.iter().map(Vec::as_slice).collect();
    mutate(&corpus, 4_000, suite_tests::bands);
}
