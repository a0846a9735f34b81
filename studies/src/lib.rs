//! Where constants of the sources come from, and rows of the documents.
//!
//! Each study has its generator, its objective and what it holds out; all are seeded. studies/README.md has the commands.

pub mod lights;
pub mod search;
pub mod weight;
