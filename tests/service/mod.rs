//! Tests of the service: over HTTP, and after events that affect its process and disk.

mod access;
mod bad_input;
pub(crate) mod brdfs;
mod clients;
mod crash;
mod damaged_blob;
mod disk_full;
mod exports;
mod jobs;
mod kills;
mod materials;
mod memory;
mod openapi;
mod page;
mod plans;
mod power_cut;
mod proxy;
mod recipes;
mod schemathesis;
mod stopping;
mod tls;
