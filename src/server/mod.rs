//! The service: blobs and rows, the durable queue, the use cases, and HTTP.

pub mod http;
pub mod queue;
pub mod service;
pub mod store;
