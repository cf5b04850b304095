//! Messages over standard input and output, each behind a header that says how many bytes it has.

use std::io::{self, BufRead, Read};
use std::sync::{Arc, OnceLock};
use std::thread;

use lsp_server::{Connection, Message};

use crate::server;

/// Bytes of a line of a header, at most.
const HEADER: u64 = 1 << 12;

/// Bytes of a message, at most: a text of 256 MiB of which every byte is escaped.
const MESSAGE: u64 = 6 << 28;

/// Serves the client at standard input and output until it says that it exits.
///
/// # Errors
///
/// A message, if the client breaks off, or sends or says what the protocol does not have.
pub fn serve() -> Result<(), String> {
    let (ours, theirs) = Connection::memory();
    let failure = Arc::new(OnceLock::new());
    let (to_server, why) = (theirs.sender, Arc::clone(&failure));
    // It waits for a client that has nothing more to say, so nobody waits for it.
    thread::spawn(move || {
        let mut input = io::stdin().lock();
        loop {
            match read(&mut input) {
                Ok(Some(message)) => {
                    if to_server.send(message).is_err() {
                        return;
                    }
                }
                Ok(None) => return,
                Err(error) => return why.set(error.to_string()).unwrap_or_default(),
            }
        }
    });
    let from_server = theirs.receiver;
    let writer = thread::spawn(move || {
        from_server.into_iter().try_for_each(|message| message.write(&mut io::stdout().lock()))
    });
    let served = server::serve(&ours);
    drop(ours);
    let written = match writer.join() {
        Ok(written) => written.map_err(|error| format!("cannot write to the client: {error}")),
        Err(_) => Err("cannot write to the client".to_owned()),
    };
    served.map_err(|error| failure.get().cloned().unwrap_or(error)).and(written)
}

/// The next message; nothing at the end of the input. Memory grows with what is there, whatever the header says.
fn read(input: &mut impl BufRead) -> io::Result<Option<Message>> {
    let wrong = |text: String| io::Error::new(io::ErrorKind::InvalidData, text);
    let mut length = None;
    loop {
        let mut line = String::new();
        if input.take(HEADER).read_line(&mut line)? == 0 {
            return Ok(None);
        }
        let Some(line) = line.strip_suffix("\r\n") else {
            let shown: String = line.trim_end().chars().take(40).collect();
            return Err(wrong(format!("expected a line of a header, found `{shown}`")));
        };
        let (name, value) = match line.split_once(':') {
            Some((name, value)) => (name.trim(), value.trim()),
            None if line.is_empty() => break,
            None => return Err(wrong("expected a name and `:` in a header".to_owned())),
        };
        if name.eq_ignore_ascii_case("Content-Length") {
            let number = value.parse().ok().filter(|bytes| *bytes <= MESSAGE);
            let message = format!("expected a Content-Length from 0 to {MESSAGE}");
            length = Some(number.ok_or_else(|| wrong(message))?);
        }
    }
    let length = length.ok_or_else(|| wrong("expected a Content-Length, found none".to_owned()))?;
    let mut bytes = Vec::new();
    input.take(length).read_to_end(&mut bytes)?;
    if (bytes.len() as u64) < length {
        return Err(wrong(format!("expected {length} bytes, found {}", bytes.len())));
    }
    serde_json::from_slice(&bytes)
        .map(Some)
        .map_err(|error| wrong(format!("expected a message, found other bytes: {error}")))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn refusal(input: &str) -> String {
        read(&mut input.as_bytes()).expect_err(input).to_string()
    }

    #[test]
    fn messages_follow_each_other() {
        let exit = r#"{"jsonrpc":"2.0","method":"exit"}"#;
        let text = format!(
            "content-length:{0}\r\nX: y\r\n\r\n{exit}Content-Length: {0}\r\n\r\n{exit}",
            exit.len()
        );
        let mut input = text.as_bytes();
        for _ in 0..2 {
            let message = read(&mut input).unwrap();
            assert!(matches!(message, Some(Message::Notification(n)) if n.method == "exit"));
        }
        assert!(read(&mut input).unwrap().is_none(), "the end");
    }

    #[test]
    fn what_is_no_message_is_refused() {
        assert!(refusal("Content-Length: 99999999999999\r\n\r\n{}").contains("from 0 to"), "huge");
        assert!(refusal("Content-Length: -1\r\n\r\n{}").contains("from 0 to"), "negative");
        assert!(refusal("Content-Length: 1000000000\r\n\r\n{}").contains("found 2"), "cut short");
        assert!(refusal("Content-Length: 2\r\n\r\n{}").contains("expected a message"), "empty");
        assert!(refusal("Content-Length: 1\r\n\r\n\u{ff}").contains("expected a message"), "bytes");
        assert!(refusal("hello\r\n\r\n").contains("a name and `:`"), "no header");
        assert!(refusal("\r\n{}").contains("found none"), "no length");
        assert!(refusal(&"x".repeat(100_000)).len() < 100, "a long line");
    }
}
