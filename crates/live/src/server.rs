//! The server: who is answered, and with what.

use std::error::Error;
use std::fmt::{self, Write as _};
use std::io::{Cursor, Read, Write};
use std::net::{Ipv4Addr, SocketAddrV4, TcpListener};
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::thread;
use std::time::Duration;

use rustix::net::sockopt::set_tcp_nodelay;
use serde_json::json;
use tiny_http::{Header, Method, Request, Response};

use crate::board::Board;
use crate::model::{Model, Pick};
use crate::request;

/// Threads that answer: while two are at work on pictures from elsewhere, clicks are answered.
const ANSWERING: usize = 4;
/// Pages that may listen at once.
const LISTENERS: usize = 16;
/// The longest request that says anything, in bytes.
const BODY: usize = 4096;
/// A page that hears nothing so long is told that the server is still there.
const SILENCE: Duration = Duration::from_secs(10);

const PAGE: &str = include_str!("page/index.html");
const STYLE: &str = include_str!("page/page.css");
const SCRIPT: &str = include_str!("page/page.js");

/// Nothing but what is served here is loaded, shown in, or sent to.
const POLICY: &str = "default-src 'none'; script-src 'self'; style-src 'self'; connect-src 'self'; \
                      img-src 'self' data:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'";

/// A page that is served as long as the program runs.
#[derive(Debug)]
pub struct Server {
    address: SocketAddrV4,
    token: String,
}

/// Why a page cannot be served.
#[derive(Debug)]
#[non_exhaustive]
pub enum StartError {
    /// There is no port to be had on 127.0.0.1.
    Port(std::io::Error),
    /// The system has no random numbers.
    Token(getrandom::Error),
    /// The server or its threads could not be made.
    Threads(Box<dyn Error + Send + Sync>),
}

/// What all threads know.
struct Desk {
    host: String,
    token: String,
    board: Arc<Board>,
    model: Arc<dyn Model>,
    listeners: AtomicUsize,
}

type Answer = Response<Cursor<Vec<u8>>>;

impl Server {
    /// Serves what is on a board, and asks a model, from threads of its own. The port is a free one on 127.0.0.1.
    ///
    /// # Errors
    ///
    /// If there is no port, no random number or no thread to be had.
    pub fn start(board: Arc<Board>, model: Arc<dyn Model>) -> Result<Self, StartError> {
        let listener = TcpListener::bind((Ipv4Addr::LOCALHOST, 0)).map_err(StartError::Port)?;
        // Connections get it from the listener. Without it the end of each picture waits for the page to confirm what it
        // has, which it puts off for 40 ms.
        set_tcp_nodelay(&listener, true).map_err(|error| StartError::Port(error.into()))?;
        let port = listener.local_addr().map_err(StartError::Port)?.port();
        let address = SocketAddrV4::new(Ipv4Addr::LOCALHOST, port);
        let token = token().map_err(StartError::Token)?;
        let server =
            tiny_http::Server::from_listener(listener, None).map_err(StartError::Threads)?;
        let (server, host) = (Arc::new(server), address.to_string());
        let listeners = AtomicUsize::new(0);
        let desk = Arc::new(Desk { host, token: token.clone(), board, model, listeners });
        for _ in 0..ANSWERING {
            let (server, desk) = (Arc::clone(&server), Arc::clone(&desk));
            let answering = move || {
                while let Ok(request) = server.recv() {
                    desk.answer(request);
                }
            };
            thread::Builder::new()
                .name("page".into())
                .spawn(answering)
                .map_err(|error| StartError::Threads(error.into()))?;
        }
        Ok(Self { address, token })
    }

    /// Where the page is, with the token.
    #[must_use]
    pub fn url(&self) -> String {
        format!("http://{}/{}/", self.address, self.token)
    }

    /// The port alone.
    #[must_use]
    pub fn address(&self) -> SocketAddrV4 {
        self.address
    }
}

/// 128 random bits in hexadecimal digits.
fn token() -> Result<String, getrandom::Error> {
    let mut bytes = [0; 16];
    getrandom::fill(&mut bytes)?;
    Ok(bytes.iter().fold(String::new(), |mut text, byte| {
        write!(text, "{byte:02x}").expect("a string");
        text
    }))
}

/// Whether two texts are the same, in a time that does not tell where they differ.
fn is_same(a: &str, b: &str) -> bool {
    a.len() == b.len() && a.bytes().zip(b.bytes()).fold(0, |differ, (a, b)| differ | (a ^ b)) == 0
}

impl Desk {
    /// Answers a request. One who is gone before the answer is no matter.
    fn answer(self: &Arc<Self>, mut request: Request) {
        let path = match self.admitted(&request) {
            Ok(path) => path,
            Err(status) => {
                request.respond(text(status, "not here")).ok();
                return;
            }
        };
        let (path, query) = path.split_once('?').unwrap_or((&path, ""));
        let answer = match (request.method(), path) {
            (Method::Get, "") => typed(PAGE, "text/html; charset=utf-8"),
            (Method::Get, "page.css") => typed(STYLE, "text/css; charset=utf-8"),
            (Method::Get, "page.js") => typed(SCRIPT, "text/javascript; charset=utf-8"),
            (Method::Get, "events") => return self.listen(request),
            (Method::Get, "picture") => self.picture(),
            (Method::Get, "pixel") => self.pixel(query),
            (Method::Post, "view") => self.view(&mut request),
            (Method::Post, "reset") => {
                self.model.settle(None);
                text(204, "")
            }
            (Method::Get | Method::Post, _) => text(404, "not here"),
            _ => text(405, "expected GET or POST"),
        };
        request.respond(answer).ok();
    }

    /// The path behind the token, if whoever asks has it, and means this host.
    fn admitted(&self, request: &Request) -> Result<String, u16> {
        let field = |name: &'static str| {
            let mut fields = request.headers().iter().filter(|header| header.field.equiv(name));
            let value = fields.next().map(|header| header.value.as_str());
            // Two would be for two readers to disagree about.
            if fields.next().is_some() { Some("") } else { value }
        };
        // A name that leads here from elsewhere would let pages of that name read the answer.
        if field("Host") != Some(self.host.as_str()) {
            return Err(403);
        }
        let origin = field("Origin");
        if origin.is_some_and(|origin| origin.strip_prefix("http://") != Some(&self.host)) {
            return Err(403);
        }
        let behind = request.url().strip_prefix('/').and_then(|path| path.split_once('/'));
        match behind {
            Some((token, path)) if is_same(token, &self.token) => Ok(path.to_owned()),
            _ => Err(404),
        }
    }

    /// Tells a page each state of the board until it is gone, from a thread of its own.
    fn listen(self: &Arc<Self>, request: Request) {
        if self.listeners.fetch_add(1, Ordering::Relaxed) >= LISTENERS {
            self.listeners.fetch_sub(1, Ordering::Relaxed);
            request.respond(text(503, "too many pages listen")).ok();
            return;
        }
        let desk = Arc::clone(self);
        let listening = move || {
            // An error means that the page is gone.
            desk.tell(&mut *request.into_writer()).ok();
            desk.listeners.fetch_sub(1, Ordering::Relaxed);
        };
        if thread::Builder::new().name("listener".into()).spawn(listening).is_err() {
            self.listeners.fetch_sub(1, Ordering::Relaxed);
        }
    }

    /// Server-sent events (HTML, section 9.2), one for each state.
    fn tell(&self, page: &mut dyn Write) -> std::io::Result<()> {
        page.write_all(
            b"HTTP/1.1 200 OK\r\nContent-Type: text/event-stream\r\nCache-Control: no-store\r\n\
              X-Content-Type-Options: nosniff\r\nConnection: close\r\n\r\n",
        )?;
        let mut seen = self.board.now();
        loop {
            write!(page, "data: {}\n\n", seen.json())?;
            page.flush()?;
            seen = loop {
                match self.board.after(seen.version, SILENCE) {
                    Some(newer) => break newer,
                    None => {
                        page.write_all(b": still here\n\n")?;
                        page.flush()?;
                    }
                }
            };
        }
    }

    /// The newest picture: pixels as they are, with its size and number beside them.
    fn picture(&self) -> Answer {
        let seen = self.board.now();
        match seen.shot {
            Some(shot) => pixels(shot.rgba.clone(), [shot.columns, shot.rows])
                .with_header(header("X-Picture", &seen.picture.to_string())),
            None => text(404, "there is no picture yet"),
        }
    }

    fn view(&self, request: &mut Request) -> Answer {
        if request.body_length().is_none_or(|length| length > BODY) {
            return text(413, "expected a short text and its length");
        }
        let mut body = Vec::new();
        if let Err(error) = request.as_reader().take(BODY as u64).read_to_end(&mut body) {
            return text(400, &error.to_string());
        }
        let (camera, settle) = match request::view(&body) {
            Ok(view) => view,
            Err(error) => return text(400, &error),
        };
        if settle {
            self.model.settle(Some(camera));
            return text(204, "");
        }
        match self.model.look(&camera) {
            Ok(look) => pixels(look.shot.rgba, [look.shot.columns, look.shot.rows])
                .with_header(header("X-Camera", &look.statement))
                .with_header(header("X-Microseconds", &look.microseconds.to_string())),
            Err(error) => text(409, &error),
        }
    }

    fn pixel(&self, query: &str) -> Answer {
        let [column, row] = match request::pixel(query) {
            Ok(pixel) => pixel,
            Err(error) => return text(400, &error),
        };
        let found = self.model.pick(column, row).map(|pick| {
            let Pick { object, name, place, depth, normal } = pick;
            let place = place.map(|place| {
                json!({ "file": place.file, "line": place.line, "column": place.column, "text": place.text })
            });
            json!({ "object": object, "name": name, "place": place, "depth": depth, "normal": normal })
        });
        typed(&json!({ "found": found }).to_string(), "application/json")
    }
}

fn header(name: &str, value: &str) -> Header {
    Header::from_bytes(name, value).expect("names and values are ASCII")
}

fn plain(body: Vec<u8>, status: u16, kind: &str) -> Answer {
    Response::from_data(body)
        .with_status_code(status)
        .with_chunked_threshold(usize::MAX)
        .with_header(header("Content-Type", kind))
        .with_header(header("Cache-Control", "no-store"))
        .with_header(header("Content-Security-Policy", POLICY))
        .with_header(header("Referrer-Policy", "no-referrer"))
        .with_header(header("X-Content-Type-Options", "nosniff"))
}

fn typed(body: &str, kind: &str) -> Answer {
    plain(body.as_bytes().to_vec(), 200, kind)
}

fn text(status: u16, body: &str) -> Answer {
    plain(body.as_bytes().to_vec(), status, "text/plain; charset=utf-8")
}

fn pixels(rgba: Vec<u8>, [columns, rows]: [u32; 2]) -> Answer {
    plain(rgba, 200, "application/octet-stream")
        .with_header(header("X-Columns", &columns.to_string()))
        .with_header(header("X-Rows", &rows.to_string()))
}

impl fmt::Debug for Desk {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Desk").field("host", &self.host).finish_non_exhaustive()
    }
}

impl fmt::Display for StartError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Port(error) => write!(f, "cannot listen on 127.0.0.1: {error}"),
            Self::Token(error) => write!(f, "no random number for the address: {error}"),
            Self::Threads(error) => write!(f, "cannot serve the page: {error}"),
        }
    }
}

impl Error for StartError {}
