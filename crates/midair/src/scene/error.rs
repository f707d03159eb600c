//! What is wrong with a scene file: where, and what to do.

use std::collections::BTreeMap;
use std::ops::Range;
use std::sync::Arc;
use thiserror::Error;

/// One thing that is wrong with a scene, with its place in the file and a remedy.
///
/// `Display` gives one line, `file:line:column: what is wrong`; with the [`help`](Self::help), the file's [`text`](Self::text) and the
/// [`span`](Self::span) to blame a program can show the line as well. Further faults of the same file are in [`SceneError::others`].
#[derive(Debug, Clone, Error)]
#[error("{place}: {message}")]
pub struct SceneError {
    /// `file:line:column`, both counted from 1; the file alone when no line is to blame.
    pub place: String,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub help: String,
    file: Arc<Named>,
    /// The bytes to blame.
    span: Option<Range<usize>>,
    /// What else is wrong with the same file.
    pub others: Box<[SceneError]>,
}

impl SceneError {
    /// The bytes of the file that are to blame.
    pub fn span(&self) -> Option<Range<usize>> {
        self.span.clone()
    }

    /// The file's text.
    pub fn text(&self) -> &str {
        &self.file.text
    }

    /// The file's name, and the line to blame, from 1.
    pub fn file_and_line(&self) -> (&str, Option<usize>) {
        let line = self.span.as_ref().map(|span| {
            let before = &self.text().as_bytes()[..span.start];
            before.iter().filter(|&&byte| byte == b'\n').count() + 1
        });
        (&self.file.name, line)
    }

    /// Several faults as one: the first in the file, the rest as its `others`.
    pub(super) fn gathered(mut faults: Vec<Self>) -> Option<Self> {
        // Without this bound a hostile file of a million unknown keys costs gigabytes.
        const SHOWN: usize = 16;
        faults.sort_by_key(|f| f.span.as_ref().map_or(0, |s| s.start));
        faults.truncate(SHOWN);
        let mut faults = faults.into_iter();
        let mut first = faults.next()?;
        first.others = faults.collect();
        Some(first)
    }
}

/// A file's name as it was given, and its text.
#[derive(Debug)]
struct Named {
    name: String,
    text: String,
}

/// A scene file's text, and where each of its keys stands.
#[derive(Debug, Clone)]
pub struct SceneText {
    file: Arc<Named>,
    spans: BTreeMap<String, Range<usize>>,
}

impl SceneText {
    pub(super) fn new(name: &str, text: &str) -> Self {
        let file = Named { name: name.to_owned(), text: text.to_owned() };
        Self { file: Arc::new(file), spans: BTreeMap::new() }
    }

    pub(super) fn record(&mut self, key: String, span: Range<usize>) {
        self.spans.insert(key, span);
    }

    /// The file's name as it was given.
    pub fn name(&self) -> &str {
        &self.file.name
    }

    /// The text itself.
    pub fn text(&self) -> &str {
        &self.file.text
    }

    /// Whether the file itself has this key, such as `plate.rotation`.
    pub fn has(&self, key: &str) -> bool {
        self.spans.contains_key(key)
    }

    /// The key that a range of bytes belongs to: the innermost one around it.
    pub(super) fn key_at(&self, span: &Range<usize>) -> Option<&str> {
        let around = self.spans.iter().filter(|(_, s)| s.start <= span.start && span.end <= s.end);
        around.min_by_key(|(_, s)| s.len()).map(|(key, _)| &key[..])
    }

    /// An error at a key such as `plate.rotation` or `element[0].shape.radius`; at the nearest
    /// enclosing one where the file leaves that key out.
    pub fn error_at(
        &self,
        key: &str,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        let mut key = key;
        loop {
            if let Some(span) = self.spans.get(key) {
                return self.error(Some(span.clone()), message, help);
            }
            match key.rfind(['.', '[']) {
                Some(end) => key = &key[..end],
                None => return self.error(None, message, help),
            }
        }
    }

    /// An error at a range of bytes, or of the file as a whole.
    pub(super) fn error(
        &self,
        span: Option<Range<usize>>,
        message: impl Into<String>,
        help: impl Into<String>,
    ) -> SceneError {
        let text = self.text();
        let span = span.map(|s| {
            let start = floor_char_boundary(text, s.start);
            start..floor_char_boundary(text, s.end).max(start)
        });
        let place = match &span {
            Some(span) => {
                let before = &text[..span.start];
                let line = before.bytes().filter(|&b| b == b'\n').count() + 1;
                let column = before.rsplit('\n').next().map_or(0, |l| l.chars().count()) + 1;
                format!("{}:{line}:{column}", self.name())
            }
            None => self.name().to_owned(),
        };
        SceneError {
            place,
            message: message.into(),
            help: help.into(),
            file: Arc::clone(&self.file),
            span,
            others: Box::default(),
        }
    }
}

fn floor_char_boundary(text: &str, at: usize) -> usize {
    let mut at = at.min(text.len());
    while !text.is_char_boundary(at) {
        at -= 1;
    }
    at
}
