//! A stored file as it goes out: whole or a range of it, a part at a time.

use std::ops::Range;

use axum::body::Body;
use axum::http::{HeaderMap, StatusCode, header};
use axum::response::{IntoResponse, Response};
use tokio::sync::mpsc::channel;
use tokio_stream::wrappers::ReceiverStream;

use crate::store::{FileEntry, Origin, PART, Store};

/// Whose file it is, and what is known of it.
pub struct Stored {
    pub store: Store,
    pub job: String,
    /// Whether it came with the job or of it.
    pub origin: Origin,
    pub entry: FileEntry,
    pub first: Vec<u8>,
}

/// What of a file is asked for.
#[derive(Debug, Clone, PartialEq, Eq)]
enum Asked {
    All,
    Part(Range<i64>),
    Nothing,
    Beyond,
}

impl Stored {
    /// Never another for the same file: neither inputs nor results of a job change.
    fn tag(&self) -> String {
        let name = perilife_base::input::sha256(self.entry.name.as_bytes());
        format!("\"{}-{}-{}\"", self.job, self.entry.bytes, &name[..12])
    }

    /// The answer to a request with these headers.
    pub fn answer(self, headers: &HeaderMap) -> Response {
        let (tag, bytes) = (self.tag(), self.entry.bytes);
        let head = [(header::ETAG, tag.clone()), (header::ACCEPT_RANGES, "bytes".to_owned())];
        match asked(headers, &tag, bytes) {
            Asked::Nothing => (StatusCode::NOT_MODIFIED, head).into_response(),
            Asked::Beyond => {
                let range = [(header::CONTENT_RANGE, format!("bytes */{bytes}"))];
                (StatusCode::RANGE_NOT_SATISFIABLE, head, range).into_response()
            }
            Asked::All => (head, [(header::CONTENT_LENGTH, bytes)], self.body(0..bytes)).into_response(),
            Asked::Part(span) => {
                let range = format!("bytes {}-{}/{bytes}", span.start, span.end - 1);
                let sizes = [(header::CONTENT_RANGE, range), (header::CONTENT_LENGTH, (span.end - span.start).to_string())];
                (StatusCode::PARTIAL_CONTENT, head, sizes, self.body(span)).into_response()
            }
        }
    }

    /// The bytes of a span: no part is read before its reader has taken the last but one.
    fn body(self, span: Range<i64>) -> Body {
        let Stored { store, job, origin, entry, mut first } = self;
        if first.len() as i64 == entry.bytes {
            return Body::from(first.drain(span.start as usize..span.end as usize).collect::<Vec<u8>>());
        }
        let (parts, reader) = channel(1);
        let part_bytes = PART as i64;
        tokio::spawn(async move {
            let mut number = span.start / part_bytes;
            loop {
                let part = match number {
                    0 => Ok(Some(std::mem::take(&mut first))),
                    number => store.file_part(&job, origin, &entry.name, number).await,
                };
                // Deleted meanwhile: an error, since a packed answer does not show that something is missing.
                let part = part.and_then(|part| part.ok_or(sqlx::Error::RowNotFound));
                let begin = number * part_bytes;
                let next = part.map(|mut part| {
                    let end = (span.end - begin).clamp(0, part.len() as i64) as usize;
                    part.truncate(end);
                    part.split_off(((span.start - begin).max(0) as usize).min(end))
                });
                let is_last = next.is_err() || begin + part_bytes >= span.end;
                // Who went away needs no more.
                if parts.send(next).await.is_err() || is_last {
                    return;
                }
                number += 1;
            }
        });
        Body::from_stream(ReceiverStream::new(reader))
    }
}

/// What the headers ask of a file with this tag and size. Of several ranges none is taken: all of the file is an answer to that.
fn asked(headers: &HeaderMap, tag: &str, bytes: i64) -> Asked {
    let text = |name| headers.get(name).and_then(|value| value.to_str().ok());
    let names_it =
        |list: &str| list.split(',').map(|one| one.trim().trim_start_matches("W/")).any(|one| one == tag || one == "*");
    if text(header::IF_NONE_MATCH).is_some_and(names_it) {
        return Asked::Nothing;
    }
    // The rest of something else is of no use.
    if text(header::IF_RANGE).is_some_and(|one| one.trim() != tag) {
        return Asked::All;
    }
    let Some((from, to)) = text(header::RANGE).and_then(|range| range.trim().strip_prefix("bytes=")?.split_once('-')) else {
        return Asked::All;
    };
    let number = |text: &str| text.trim().parse::<i64>().ok().filter(|number| *number >= 0);
    let span = match (number(from), number(to)) {
        (Some(from), _) if to.trim().is_empty() => from..bytes,
        (Some(from), Some(to)) if from <= to => from..bytes.min(to.saturating_add(1)),
        (None, Some(last)) if from.trim().is_empty() => (bytes - last).max(0)..bytes,
        _ => return Asked::All,
    };
    if span.start < span.end { Asked::Part(span) } else { Asked::Beyond }
}
