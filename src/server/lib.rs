//! The server: the store for blobs and rows, the durable queue, the service, and the HTTP interface.

pub mod http;
pub mod queue;
pub mod service;
pub mod store;
