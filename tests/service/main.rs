//! The service, over HTTP and through what happens to its process and its disk.

#[path = "../common/mod.rs"]
mod common;

mod access;
mod backup;
mod bad_input;
mod brdfs;
mod clients;
mod crash;
mod crowds;
mod damage;
mod damaged_blob;
mod disk_full;
mod exports;
mod fsck;
mod jobs;
mod kills;
mod light_textures;
mod limits;
mod materials;
mod memory;
mod openapi;
mod page;
mod pins;
mod plans;
mod power_cut;
mod recipes;
mod schemathesis;
mod stopping;
mod tls;
mod zstd_coding;
