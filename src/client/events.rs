//! Reading a stream of Server-Sent Events [HTML standard, section 9.2].

use std::io::{self, BufRead, Read as _};

/// The longest event that is read, and the longest line. A job's document takes about one kilobyte.
const EVENT_LIMIT_BYTES: u64 = 1 << 20;

/// One event.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub(super) struct Event {
    /// Position in the stream, for `Last-Event-ID`.
    pub(super) id: Option<String>,
    /// The `data` lines, joined by newlines.
    pub(super) data: String,
}

/// The events in `stream`, until it ends.
pub(super) fn events(mut stream: impl BufRead) -> impl Iterator<Item = io::Result<Event>> {
    std::iter::from_fn(move || next(&mut stream).transpose())
}

/// The next event, or `None` at the end. An incomplete event at the end is dropped, as the standard demands.
fn next(stream: &mut impl BufRead) -> io::Result<Option<Event>> {
    let mut event = Event::default();
    let mut has_data = false;
    let mut line = String::new();
    loop {
        line.clear();
        stream.by_ref().take(EVENT_LIMIT_BYTES).read_line(&mut line)?;
        let Some(content) = line.strip_suffix('\n') else {
            return if line.len() as u64 == EVENT_LIMIT_BYTES { Err(too_long()) } else { Ok(None) };
        };
        let content = content.strip_suffix('\r').unwrap_or(content);
        if content.is_empty() {
            if has_data {
                return Ok(Some(event));
            }
            continue;
        }
        let (field, value) = content.split_once(':').unwrap_or((content, ""));
        let value = value.strip_prefix(' ').unwrap_or(value);
        match field {
            "id" => event.id = Some(value.to_owned()),
            "data" => {
                if has_data {
                    event.data.push('\n');
                }
                event.data.push_str(value);
                has_data = true;
                if event.data.len() as u64 > EVENT_LIMIT_BYTES {
                    return Err(too_long());
                }
            }
            // Comments have an empty name. Event names and retry times are not needed.
            _ => {}
        }
    }
}

fn too_long() -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, format!("an event is longer than {EVENT_LIMIT_BYTES} bytes"))
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(text: &str) -> Vec<Event> {
        events(text.as_bytes()).collect::<io::Result<_>>().expect("text in memory")
    }

    fn event(id: Option<&str>, data: &str) -> Event {
        Event { id: id.map(str::to_owned), data: data.to_owned() }
    }

    #[test]
    fn events_come_between_comments() {
        let text =
            ": heartbeat\n\nevent: state\nid: 3\ndata: {\"a\":1}\n\n: heartbeat\n\nid:4\r\ndata:x\r\ndata: y\r\n\r\n";
        assert_eq!(read(text), [event(Some("3"), "{\"a\":1}"), event(Some("4"), "x\ny")]);
    }

    #[test]
    fn an_incomplete_event_is_dropped() {
        assert_eq!(read("data: x\n\ndata: y\n"), [event(None, "x")]);
        assert_eq!(read("data: x"), []);
    }

    #[test]
    fn an_endless_line_or_event_is_an_error() {
        for text in ["x".repeat(1 << 21), "data: x\n".repeat(1 << 20)] {
            let read: io::Result<Vec<_>> = events(text.as_bytes()).take(1).collect();
            assert!(read.is_err());
        }
    }
}
