//! What a terminal is asked, and what its answers say.

/// Questions: whether it knows the kitty protocol (by a picture of one pixel that is not kept),
/// its background, the colours of a sixel picture, the size of a character and of the window in
/// pixels. Last what every terminal answers, and by that all that it will have answered: its device
/// attributes.
pub(crate) const QUESTIONS: &str = "\x1b_Gi=31,s=1,v=1,a=q,t=d,f=24;AAAA\x1b\\\x1b]11;?\x1b\\\
                                    \x1b[?1;1;0S\x1b[16t\x1b[14t\x1b[c";

/// What a terminal answered.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Answers {
    /// It draws kitty graphics.
    pub(crate) kitty: bool,
    /// It draws sixel.
    pub(crate) sixel: bool,
    /// Width and height of a character in pixels.
    pub(crate) cell: Option<[u32; 2]>,
    /// Width and height of the text in pixels.
    pub(crate) text: Option<[u32; 2]>,
    /// Colours of a sixel picture.
    pub(crate) registers: Option<usize>,
    /// Display values behind the text.
    pub(crate) background: Option<[f64; 3]>,
    /// The last question is answered.
    pub(crate) is_complete: bool,
    /// It was not asked, for there was input already.
    pub(crate) were_keys_typed: bool,
}

impl Answers {
    /// The last byte of the last answer.
    pub(crate) const LAST: u8 = b'c';

    /// Reads answers among other bytes, such as keys that were pressed meanwhile.
    pub(crate) fn parse(bytes: &[u8]) -> Self {
        let text = String::from_utf8_lossy(bytes);
        let mut answers = Self::default();
        for sequence in text.split('\x1b').skip(1) {
            answers.take(sequence);
        }
        answers
    }

    /// Takes one sequence, without its escape.
    fn take(&mut self, sequence: &str) {
        if let Some(body) = sequence.strip_prefix("_Gi=31") {
            self.kitty = body.strip_prefix(';') == Some("OK");
        } else if let Some(body) = sequence.strip_prefix("]11;") {
            self.background = color(body.trim_end_matches('\x07'));
        } else if let Some((numbers, end)) = sequence.strip_prefix("[?").and_then(control) {
            match (end, &numbers[..]) {
                // Number 4 among the attributes is sixel.
                ('c', attributes) => {
                    self.sixel = attributes.iter().skip(1).any(|&attribute| attribute == 4);
                    self.is_complete = true;
                }
                ('S', &[1, 0, registers]) => self.registers = usize::try_from(registers).ok(),
                _ => {}
            }
        } else if let Some((numbers, end)) = sequence.strip_prefix('[').and_then(control) {
            match (numbers[..].split_first(), end) {
                (Some((&6, &[height, width])), 't') => self.cell = size(width, height),
                (Some((&4, &[height, width])), 't') => self.text = size(width, height),
                _ => {}
            }
        }
    }
}

/// Numbers and final character of a control sequence, without what may come after it.
fn control(body: &str) -> Option<(Vec<u32>, char)> {
    let end = body.find(|c: char| !c.is_ascii_digit() && c != ';')?;
    // An empty number stands for 0; kitty's attributes end in one.
    let number = |digits: &str| if digits.is_empty() { Ok(0) } else { digits.parse() };
    let numbers = body[..end].split(';').map(number).collect::<Result<_, _>>().ok()?;
    Some((numbers, body[end..].chars().next()?))
}

fn size(width: u32, height: u32) -> Option<[u32; 2]> {
    (width > 0 && height > 0).then_some([width, height])
}

/// `rgb:` and three numbers of one to four hexadecimal digits (Xlib, "Color Strings").
fn color(text: &str) -> Option<[f64; 3]> {
    let mut numbers = text.strip_prefix("rgb:")?.split('/').map(|digits| {
        let most = match digits.len() {
            1..=4 => (1_u32 << (4 * digits.len())) - 1,
            _ => return None,
        };
        let number = u32::from_str_radix(digits, 16).ok()?;
        Some(f64::from(number) / f64::from(most))
    });
    let color = [numbers.next()??, numbers.next()??, numbers.next()??];
    numbers.next().is_none().then_some(color)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn terminals_say_what_they_have() {
        let kitty = Answers::parse(
            b"\x1b_Gi=31;OK\x1b\\\x1b]11;rgb:ffff/8080/0000\x1b\\\x1b[6;20;10t\x1b[4;480;800t\
              \x1b[?62;c",
        );
        assert!(kitty.kitty && !kitty.sixel && kitty.is_complete, "{kitty:?}");
        assert_eq!((kitty.cell, kitty.text), (Some([10, 20]), Some([800, 480])));
        assert_eq!(kitty.background, Some([1.0, 32_896.0 / 65_535.0, 0.0]));
        let xterm = Answers::parse(b"\x1b[?1;0;16S\x1b]11;rgb:00/80/ff\x07\x1b[?63;1;2;4;6c");
        assert!(xterm.sixel && xterm.is_complete && !xterm.kitty, "{xterm:?}");
        assert_eq!(xterm.registers, Some(16));
        assert_eq!(xterm.background, Some([0.0, 128.0 / 255.0, 1.0]));
        let plain = Answers::parse(b"\x1b[?6c");
        assert_eq!(plain, Answers { is_complete: true, ..Answers::default() });
    }

    #[test]
    fn other_bytes_are_no_answers() {
        let noise = b"keys\x1b[A\x1b[1;5C\xff\xfe\x1b]11;rgb:zz/0/0\x07\x1b[6;0;10t\x1b[t\x1b[?9999999999c\x1b";
        assert_eq!(Answers::parse(noise), Answers::default());
        assert!(!Answers::parse(b"\x1b_Gi=31;ENOTSUPPORTED\x1b\\").kitty, "an error is no");
        assert!(!Answers::parse(b"\x1b[?4;6").is_complete, "half an answer");
        assert!(!Answers::parse(b"\x1b[?4c").sixel, "the first number is the kind of terminal");
    }

    #[test]
    fn keys_around_answers_do_not_matter() {
        let answers = Answers::parse(b"q\x1b[?62;4cq\r");
        assert!(answers.is_complete && answers.sixel, "{answers:?}");
    }
}
