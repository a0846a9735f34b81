//! Runs shaders by themselves, as they run at users'.

pub(crate) mod decoder;
pub(in crate::preview) mod example;
pub(in crate::preview) mod pictures;
pub(in crate::preview) mod prefilter;
