//! How `serve` meets its clients: names, origins, limits of connections, file descriptors.

use std::num::NonZeroUsize;

use rustix::process::{Resource, Rlimit, getrlimit, setrlimit};

use super::{
    args::{ConnectionArgs, WaitSeconds},
    config_file::ServeSection,
};
use ltcforge_server::http::{ConnectionLimits, Options, Sites};

/// The settings: flags and environment go before the file, that before the defaults. A list replaces a list.
/// `descriptors` is the number of file descriptors that the process may have, `None` if there is no limit.
pub(super) fn settle(args: ConnectionArgs, file: &ServeSection, descriptors: Option<u64>) -> Options {
    let default = ConnectionLimits::default();
    let connections = args.connections.or(file.connections).map_or(default.connections, NonZeroUsize::get);
    let wanted = ConnectionLimits { connections, ..default.clone() };
    let within = wanted.within(descriptors.unwrap_or(u64::MAX));
    if within.connections < connections && args.connections.or(file.connections).is_some() {
        let allowed = within.connections;
        tracing::warn!("{connections} connections need more open files than the system allows; {allowed} are accepted");
    }
    let per_address = args.connections_per_address.or(file.connections_per_address);
    let per_address = per_address.map_or(within.connections.div_ceil(2), NonZeroUsize::get).min(within.connections);
    let seconds = args.client_seconds.or(file.client_seconds).map(WaitSeconds::duration);
    let limits = ConnectionLimits {
        per_address,
        head: seconds.unwrap_or(default.head),
        body: seconds.unwrap_or(default.body),
        stall: seconds.unwrap_or(default.stall),
        ..within
    };
    Options {
        redirects: false,
        limits,
        sites: Sites {
            hosts: list(args.allow_host, file.allow_host.as_ref()),
            origins: list(args.allow_origin, file.allow_origin.as_ref()),
        },
    }
}

fn list<T: Clone>(flags: Vec<T>, file: Option<&Vec<T>>) -> Vec<T> {
    if flags.is_empty() { file.cloned().unwrap_or_default() } else { flags }
}

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
    fn limits_follow_from_flags_file_and_descriptors() {
        let limits = |args: &ConnectionArgs, file: &ServeSection, descriptors| {
            let limits = settle(args.clone(), file, descriptors).limits;
            (limits.connections, limits.per_address, limits.head.as_secs())
        };
        let (no_flags, no_file) = (ConnectionArgs::default(), ServeSection::default());
        assert_eq!(limits(&no_flags, &no_file, None), (1024, 512, 30));
        assert_eq!(limits(&no_flags, &no_file, Some(128)), (48, 24, 30));

        let file = ServeSection {
            connections: NonZeroUsize::new(10),
            connections_per_address: NonZeroUsize::new(9),
            client_seconds: "5".parse().ok(),
            ..ServeSection::default()
        };
        assert_eq!(limits(&no_flags, &file, None), (10, 9, 5));
        let flags = ConnectionArgs { connections: NonZeroUsize::new(8), ..ConnectionArgs::default() };
        assert_eq!(limits(&flags, &file, None), (8, 8, 5));
    }

    #[test]
    fn a_list_of_flags_replaces_that_of_the_file() {
        let hosts = |names: &[&str]| names.iter().map(|name| name.parse().expect("a host")).collect::<Vec<_>>();
        let file = ServeSection { allow_host: Some(hosts(&["farm"])), ..ServeSection::default() };
        assert_eq!(settle(ConnectionArgs::default(), &file, None).sites.hosts, hosts(&["farm"]));
        let flags = ConnectionArgs { allow_host: hosts(&["a", "b"]), ..ConnectionArgs::default() };
        assert_eq!(settle(flags, &file, None).sites.hosts, hosts(&["a", "b"]));
    }

    #[test]
    fn the_process_gets_as_many_descriptors_as_it_may_have() {
        let raised = raise_descriptor_limit();
        assert_eq!(getrlimit(Resource::Nofile).current, raised);
        assert!(raised.is_none_or(|raised| raised > 64), "{raised:?}");
    }
}
