//! The server: the store of blobs and rows, the durable queue, the service, and HTTP.

pub mod http;
pub mod queue;
pub mod service;
pub mod store;
