//! Messages in, messages out: which texts are open, and what is asked about them.

use std::collections::{BTreeMap, BTreeSet};

use compile::layout;
use compile::{Diagnostic, Severity};
use lsp_server::{Connection, ErrorCode, Message, Notification, Request, RequestId, Response};
use lsp_types::notification::{
    DidChangeTextDocument, DidCloseTextDocument, DidOpenTextDocument, DidSaveTextDocument, Exit,
    Notification as _, PublishDiagnostics,
};
use lsp_types::request::{
    Completion, DocumentSymbolRequest, Formatting, GotoDefinition, HoverRequest, References,
    Request as _, Shutdown,
};
use lsp_types::{
    CompletionOptions, CompletionResponse, DiagnosticRelatedInformation, DiagnosticSeverity,
    DidChangeTextDocumentParams, DidCloseTextDocumentParams, DidOpenTextDocumentParams,
    DocumentSymbolResponse, GotoDefinitionResponse, HoverProviderCapability, InitializeParams,
    Location, OneOf, Position, PositionEncodingKind, PublishDiagnosticsParams, Range,
    ReferenceParams, ServerCapabilities, TextDocumentPositionParams, TextDocumentSyncCapability,
    TextDocumentSyncKind, TextEdit, Uri,
};
use serde_json::Value;

use crate::position::{Encoding, Lines};
use crate::scene_text::{Analysis, OpenText, uri_of};
use crate::{completion, hover, uri};

/// What a client is told.
type Findings = BTreeMap<String, (Uri, Vec<lsp_types::Diagnostic>)>;

/// Talks to one client until it says that it exits.
///
/// # Errors
///
/// A message, if the client breaks off, or says what the protocol does not have.
pub fn serve(connection: &Connection) -> Result<(), String> {
    let (id, parameters) = connection.initialize_start().map_err(|error| error.to_string())?;
    let parameters: InitializeParams = serde_json::from_value(parameters).unwrap_or_default();
    let encoding = encoding(&parameters);
    let result = serde_json::json!({
        "capabilities": capabilities(encoding),
        "serverInfo": { "name": "prlsp", "version": env!("CARGO_PKG_VERSION") },
    });
    connection.initialize_finish(id, result).map_err(|error| error.to_string())?;
    let mut server = Server {
        connection,
        encoding,
        open: BTreeMap::new(),
        published: BTreeSet::new(),
        shut_down: false,
    };
    for message in &connection.receiver {
        match message {
            Message::Request(request) => server.request(request)?,
            Message::Notification(message) if message.method == Exit::METHOD => {
                let early = "the client exits without `shutdown`".to_owned();
                return if server.shut_down { Ok(()) } else { Err(early) };
            }
            Message::Notification(message) => server.notification(message)?,
            Message::Response(_) => {}
        }
    }
    Err("the client has closed its end".to_owned())
}

/// What a column counts: bytes if the client takes them, because then nothing has to be counted twice.
fn encoding(parameters: &InitializeParams) -> Encoding {
    let general = parameters.capabilities.general.as_ref();
    let offered = general.and_then(|general| general.position_encodings.as_ref());
    let utf8 = offered.is_some_and(|offered| offered.contains(&PositionEncodingKind::UTF8));
    if utf8 { Encoding::Utf8 } else { Encoding::Utf16 }
}

fn capabilities(encoding: Encoding) -> ServerCapabilities {
    ServerCapabilities {
        position_encoding: Some(match encoding {
            Encoding::Utf8 => PositionEncodingKind::UTF8,
            Encoding::Utf16 => PositionEncodingKind::UTF16,
        }),
        text_document_sync: Some(TextDocumentSyncCapability::Kind(
            TextDocumentSyncKind::INCREMENTAL,
        )),
        completion_provider: Some(CompletionOptions::default()),
        hover_provider: Some(HoverProviderCapability::Simple(true)),
        definition_provider: Some(OneOf::Left(true)),
        references_provider: Some(OneOf::Left(true)),
        document_symbol_provider: Some(OneOf::Left(true)),
        document_formatting_provider: Some(OneOf::Left(true)),
        ..ServerCapabilities::default()
    }
}

struct Server<'a> {
    connection: &'a Connection,
    encoding: Encoding,
    /// By URI.
    open: BTreeMap<String, OpenText>,
    /// Files the client has been told something about, by URI.
    published: BTreeSet<String>,
    shut_down: bool,
}

/// The parameters of a message.
fn parameters<T: serde::de::DeserializeOwned>(value: Value) -> Result<T, String> {
    serde_json::from_value(value).map_err(|error| error.to_string())
}

/// An answer.
fn value(result: impl serde::Serialize) -> Result<Value, String> {
    serde_json::to_value(result).map_err(|error| error.to_string())
}

impl Server<'_> {
    fn send(&self, message: impl Into<Message>) -> Result<(), String> {
        self.connection.sender.send(message.into()).map_err(|error| error.to_string())
    }

    fn request(&mut self, request: Request) -> Result<(), String> {
        let Request { id, method, params } = request;
        if self.shut_down {
            return self.refuse(id, ErrorCode::InvalidRequest, "the server is shut down");
        }
        let answer = match method.as_str() {
            Shutdown::METHOD => {
                self.shut_down = true;
                Ok(Value::Null)
            }
            Completion::METHOD => self.completion(params),
            HoverRequest::METHOD => self.hover(params),
            GotoDefinition::METHOD => self.definition(params),
            References::METHOD => self.references(params),
            DocumentSymbolRequest::METHOD => self.outline(params),
            Formatting::METHOD => self.formatting(params),
            _ => {
                let message = format!("unknown request `{method}`");
                return self.refuse(id, ErrorCode::MethodNotFound, &message);
            }
        };
        match answer {
            Ok(answer) => self.send(Response::new_ok(id, answer)),
            Err(message) => self.refuse(id, ErrorCode::InvalidParams, &message),
        }
    }

    fn refuse(&self, id: RequestId, code: ErrorCode, message: &str) -> Result<(), String> {
        self.send(Response::new_err(id, code as i32, message.to_owned()))
    }

    /// A notification that cannot be read is left alone: nobody waits for an answer.
    fn notification(&mut self, message: Notification) -> Result<(), String> {
        let Notification { method, params } = message;
        match method.as_str() {
            DidOpenTextDocument::METHOD => {
                let Ok(opened) = parameters::<DidOpenTextDocumentParams>(params) else {
                    return Ok(());
                };
                let document = opened.text_document;
                let key = document.uri.to_string();
                let path = uri::path(&document.uri);
                let (uri, version, text) = (document.uri, document.version, document.text);
                self.open.insert(key, OpenText { uri, path, version, text });
            }
            DidChangeTextDocument::METHOD => {
                let Ok(changed) = parameters::<DidChangeTextDocumentParams>(params) else {
                    return Ok(());
                };
                let encoding = self.encoding;
                let key = changed.text_document.uri.to_string();
                let Some(text) = self.open.get_mut(&key) else { return Ok(()) };
                text.change(changed.content_changes, encoding);
                text.version = changed.text_document.version;
            }
            DidCloseTextDocument::METHOD => {
                let Ok(closed) = parameters::<DidCloseTextDocumentParams>(params) else {
                    return Ok(());
                };
                self.open.remove(&closed.text_document.uri.to_string());
            }
            // What it includes may have changed on disk.
            DidSaveTextDocument::METHOD => {}
            _ => return Ok(()),
        }
        self.publish()
    }

    /// Tells the client what there is to say of all texts that are open, and that there is no more to say of others.
    fn publish(&mut self) -> Result<(), String> {
        let mut findings = Findings::new();
        for text in self.open.values() {
            let Some(analysis) = text.analysis(&self.open) else { continue };
            findings.entry(text.uri.to_string()).or_insert_with(|| (text.uri.clone(), Vec::new()));
            for diagnostic in &analysis.diagnostics {
                self.collect(text, &analysis, diagnostic, &mut findings);
            }
        }
        let told: BTreeSet<String> = findings.keys().cloned().collect();
        let silent = self.published.difference(&told).filter_map(|uri| uri.parse().ok());
        let silent = silent.map(|uri: Uri| (uri.to_string(), (uri, Vec::new())));
        let all: Findings = findings.into_iter().chain(silent).collect();
        for (key, (uri, diagnostics)) in all {
            let version = self.open.get(&key).map(|text| text.version);
            let parameters = PublishDiagnosticsParams { uri, diagnostics, version };
            let parameters = value(parameters)?;
            self.send(Notification::new(PublishDiagnostics::METHOD.to_owned(), parameters))?;
        }
        self.published = told;
        Ok(())
    }

    /// Adds a finding to those of its file. A file that is open has its own say.
    fn collect(
        &self,
        text: &OpenText,
        analysis: &Analysis,
        diagnostic: &Diagnostic,
        findings: &mut Findings,
    ) {
        let place = diagnostic.span.and_then(|span| analysis.sources.within(span));
        let (uri, range) = match place {
            Some((path, source, bytes)) => {
                let range = Lines::new(source, self.encoding).range(bytes);
                let own = path == text.path;
                let uri = if own { Some(text.uri.clone()) } else { uri_of(path, &self.open) };
                match uri {
                    Some(uri) if own || !self.open.contains_key(&uri.to_string()) => (uri, range),
                    _ => return,
                }
            }
            None => (text.uri.clone(), Range::default()),
        };
        let related: Vec<DiagnosticRelatedInformation> = diagnostic
            .notes
            .iter()
            .filter_map(|note| {
                let location = analysis.location(note.span, &self.open, self.encoding)?;
                Some(DiagnosticRelatedInformation { location, message: note.message.clone() })
            })
            .collect();
        let hint = diagnostic.hint.as_ref().map(|hint| format!("\n{hint}")).unwrap_or_default();
        let finding = lsp_types::Diagnostic {
            range,
            severity: Some(match diagnostic.severity {
                Severity::Error => DiagnosticSeverity::ERROR,
                Severity::Warning => DiagnosticSeverity::WARNING,
            }),
            source: Some("prcomp".to_owned()),
            message: format!("{}{hint}", diagnostic.message),
            related_information: (!related.is_empty()).then_some(related),
            ..lsp_types::Diagnostic::default()
        };
        let (_, list) = findings.entry(uri.to_string()).or_insert_with(|| (uri, Vec::new()));
        // Two texts may include the same file.
        if !list.contains(&finding) {
            list.push(finding);
        }
    }

    fn text(&self, uri: &Uri) -> Result<&OpenText, String> {
        let text = self.open.get(&uri.to_string());
        text.ok_or_else(|| format!("`{}` is not open", uri.as_str()))
    }

    /// The text that is asked about, what the compiler makes of it, and the byte.
    fn place(&self, params: &Value) -> Result<(&OpenText, Analysis, usize), String> {
        let place: TextDocumentPositionParams = parameters(params.clone())?;
        let text = self.text(&place.text_document.uri)?;
        let analysis = text.analysis(&self.open).ok_or("the text is too long")?;
        let offset = Lines::new(&text.text, self.encoding).offset(place.position);
        Ok((text, analysis, offset))
    }

    fn completion(&self, params: Value) -> Result<Value, String> {
        let (text, analysis, offset) = self.place(&params)?;
        value(CompletionResponse::Array(completion::at(text, &analysis, offset)))
    }

    fn hover(&self, params: Value) -> Result<Value, String> {
        let (text, analysis, offset) = self.place(&params)?;
        value(hover::at(text, &analysis, offset, self.encoding))
    }

    fn definition(&self, params: Value) -> Result<Value, String> {
        let (text, analysis, offset) = self.place(&params)?;
        let named = analysis.name_at(offset).map(|(definition, _)| definition.span);
        let location = match named {
            Some(span) => analysis.location(span, &self.open, self.encoding),
            None => self.included(text, offset),
        };
        value(location.map(GotoDefinitionResponse::Scalar))
    }

    /// The file that the text at a byte includes.
    fn included(&self, text: &OpenText, offset: usize) -> Option<Location> {
        let (bytes, piece) = text.word_at(offset)?;
        if piece != compile::vocabulary::Piece::Text {
            return None;
        }
        let name = text.slice(&bytes).trim_matches('"');
        let path = text.path.parent()?.join(name);
        if !path.is_file() && !self.open.values().any(|open| open.path == path) {
            return None;
        }
        Some(Location::new(uri_of(&path, &self.open)?, Range::default()))
    }

    fn references(&self, params: Value) -> Result<Value, String> {
        let (_, analysis, offset) = self.place(&params)?;
        let asked: ReferenceParams = parameters(params)?;
        let places = analysis.places(offset, asked.context.include_declaration);
        let locations: Vec<Location> = places
            .into_iter()
            .filter_map(|span| analysis.location(span, &self.open, self.encoding))
            .collect();
        value(locations)
    }

    fn outline(&self, params: Value) -> Result<Value, String> {
        let asked: lsp_types::DocumentSymbolParams = parameters(params)?;
        let text = self.text(&asked.text_document.uri)?;
        let analysis = text.analysis(&self.open).ok_or("the text is too long")?;
        value(DocumentSymbolResponse::Nested(analysis.outline(text, self.encoding)))
    }

    /// One edit of the whole text; none if nothing changes, or while a statement is not whole.
    fn formatting(&self, params: Value) -> Result<Value, String> {
        let asked: lsp_types::DocumentFormattingParams = parameters(params)?;
        let text = self.text(&asked.text_document.uri)?;
        let mut sources = text.sources().ok_or("the text is too long")?;
        let whole = layout::mistakes(&mut sources).is_empty();
        let laid = if whole { layout::laid_out(&sources).ok() } else { None };
        let laid = laid.filter(|laid| *laid != text.text);
        let end = Lines::new(&text.text, self.encoding).position(text.text.len());
        let edit = |laid| TextEdit::new(Range::new(Position::default(), end), laid);
        value(laid.map(|laid| vec![edit(laid)]).unwrap_or_default())
    }
}
