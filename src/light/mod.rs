//! What a surface reflects or transmits of an area light, by each model: a table of LTCs, or the closed form in the space
//! of normals; and the truth, by quadrature.
//!
//! Invariant: `light` fits nothing and reads no file.

pub mod normals;
pub mod transmission;
