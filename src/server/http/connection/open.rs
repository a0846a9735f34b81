//! How many connections are open, in all and from each address.

use std::{
    collections::HashMap,
    net::{IpAddr, Ipv6Addr},
    sync::Arc,
    time::Duration,
};

use super::super::{kind::ProblemKind, limits::ConnectionLimits, problem::Problem};

/// When a client whose connection was refused may try again.
const RETRY: Duration = Duration::from_secs(2);

/// The open connections, for the task that accepts them.
#[derive(Debug)]
pub(super) struct OpenConnections {
    limit: usize,
    limit_per_address: usize,
    /// By address, the token of which each of its connections has a clone.
    tokens: HashMap<IpAddr, Token>,
}

/// A connection is counted for as long as it has this.
pub(super) type Token = Arc<()>;

/// The limit that a connection exceeds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum TooMany {
    /// That of all connections.
    InAll(usize),
    /// That of connections from one address.
    FromOneAddress(usize),
}

impl OpenConnections {
    pub(super) fn new(limits: &ConnectionLimits) -> Self {
        Self { limit: limits.connections, limit_per_address: limits.per_address, tokens: HashMap::new() }
    }

    /// Counts a connection from `address`.
    ///
    /// # Errors
    /// When a limit is reached; nothing is counted then.
    pub(super) fn admit(&mut self, address: IpAddr) -> Result<Token, TooMany> {
        self.tokens.retain(|_, token| open(token) > 0);
        if self.tokens.values().map(open).sum::<usize>() >= self.limit {
            return Err(TooMany::InAll(self.limit));
        }
        let token = self.tokens.entry(network(address)).or_default();
        if open(token) >= self.limit_per_address {
            return Err(TooMany::FromOneAddress(self.limit_per_address));
        }
        Ok(Arc::clone(token))
    }
}

/// The connections that have a clone of `token`.
fn open(token: &Token) -> usize {
    Arc::strong_count(token) - 1
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

/// The address that stands for `address` where clients are counted: a host has all addresses of its IPv6 network, and an IPv4 address may be
/// written as an IPv6 one.
pub(in crate::http) fn network(address: IpAddr) -> IpAddr {
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
        let mut open = OpenConnections::new(&limits);
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
        let mut open = OpenConnections::new(&ConnectionLimits::default());
        for last in 0..9 {
            drop(open.admit(IpAddr::from([10, 0, 0, last])));
        }
        assert_eq!(open.tokens.len(), 1, "that of the last one, until the next");
    }

    #[test]
    fn a_host_is_counted_once_however_it_writes_its_address() {
        assert_eq!(network(address("::ffff:10.0.0.1")), address("10.0.0.1"));
        assert_eq!(network(address("2001:db8:0:1:aaaa::1")), network(address("2001:db8:0:1:bbbb::2")));
        assert_ne!(network(address("2001:db8:0:1::1")), network(address("2001:db8:0:2::1")));
    }
}
