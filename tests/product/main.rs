//! The binary as its users have it: the service, and several processes on one database.

#[path = "../cluster/mod.rs"]
mod cluster;
#[path = "../common/mod.rs"]
mod common;
#[path = "../service/mod.rs"]
mod service;

use cluster::{Shared, Worker, faults, pgbouncer, proxy, s3, throwaway};
use service::brdfs;
