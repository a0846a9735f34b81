//! Limits of connections.

use std::time::Duration;

/// Longest head of a request: request line and header fields.
pub(super) const HEAD_LIMIT_BYTES: usize = 128 * 1024;

/// File descriptors that connections leave to the rest of the process. A service without clients has 15 open, more with
/// a GPU; 16 are for connections that are being refused, 32 for what the kernel has of files, the others for the store.
const RESERVED_DESCRIPTORS: u64 = 112;

/// Fewest connections, however few descriptors there are.
const FEWEST_CONNECTIONS: usize = 4;

/// The limits of connections. The defaults fit one machine and a team.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ConnectionLimits {
    /// Connections that may be open at the same time.
    pub connections: usize,
    /// Those of them that may come from one address. An IPv6 network of 64 bits counts as one address.
    pub per_address: usize,
    /// How long the service waits for a client: for the complete head of a request, from the start of the connection or
    /// the end of its last answer; for the body; and until the client reads more of an answer. It limits slow and idle
    /// connections alike. A stream that has nothing to send is not limited.
    pub client: Duration,
    /// How long open answers may take once the service is told to stop.
    pub drain: Duration,
}

impl Default for ConnectionLimits {
    fn default() -> Self {
        Self { connections: 1024, per_address: 512, client: Duration::from_secs(30), drain: Duration::from_secs(10) }
    }
}

impl ConnectionLimits {
    /// The same with at most as many connections as a process with `descriptors` file descriptors can hold open while
    /// the store still gets those that it needs.
    #[must_use]
    pub fn within(self, descriptors: u64) -> Self {
        let left = usize::try_from(descriptors.saturating_sub(RESERVED_DESCRIPTORS)).unwrap_or(usize::MAX);
        let connections = self.connections.min(left.max(FEWEST_CONNECTIONS));
        Self { connections, per_address: self.per_address.min(connections), ..self }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn connections_leave_descriptors_to_the_store() {
        let within = |descriptors| ConnectionLimits::default().within(descriptors);
        assert_eq!(within(1 << 20), ConnectionLimits::default());
        assert_eq!((within(160).connections, within(160).per_address), (48, 48));
        assert_eq!(within(0).connections, FEWEST_CONNECTIONS);
    }
}
