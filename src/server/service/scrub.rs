//! The scrub: every blob is read from the disk and hashed now and then, whether a client asks for it or not.
//!
//! Invariant: it costs no more than [`BYTES_PER_SECOND`] of the disk and of a core, and never delays a stop.

use std::{
    thread,
    time::{Duration, Instant},
};

use super::{ServiceError, state::ServiceState, tables::Tables};

/// How fast blobs are read: 14 GiB an hour, hashed in some hundredths of a core at most.
const BYTES_PER_SECOND: f64 = (4 << 20) as f64;

/// When the first pass begins after a start.
const FIRST: Duration = Duration::from_secs(60);

/// From the beginning of a pass to that of the next, unless the pass takes longer.
const INTERVAL: Duration = Duration::from_secs(3600);

impl ServiceState {
    /// Scrubs until the service is stopped.
    pub(super) fn scrub(&self) {
        let mut next = Instant::now() + FIRST;
        while self.wait_until(next) {
            let begun = Instant::now();
            let (mut read, mut found) = (0, 0);
            let outcome = self.tables.scrub(
                &mut |bytes| {
                    read += bytes;
                    self.wait_until(begun + Duration::from_secs_f64(read as f64 / BYTES_PER_SECOND))
                },
                &mut || found += 1,
            );
            match outcome {
                Ok(()) => tracing::debug!("scrubbed {read} bytes in {:?}: {found} damaged files", begun.elapsed()),
                Err(error) => tracing::warn!(%error, "the scrub was interrupted; it begins anew with its next pass"),
            }
            next = Instant::now().max(begun + INTERVAL);
        }
    }

    /// Waits; false as soon as the service is stopping.
    pub(super) fn wait_until(&self, then: Instant) -> bool {
        while !self.is_stopping() {
            let left = then.saturating_duration_since(Instant::now());
            if left.is_zero() {
                return true;
            }
            // `Service::stop` unparks it.
            thread::park_timeout(left);
        }
        false
    }
}

impl Tables {
    /// Rechecks every blob that is listed now. A damaged one is moved to quarantine as if a client had asked for it, and
    /// told to `found`. `go_on` is told the bytes of each part that was read and ends the pass when it says no.
    ///
    /// # Errors
    /// When the store fails.
    pub(super) fn scrub(
        &self,
        go_on: &mut dyn FnMut(usize) -> bool,
        found: &mut dyn FnMut(),
    ) -> Result<(), ServiceError> {
        for blob in self.store.blobs.list()? {
            let mut goes_on = true;
            let checked = self.store.blobs.recheck(blob.digest, &mut |bytes| {
                goes_on = go_on(bytes);
                goes_on
            });
            match self.told(blob.digest, checked.map(Some)) {
                Ok(_) => {}
                Err(ServiceError::Corrupt { .. }) => found(),
                Err(error) => return Err(error),
            }
            if !goes_on {
                break;
            }
        }
        Ok(())
    }
}
