//! How often each caller may ask.

use std::{
    net::IpAddr,
    num::NonZeroU32,
    sync::{
        Arc,
        atomic::{AtomicU32, Ordering},
    },
    time::Duration,
};

use governor::{
    Quota, RateLimiter,
    clock::{Clock as _, DefaultClock},
    middleware::NoOpMiddleware,
    state::keyed::HashMapStateStore,
};

use crate::{
    http::{kind::ProblemKind, problem::Problem},
    queue::Submitter,
};

/// Requests after which callers that have not asked for a while are forgotten.
const FORGET_EVERY: u32 = 1024;

/// Who asks: a token, or an address that sent none that is known.
#[derive(Debug, Clone, PartialEq, Eq, Hash)]
pub(super) enum Asking {
    Token(Arc<Submitter>),
    Address(IpAddr),
}

type Limiter = RateLimiter<Asking, HashMapStateStore<Asking>, DefaultClock, NoOpMiddleware>;

/// Requests a second of each caller, and as many at once.
#[derive(Debug)]
pub(in crate::http) struct Rates {
    limiter: Limiter,
    per_second: NonZeroU32,
    asked: AtomicU32,
}

impl Rates {
    pub(in crate::http) fn new(per_second: NonZeroU32) -> Self {
        let limiter = RateLimiter::hashmap(Quota::per_second(per_second));
        Self { limiter, per_second, asked: AtomicU32::new(0) }
    }

    /// Counts a request.
    ///
    /// # Errors
    /// The problem to answer with, when the caller has asked too often.
    pub(super) fn count(&self, asking: &Asking) -> Result<(), Problem> {
        if self.asked.fetch_add(1, Ordering::Relaxed) % FORGET_EVERY == FORGET_EVERY - 1 {
            self.limiter.retain_recent();
        }
        self.limiter.check_key(asking).map_err(|until| {
            let who = match asking {
                Asking::Token(by) => format!("the token «{}»", by.name),
                Asking::Address(address) => format!("the address {address}"),
            };
            let detail =
                format!("{who} is beyond its {} requests a second; --requests-per-second sets them", self.per_second);
            let wait: Duration = until.wait_time_from(DefaultClock::default().now());
            Problem::new(ProblemKind::TooManyRequests, detail).with_retry_after(wait)
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::queue::Claim;

    #[test]
    fn each_caller_has_requests_of_its_own() {
        let rates = Rates::new(const { NonZeroU32::new(2).unwrap() });
        let [farm, wiki] = ["farm", "wiki"]
            .map(|name| Asking::Token(Arc::new(Submitter { name: name.to_owned(), claim: Claim::default() })));
        let address = Asking::Address([10, 0, 0, 1].into());
        for asking in [&farm, &farm, &wiki, &address] {
            rates.count(asking).expect("its own");
        }
        let refused = rates.count(&farm).expect_err("the third at once");
        assert_eq!((refused.status().as_u16(), refused.retry_after_seconds()), (429, Some(1)));
        rates.count(&wiki).expect("its second");
    }
}
