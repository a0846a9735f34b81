//! ltcforge fits, stores and serves Linearly Transformed Cosine tables.

pub mod cli;
pub mod client;
pub mod files;
pub mod fit;
pub mod server;
pub mod view;
