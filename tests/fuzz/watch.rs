//! What ends a run in which an input is waited for without end.

use std::{
    io::Write as _,
    process,
    sync::{Arc, Mutex, Weak},
    thread,
    time::{Duration, Instant},
};

use super::corpus;

/// How long one input is waited for. All targets at once share the processor, and a small machine's is shared by many.
const MOST_WAIT: Duration = Duration::from_secs(180);

/// An input, and since when it is read.
type Reading = Mutex<Option<(Instant, Vec<u8>)>>;

/// A look at what a target reads, once a second.
pub(crate) struct Watch(Arc<Reading>);

impl Watch {
    pub(crate) fn new(name: &str) -> Self {
        let reading = Arc::new(Reading::default());
        let (watched, name) = (Arc::downgrade(&reading), name.to_owned());
        thread::spawn(move || watch(&watched, &name));
        Self(reading)
    }

    /// Reads `input` by `read`.
    pub(crate) fn over<T>(&self, input: &[u8], read: impl FnOnce() -> T) -> T {
        *self.0.lock().expect("no panic") = Some((Instant::now(), input.to_vec()));
        let answer = read();
        *self.0.lock().expect("no panic") = None;
        answer
    }
}

/// Writes an input that is read for too long into the corpus, and ends the process: a thread cannot be ended.
fn watch(watched: &Weak<Reading>, name: &str) {
    while let Some(reading) = watched.upgrade() {
        if let Some((since, input)) = &*reading.lock().expect("no panic")
            && since.elapsed() > MOST_WAIT
        {
            let line = corpus::write(name, input);
            // Not by a macro, whose words would be kept until the test ends.
            let told = format!("{name}: no answer after {MOST_WAIT:?}; the input is now {line}\n");
            let _ = std::io::stderr().write_all(told.as_bytes());
            process::exit(1);
        }
        drop(reading);
        thread::sleep(Duration::from_secs(1));
    }
}
