//! How many connections are open, in all and from each address.

use std::{
    collections::HashMap,
    net::{IpAddr, Ipv6Addr},
    sync::{Arc, Mutex, MutexGuard, PoisonError},
    time::Duration,
};

use super::super::{kind::ProblemKind, limits::ConnectionLimits, problem::Problem};

/// When a client whose connection was refused may try again.
const RETRY: Duration = Duration::from_secs(2);

/// Counts the open connections and refuses those beyond the limits.
#[derive(Debug)]
pub(super) struct OpenConnections {
    limit: usize,
    limit_per_address: usize,
    counts: Mutex<Counts>,
}

#[derive(Debug, Default)]
struct Counts {
    all: usize,
    by_address: HashMap<IpAddr, usize>,
}

/// A connection that is counted until this is dropped.
#[derive(Debug)]
pub(super) struct Admitted {
    open: Arc<OpenConnections>,
    address: IpAddr,
}

/// Which limit a connection is beyond.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TooMany {
    /// That of all connections.
    InAll(usize),
    /// That of connections from one address.
    FromOneAddress(usize),
}

impl OpenConnections {
    pub(super) fn new(limits: &ConnectionLimits) -> Arc<Self> {
        let (limit, limit_per_address) = (limits.connections, limits.per_address);
        Arc::new(Self { limit, limit_per_address, counts: Mutex::default() })
    }

    /// Counts a connection from `address`.
    ///
    /// # Errors
    /// When a limit is reached; nothing is counted then.
    pub(super) fn admit(self: &Arc<Self>, address: IpAddr) -> Result<Admitted, TooMany> {
        let address = counted_as(address);
        let mut counts = self.lock();
        if counts.all >= self.limit {
            return Err(TooMany::InAll(self.limit));
        }
        let from_address = counts.by_address.entry(address).or_default();
        if *from_address >= self.limit_per_address {
            return Err(TooMany::FromOneAddress(self.limit_per_address));
        }
        *from_address += 1;
        counts.all += 1;
        Ok(Admitted { open: Arc::clone(self), address })
    }

    fn lock(&self) -> MutexGuard<'_, Counts> {
        // Nothing panics while it is held.
        self.counts.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for Admitted {
    fn drop(&mut self) {
        let mut counts = self.open.lock();
        counts.all -= 1;
        if let Some(from_address) = counts.by_address.get_mut(&self.address) {
            *from_address -= 1;
            if *from_address == 0 {
                counts.by_address.remove(&self.address);
            }
        }
    }
}

impl From<TooMany> for Problem {
    fn from(refusal: TooMany) -> Self {
        let detail = match refusal {
            TooMany::InAll(limit) => {
                format!("{limit} connections are open, as many as the service takes; --connections raises the limit")
            }
            TooMany::FromOneAddress(limit) => format!(
                "{limit} connections are open from this address, as many as the service takes from one; \
                 --connections-per-address raises the limit"
            ),
        };
        Self::new(ProblemKind::TooManyConnections, detail).with_retry_after(RETRY)
    }
}

/// The address that stands for `address`: a host has all addresses of its IPv6 network, and an IPv4 address may be
/// written as an IPv6 one.
fn counted_as(address: IpAddr) -> IpAddr {
    match address.to_canonical() {
        IpAddr::V6(address) => {
            let [a, b, c, d, ..] = address.segments();
            IpAddr::V6(Ipv6Addr::new(a, b, c, d, 0, 0, 0, 0))
        }
        address @ IpAddr::V4(_) => address,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn address(text: &str) -> IpAddr {
        text.parse().expect("an address")
    }

    #[test]
    fn connections_are_counted_in_all_and_by_address_until_they_end() {
        let limits = ConnectionLimits { connections: 3, per_address: 2, ..ConnectionLimits::default() };
        let open = OpenConnections::new(&limits);
        let (here, there) = (address("10.0.0.1"), address("10.0.0.2"));
        let first = open.admit(here).expect("room");
        let _second = open.admit(here).expect("room");
        assert_eq!(open.admit(here).expect_err("two are open"), TooMany::FromOneAddress(2));
        let _third = open.admit(there).expect("room");
        assert_eq!(open.admit(there).expect_err("three are open"), TooMany::InAll(3));
        drop(first);
        let _fourth = open.admit(here).expect("room again");
    }

    #[test]
    fn addresses_without_connections_take_no_memory() {
        let open = OpenConnections::new(&ConnectionLimits::default());
        drop(open.admit(address("10.0.0.1")));
        assert!(open.lock().by_address.is_empty());
    }

    #[test]
    fn a_host_is_counted_once_however_it_writes_its_address() {
        assert_eq!(counted_as(address("::ffff:10.0.0.1")), address("10.0.0.1"));
        assert_eq!(counted_as(address("2001:db8:0:1:aaaa::1")), counted_as(address("2001:db8:0:1:bbbb::2")));
        assert_ne!(counted_as(address("2001:db8:0:1::1")), counted_as(address("2001:db8:0:2::1")));
    }
}
