//! Tests of the command line: its output and its exit codes.

mod answers;
mod ci;
mod compare;
mod documents;
mod exports;
mod foreign_texts;
mod light_textures;
mod lights;
mod listed;
mod lock_file;
mod luts;
mod materials;
mod outputs;
mod pictures;
mod plan;
mod project;
mod pull;
mod readme;
mod same_bytes;
mod sampling;
mod scenes;
mod service;
mod tables;
mod tabulated;
mod tradeoff;
mod translations;
