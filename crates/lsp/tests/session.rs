//! The real program, spoken to by a script.

#![expect(clippy::unwrap_used, reason = "functions that tests share")]

use std::collections::VecDeque;
use std::fs;
use std::io::{BufRead, BufReader, Read, Write};
use std::path::Path;
use std::process::{Child, ChildStdin, ChildStdout, Command, ExitStatus, Stdio};

use serde_json::{Value, json};
use tempfile::TempDir;

/// A client and the server it has started.
struct Client {
    child: Child,
    input: Option<ChildStdin>,
    output: BufReader<ChildStdout>,
    /// Notifications that came while an answer was waited for.
    waiting: VecDeque<Value>,
    last: i64,
}

impl Client {
    /// A server that has not been spoken to.
    fn silent() -> Self {
        let mut child = Command::new(env!("CARGO_BIN_EXE_prlsp"))
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .unwrap();
        let input = child.stdin.take();
        let output = BufReader::new(child.stdout.take().unwrap());
        Self { child, input, output, waiting: VecDeque::new(), last: 0 }
    }

    /// One that knows the encodings of the client.
    fn with(encodings: &Value) -> (Self, Value) {
        let mut client = Self::silent();
        let capabilities = json!({ "general": { "positionEncodings": encodings } });
        let answer = client.ask("initialize", json!({ "capabilities": capabilities }));
        client.tell("initialized", json!({}));
        (client, answer)
    }

    fn new() -> Self {
        Self::with(&Value::Null).0
    }

    fn write(&mut self, message: &Value) {
        let text = message.to_string();
        let input = self.input.as_mut().unwrap();
        write!(input, "Content-Length: {}\r\n\r\n{text}", text.len()).unwrap();
        input.flush().unwrap();
    }

    fn tell(&mut self, method: &str, params: Value) {
        self.write(&json!({ "jsonrpc": "2.0", "method": method, "params": params }));
    }

    /// The whole answer to a request.
    fn answer(&mut self, method: &str, params: Value) -> Value {
        self.last += 1;
        let id = self.last;
        self.write(&json!({ "jsonrpc": "2.0", "id": id, "method": method, "params": params }));
        loop {
            let message = self.read();
            if message["id"] == json!(id) {
                return message;
            }
            self.waiting.push_back(message);
        }
    }

    /// The result of a request.
    fn ask(&mut self, method: &str, params: Value) -> Value {
        let mut answer = self.answer(method, params);
        assert!(answer.get("error").is_none(), "{method}: {answer}");
        answer["result"].take()
    }

    fn read(&mut self) -> Value {
        let mut length = 0;
        loop {
            let mut line = String::new();
            assert!(self.output.read_line(&mut line).unwrap() > 0, "the server is gone");
            match line.trim().split_once(": ") {
                Some(("Content-Length", number)) => length = number.parse().unwrap(),
                Some(_) => {}
                None => break,
            }
        }
        let mut text = vec![0; length];
        self.output.read_exact(&mut text).unwrap();
        serde_json::from_slice(&text).unwrap()
    }

    /// The next findings that are told about `uri`.
    fn findings(&mut self, uri: &str) -> Value {
        loop {
            let mut message = self.waiting.pop_front().unwrap_or_else(|| self.read());
            if message["params"]["uri"] == json!(uri) {
                assert_eq!(message["method"], "textDocument/publishDiagnostics", "{message}");
                return message["params"].take();
            }
        }
    }

    fn open(&mut self, uri: &str, text: &str) {
        let document = json!({ "uri": uri, "languageId": "sdl", "version": 1, "text": text });
        self.tell("textDocument/didOpen", json!({ "textDocument": document }));
    }

    fn change(&mut self, uri: &str, version: i32, changes: &Value) {
        let document = json!({ "uri": uri, "version": version });
        let params = json!({ "textDocument": document, "contentChanges": changes });
        self.tell("textDocument/didChange", params);
    }

    /// Labels of what is offered at a place.
    fn offered(&mut self, uri: &str, line: u32, column: u32) -> Vec<String> {
        let items = self.ask("textDocument/completion", place(uri, line, column));
        let labels = items.as_array().unwrap().iter().map(|item| item["label"].as_str().unwrap());
        labels.map(str::to_owned).collect()
    }

    fn hover(&mut self, uri: &str, line: u32, column: u32) -> String {
        let answer = self.ask("textDocument/hover", place(uri, line, column));
        answer["contents"]["value"].as_str().unwrap_or_default().to_owned()
    }

    /// Ends the conversation in good order.
    fn end(mut self) -> ExitStatus {
        self.ask("shutdown", Value::Null);
        let refused = self.answer("textDocument/hover", place("file:///x.sdl", 0, 0));
        assert_eq!(refused["error"]["code"], -32600, "nothing is answered now: {refused}");
        self.tell("exit", Value::Null);
        self.input = None;
        self.child.wait().unwrap()
    }
}

fn place(uri: &str, line: u32, column: u32) -> Value {
    json!({ "textDocument": { "uri": uri }, "position": { "line": line, "character": column } })
}

fn range(line: u32, from: u32, to: u32) -> Value {
    let at = |column: u32| json!({ "line": line, "character": column });
    json!({ "start": at(from), "end": at(to) })
}

fn uri(path: &Path) -> String {
    format!("file://{}", path.canonicalize().unwrap().display())
}

const MAIN: &str = "file:///nowhere/main.sdl";

#[test]
fn findings_follow_every_change() {
    let mut client = Client::new();
    client.open(MAIN, "object is glas\ncamera at (0, 0, 5)\nfog 0\n");
    let found = client.findings(MAIN);
    assert_eq!(found["version"], 1);
    let list = found["diagnostics"].as_array().unwrap();
    assert_eq!(list.len(), 2, "{found}");
    assert_eq!(list[0]["message"], "unknown class `glas`");
    assert_eq!((&list[0]["range"], &list[0]["severity"]), (&range(0, 10, 14), &json!(1)));
    assert_eq!(list[1]["range"], range(2, 4, 5));

    // Two changes of one message: each is of the text that the one before has left.
    let insert = json!({ "range": range(0, 0, 0), "text": "class glas is cone\n" });
    let fog = json!({ "range": range(3, 4, 5), "text": "20" });
    client.change(MAIN, 2, &json!([insert, fog]));
    assert_eq!(client.findings(MAIN), json!({ "uri": MAIN, "version": 2, "diagnostics": [] }));

    client.change(MAIN, 3, &json!([{ "text": "fog 1 fog 2" }]));
    let found = client.findings(MAIN);
    let warning = &found["diagnostics"][0];
    assert_eq!((&found["version"], &warning["severity"]), (&json!(3), &json!(2)), "{found}");
    assert_eq!(warning["relatedInformation"][0]["location"]["range"], range(0, 0, 3), "{warning}");

    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": MAIN } }));
    assert_eq!(client.findings(MAIN)["diagnostics"], json!([]), "nothing is left behind");
    assert!(client.end().success());
}

#[test]
fn columns_are_counted_as_agreed() {
    // Two units of UTF-16, four bytes.
    let text = "/* 🍷 */ object is glas";
    for (encodings, named, column) in [
        (Value::Null, "utf-16", 19),
        (json!(["utf-32", "utf-16"]), "utf-16", 19),
        (json!(["utf-16", "utf-8"]), "utf-8", 21),
    ] {
        let (mut client, answer) = Client::with(&encodings);
        assert_eq!(answer["capabilities"]["positionEncoding"], named);
        client.open(MAIN, text);
        let found = client.findings(MAIN);
        assert_eq!(found["diagnostics"][0]["range"], range(0, column, column + 4), "{named}");
        let name = json!([{ "range": range(0, column, column + 4), "text": "sphere" }]);
        client.change(MAIN, 2, &name);
        assert_eq!(client.findings(MAIN)["diagnostics"], json!([]), "{named}");
        assert!(client.end().success());
    }
}

#[test]
fn what_may_stand_at_a_place_is_offered() {
    let mut client = Client::new();
    let text = "// Round.\nclass ball (r) is sphere scale r\nlet size = 2\nobject is paint  red bal\n// at \ninclude \"a\"\n";
    client.open(MAIN, text);
    let textures = client.offered(MAIN, 3, 16);
    assert_eq!(
        textures,
        [
            "brick",
            "bump",
            "checker",
            "checker3d",
            "decal",
            "fourier",
            "gradient",
            "granite",
            "grid",
            "image",
            "marble",
            "noise",
            "projection",
            "rings",
            "spots",
            "stripes",
            "turbulence",
            "wood"
        ]
    );
    let solids = client.offered(MAIN, 3, 24);
    for word in ["ball", "sphere", "red", "shiny", "trans", "union"] {
        assert!(solids.iter().any(|offered| offered == word), "{word}: {solids:?}");
    }
    let numbers = client.offered(MAIN, 2, 11);
    for word in ["size", "sin", "pi"] {
        assert!(numbers.iter().any(|offered| offered == word), "{word}: {numbers:?}");
    }
    assert!(!numbers.iter().any(|offered| offered == "sphere"), "no solid is a number");
    assert!(client.offered(MAIN, 4, 6).is_empty(), "in a comment");
    assert!(client.offered(MAIN, 5, 10).is_empty(), "in a text");
    assert!(client.end().success());
}

/// What has to be offered at the `|` of a text, and what must not.
const OFFERS: &[(&str, &[&str], &[&str])] = &[
    ("light |", &["point", "beam", "spot", "at", "no", "red"], &["sphere", "length", "rotate"]),
    (
        "light point at (0, 1, 0) |",
        &["intensity", "no", "radius", "red", "camera"],
        &["sphere", "point"],
    ),
    ("camera at (0, 1, 0) |", &["aperture", "light"], &["sphere", "point"]),
    ("light at (0, 1, 0) no |", &["shadows"], &["red", "at"]),
    ("camera |", &["at", "parallel"], &["sphere", "red", "point"]),
    ("camera parallel |", &["at"], &["sphere", "parallel"]),
    ("focal |", &["length"], &["red", "at"]),
    ("ambient |", &["intensity", "red", "light"], &["sphere", "at"]),
    ("background |", &["blue", "light", "very", "dark"], &["sphere", "at"]),
    ("object is |", &["sphere", "torus", "ball", "union", "shiny", "red"], &["at", "step", "sin"]),
    ("object is sphere |", &["at", "scale", "rotate", "light"], &["cone", "point", "sin"]),
    ("object is sphere - |", &["sphere", "ball", "intersection", "red"], &["at", "length"]),
    ("object is dark |", &["red", "reddish", "strong", "gray"], &["sphere", "white", "shiny"]),
    ("object is very |", &["dark", "light"], &["red", "sphere"]),
    ("object is strong |", &["red", "bluish"], &["dark", "gray", "sphere"]),
    ("object is light |", &["red", "strong", "gray"], &["white", "hsv"]),
    ("object is bluish |", &["green", "purple"], &["bluish", "sphere"]),
    ("object is red-|", &["orange", "sphere"], &["at"]),
    ("object is red |", &["sphere", "ball", "smooth"], &["at", "camera"]),
    ("object is paint |", &["wood", "bump"], &["red", "sphere"]),
    ("object is paint checker (|", &["u", "v", "sin", "size"], &["red", "sphere", "scale"]),
    ("object is paint checker (u = 4, |", &["v"], &["u", "red"]),
    ("object is paint image (\"a.png\", |", &["mapping", "planar", "u"], &["wood", "red"]),
    ("object is paint image (\"a.png\", mapping = |", &["box", "planar"], &["u", "sin"]),
    ("object is paint bump (|", &["brick", "noise"], &["height", "red"]),
    ("object is paint bump (brick, |", &["height"], &["brick", "red"]),
    ("object is paint bump (brick (|", &["u", "joint"], &["height", "brick"]),
    ("object is torus (|", &["tube", "size"], &["red", "sphere"]),
    ("object is ball (|", &["r", "size"], &["at"]),
    ("object is trans (1, |", &["fake", "size"], &["sphere", "red"]),
    ("object is sphere at (|", &["size", "sin", "pi"], &["sphere", "red"]),
    ("object is (|", &["sphere", "red", "union"], &["at", "camera"]),
    ("object is union |", &["of"], &["sphere", "at"]),
    ("object is sphere scale |", &["size", "sin"], &["sphere", "red"]),
    ("repeat i |", &["from"], &["to", "sphere"]),
    ("repeat i from 1 |", &["to"], &["step", "sphere"]),
    ("repeat i from 1 to 5 |", &["step"], &["sphere", "from"]),
    ("repeat i from 1 to 5 { |", &["object", "light", "repeat", "let"], &["sphere", "at"]),
];

#[test]
fn what_is_offered_follows_its_place() {
    let mut client = Client::new();
    let head = "class ball (r) is sphere scale r\nlet size = 2\nobject is ball (size)\n";
    client.open(MAIN, head);
    for (version, (text, some, none)) in (2..).zip(OFFERS) {
        let column = u32::try_from(text.find('|').unwrap()).unwrap();
        let text = format!("{head}{}", text.replace('|', ""));
        client.change(MAIN, version, &json!([{ "text": text }]));
        let offered = client.offered(MAIN, 3, column);
        for word in *some {
            assert!(offered.iter().any(|known| known == word), "{text}: `{word}` in {offered:?}");
        }
        for word in *none {
            assert!(
                offered.iter().all(|known| known != word),
                "{text}: no `{word}` in {offered:?}"
            );
        }
    }
    assert!(client.end().success());
}

#[test]
fn repeats_within_repeats_are_not_all_read() {
    let mut client = Client::new();
    let text =
        "repeat i from 1 to 3000 { repeat j from 1 to 3000 { object is spher at (i, j, 0) } }";
    client.open(MAIN, text);
    assert_eq!(client.findings(MAIN)["diagnostics"].as_array().unwrap().len(), 1, "misspelt");
    client.change(MAIN, 2, &json!([{ "text": text.replace("spher ", "sphere ") }]));
    assert_eq!(client.findings(MAIN)["diagnostics"].as_array().unwrap().len(), 0, "well");
    assert!(client.end().success());
}

#[test]
fn words_names_and_colours_are_explained() {
    let mut client = Client::new();
    let text = "// Round.\nclass ball is sphere\nobject is dark blue-green trans (2, 1.5) ball\nbackground hsv (0, 1, 1)\nlight at (0, 0, 0) light red";
    client.open(MAIN, text);
    assert_eq!(
        client.hover(MAIN, 2, 28),
        "`trans (h, n)`: light halves every h units; index of refraction n, or `fake`"
    );
    let ball = client.hover(MAIN, 2, 42);
    assert_eq!(ball, "class `ball`\n\n```sdl\nclass ball is sphere\n```\n\nRound.");
    // Hue 180, lightness 1/3.
    let color = client.hover(MAIN, 2, 17);
    assert!(color.contains("`#00aaaa`") && color.contains("%2300aaaa"), "{color}");
    assert!(color.ends_with("`dark blue-green`: 0, 170, 170"), "{color}");
    assert!(client.hover(MAIN, 3, 22).ends_with("`hsv (0, 1, 1)`: 255, 0, 0"), "in its numbers");
    assert!(client.hover(MAIN, 4, 21).ends_with("`light red`: 255, 85, 85"), "a lightness");
    assert!(client.hover(MAIN, 4, 1).starts_with("`light [point"), "a statement");
    assert_eq!(client.hover(MAIN, 0, 4), "", "nothing in a comment");
    assert!(client.end().success());
}

#[test]
fn definitions_are_found_through_files_and_in_texts_that_are_not_saved() {
    let folder = TempDir::new().unwrap();
    let (main, part) = (folder.path().join("main.sdl"), folder.path().join("a b.sdl"));
    fs::write(&main, "").unwrap();
    fs::write(&part, "class ball is sphere\n").unwrap();
    let (main, saved) = (uri(&main), uri(&part).replace(' ', "%20"));
    let mut client = Client::new();
    let text = "include \"a b.sdl\"\nobject is ball - ball at (1, 0, 0)\n";
    client.open(&main, text);
    assert_eq!(client.findings(&main)["diagnostics"], json!([]));
    let found = client.ask("textDocument/definition", place(&main, 1, 12));
    assert_eq!(found, json!({ "uri": saved, "range": range(0, 6, 10) }));
    let file = client.ask("textDocument/definition", place(&main, 0, 12));
    assert_eq!(file, json!({ "uri": saved, "range": range(0, 0, 0) }));
    let mut asked = place(&main, 1, 18);
    asked["context"] = json!({ "includeDeclaration": true });
    let places = client.ask("textDocument/references", asked);
    let places: Vec<Value> =
        places.as_array().unwrap().iter().map(|p| p["range"].clone()).collect();
    assert_eq!(places, [range(0, 6, 10), range(1, 10, 14), range(1, 17, 21)]);

    // The text in the editor stands for the file, and its change is one of all that include it.
    client.open(&saved, "\nclass round is sphere\nclass ball is round\n");
    assert_eq!(client.findings(&main)["diagnostics"], json!([]));
    let found = client.ask("textDocument/definition", place(&main, 1, 12));
    assert_eq!(found, json!({ "uri": saved, "range": range(2, 6, 10) }));
    client.change(&saved, 2, &json!([{ "text": "class round is sphere\n" }]));
    let found = client.findings(&main);
    assert_eq!(found["diagnostics"].as_array().unwrap().len(), 2, "{found}");
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": saved } }));
    assert_eq!(client.findings(&main)["diagnostics"], json!([]), "the file again");
    assert_eq!(client.ask("textDocument/definition", place(&main, 1, 3)), Value::Null);
    assert!(client.end().success());
}

#[test]
fn what_is_wrong_in_a_file_that_is_included_is_said_there() {
    let folder = TempDir::new().unwrap();
    let part = folder.path().join("part.sdl");
    fs::write(&part, "fog 0\n").unwrap();
    let part = uri(&part);
    let main = part.replace("part", "main");
    let mut client = Client::new();
    client.open(&main, "include \"part.sdl\"");
    assert_eq!(client.findings(&main)["diagnostics"], json!([]));
    let found = client.findings(&part);
    assert_eq!(found["diagnostics"][0]["range"], range(0, 4, 5), "{found}");
    client.change(&main, 2, &json!([{ "text": "fog 1" }]));
    assert_eq!(client.findings(&part)["diagnostics"], json!([]), "included no more");
    assert!(client.end().success());
}

#[test]
fn texts_are_laid_out_and_outlined() {
    let mut client = Client::new();
    client.open(MAIN, "class  ball is sphere\nobject Blob is ball // 🍷\nlet x=2");
    let options = json!({ "tabSize": 2, "insertSpaces": true });
    let asked = json!({ "textDocument": { "uri": MAIN }, "options": options });
    let edits = client.ask("textDocument/formatting", asked.clone());
    let laid = "class ball is sphere\nobject Blob is ball // 🍷\nlet x = 2\n";
    let whole =
        json!({ "start": { "line": 0, "character": 0 }, "end": { "line": 2, "character": 7 } });
    assert_eq!(edits, json!([{ "range": whole, "newText": laid }]));
    client.change(MAIN, 2, &json!([{ "text": laid }]));
    assert_eq!(client.ask("textDocument/formatting", asked.clone()), json!([]), "nothing to do");

    let outline =
        client.ask("textDocument/documentSymbol", json!({ "textDocument": { "uri": MAIN } }));
    let names: Vec<_> =
        outline.as_array().unwrap().iter().map(|s| (&s["name"], &s["kind"])).collect();
    let (ball, blob, x) = (json!("ball"), json!("Blob"), json!("x"));
    assert_eq!(names, [(&ball, &json!(5)), (&blob, &json!(19)), (&x, &json!(14))], "{outline}");
    assert_eq!(outline[1]["selectionRange"], range(1, 7, 11));
    client.change(MAIN, 3, &json!([{ "text": "fog  /* open" }]));
    assert_eq!(client.ask("textDocument/formatting", asked), json!([]), "left alone");
    assert!(client.end().success());
}

#[test]
fn odd_messages_are_refused_and_survived() {
    let mut client = Client::silent();
    let early = client.answer("textDocument/hover", place(MAIN, 0, 0));
    assert_eq!(early["error"]["code"], -32002, "not initialised: {early}");
    client.ask("initialize", json!({ "capabilities": {} }));
    client.tell("initialized", json!({}));
    let asked = |code: i32, answer: &Value| assert_eq!(answer["error"]["code"], code, "{answer}");
    asked(-32602, &client.answer("textDocument/hover", place(MAIN, 0, 0)));
    asked(-32602, &client.answer("textDocument/completion", json!({ "nonsense": 1 })));
    asked(-32601, &client.answer("textDocument/nonsense", json!({})));
    asked(-32601, &client.answer("initialize", json!({ "capabilities": {} })));
    client.tell("textDocument/didChange", json!({ "nonsense": 1 }));
    client.tell("textDocument/didOpen", json!([]));
    client.tell("textDocument/didClose", json!({ "textDocument": { "uri": MAIN } }));
    client.change(MAIN, 1, &json!([{ "text": "fog 1" }]));
    client.tell("nonsense", Value::Null);
    client.write(&json!({ "jsonrpc": "2.0", "id": 99, "result": null }));

    client.open(MAIN, "object is sphere\r\n");
    // Ranges that are none: behind the text, backwards, inside a character.
    let backwards =
        json!({ "start": { "line": 9, "character": 9 }, "end": { "line": 0, "character": 0 } });
    client.change(MAIN, 2, &json!([{ "range": backwards, "text": "🍷" }]));
    client.change(MAIN, 3, &json!([{ "range": range(1, 1, 1), "text": "x" }]));
    client.change(MAIN, 3, &json!([]));
    for (line, column) in [(0, 0), (1, 1), (7, 7), (u32::MAX, u32::MAX)] {
        for method in ["hover", "completion", "definition"] {
            client.ask(&format!("textDocument/{method}"), place(MAIN, line, column));
        }
    }
    client.open("untitled:a", "object is sphere include \"main.sdl\"");
    assert_eq!(client.findings("untitled:a")["diagnostics"].as_array().unwrap().len(), 1);
    assert!(client.end().success());
}

#[test]
fn a_client_that_breaks_off_is_an_error() {
    let mut client = Client::new();
    client.tell("exit", Value::Null);
    client.input = None;
    assert_eq!(client.child.wait().unwrap().code(), Some(1), "no shutdown");
    let mut client = Client::silent();
    client.input = None;
    assert_eq!(client.child.wait().unwrap().code(), Some(1), "not a word");
    let mut said = String::new();
    client.child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
    assert!(said.starts_with("prlsp: error: "), "{said}");
}

#[test]
fn bytes_that_are_no_message_end_the_session() {
    for (bytes, expected) in [
        (b"Content-Length: 99999999999999\r\n\r\n{}".as_slice(), "a Content-Length from 0 to"),
        (b"Content-Length: 2\r\n\r\n\xff\xfe", "expected a message"),
        (b"Content-Length: 9\r\n\r\n{}", "expected 9 bytes, found 2"),
        (b"\x00\x01\r\n", "in a header"),
    ] {
        let mut client = Client::new();
        client.input.take().unwrap().write_all(bytes).unwrap();
        assert_eq!(client.child.wait().unwrap().code(), Some(1), "{expected}");
        let mut said = String::new();
        client.child.stderr.take().unwrap().read_to_string(&mut said).unwrap();
        assert!(said.starts_with("prlsp: error: ") && said.contains(expected), "{said}");
    }
}

#[test]
fn the_command_line() {
    let run = |argument: &str| {
        Command::new(env!("CARGO_BIN_EXE_prlsp"))
            .arg(argument)
            .stdin(Stdio::null())
            .output()
            .unwrap()
    };
    let help = run("--help");
    assert!(help.status.success() && help.stdout.starts_with(b"The scene description language"));
    let version = String::from_utf8(run("--version").stdout).unwrap();
    assert_eq!(version, format!("prlsp {}\n", env!("CARGO_PKG_VERSION")));
    let wrong = run("--nonsense");
    assert_eq!(wrong.status.code(), Some(2));
    assert!(wrong.stderr.starts_with(b"prlsp: error: unexpected argument"));
}
