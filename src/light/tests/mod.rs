//! Compares the closed form and tables with the truth, and the truth with independent quadratures.

mod bent;
mod closed_form;
mod every_brdf;
mod extremes;
mod f82;
mod formula;
mod gaussians;
mod jumps;
mod layers;
mod shape_lights;
mod shaped_lights;
mod shapes_energy;
mod small_lights;
mod strips;
mod true_light;
mod walls;
