//! The service, over HTTP and through what happens to its process and its disk.

#[path = "../common/mod.rs"]
mod common;

mod bad_input;
mod brdfs;
mod clients;
mod crash;
mod crowds;
mod damaged_blob;
mod disk_full;
mod exports;
mod fsck;
mod jobs;
mod light_textures;
mod limits;
mod openapi;
mod page;
mod plans;
mod recipes;
mod stopping;
