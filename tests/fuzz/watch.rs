//! A watchdog that ends the run if a reader does not return.

use std::{
    io::Write as _,
    process,
    sync::{Arc, Mutex, Weak},
    thread,
    time::{Duration, Instant},
};

use super::corpus;

/// The longest wait for one input. All targets share the processor, and small machines have few cores.
const MOST_WAIT: Duration = Duration::from_secs(180);

/// The current input, and the time when its reading started.
type Reading = Mutex<Option<(Instant, Vec<u8>)>>;

/// Checks every second how long a target has been reading.
pub(crate) struct Watch(Arc<Reading>);

impl Watch {
    pub(crate) fn new(name: &str) -> Self {
        let reading = Arc::new(Reading::default());
        let (watched, name) = (Arc::downgrade(&reading), name.to_owned());
        thread::spawn(move || watch(&watched, &name));
        Self(reading)
    }

    /// Reads `input` with `read`.
    pub(crate) fn over<T>(&self, input: &[u8], read: impl FnOnce() -> T) -> T {
        *self.0.lock().expect("no panic") = Some((Instant::now(), input.to_vec()));
        let answer = read();
        *self.0.lock().expect("no panic") = None;
        answer
    }
}

/// Writes an input that takes too long to the corpus, and ends the process, because a thread cannot be ended.
fn watch(watched: &Weak<Reading>, name: &str) {
    while let Some(reading) = watched.upgrade() {
        if let Some((since, input)) = &*reading.lock().expect("no panic")
            && since.elapsed() > MOST_WAIT
        {
            let line = corpus::write(name, input);
            // The output of a print macro would be captured until the test ends.
            let message = format!("{name}: no answer after {MOST_WAIT:?}; the input is now {line}\n");
            let _ = std::io::stderr().write_all(message.as_bytes());
            process::exit(1);
        }
        drop(reading);
        thread::sleep(Duration::from_secs(1));
    }
}
