//! Lobe models: distributions that stand for a scattering lobe at run time. One folder each.

pub mod ltc;
