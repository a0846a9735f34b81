//! File descriptors of the process.

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

/// Lets the process open as many files as the system permits it, and returns how many that are; `None` if there is no
/// limit. Many systems begin with 1024, for the sake of programs that cannot handle more.
pub(super) fn raise_descriptor_limit() -> Option<u64> {
    let Rlimit { current, maximum } = getrlimit(Resource::Nofile);
    if current == maximum {
        return current;
    }
    match setrlimit(Resource::Nofile, Rlimit { current: maximum, maximum }) {
        Ok(()) => maximum,
        // Then there are as many as before.
        Err(_) => current,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_process_gets_as_many_descriptors_as_it_may_have() {
        let raised = raise_descriptor_limit();
        assert_eq!(getrlimit(Resource::Nofile).current, raised);
        assert!(raised.is_none_or(|raised| raised > 64), "{raised:?}");
    }
}
