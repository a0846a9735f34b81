//! ltcforge fits, stores and serves Linearly Transformed Cosine tables.

pub mod brdf;
pub mod cli;
pub mod client;
pub mod digest;
pub mod export;
pub mod fit;
pub mod http;
pub mod ltc;
pub mod math;
pub mod picture;
pub mod plots;
pub mod preview;
pub mod queue;
pub mod recipe;
pub mod service;
pub mod store;
pub mod tradeoff;
