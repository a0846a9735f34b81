//! Tests the binary as users have it: the command, the service, its page and pictures, and several processes on one
//! database.

#[path = "../cli/mod.rs"]
mod cli;
#[path = "../cluster/mod.rs"]
mod cluster;
#[path = "../common/mod.rs"]
mod common;
#[path = "../page/mod.rs"]
mod page;
mod preview;
#[path = "../service/mod.rs"]
mod service;

use cluster::{Shared, Worker, faults, proxy, s3, throwaway};
