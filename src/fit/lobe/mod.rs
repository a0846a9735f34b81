//! Lobe models: what stands for a scattering lobe at run time. One folder each.

pub mod ltc;
