//! The kinds of Gaussians.

use crate::named_list;

named_list! {
    /// The Gaussian that represents a lobe.
    pub enum Gaussian {
        /// A spherical Gaussian: round, with the peak and the integral of the stretched Gaussian.
        Sg = "sg",
        /// An anisotropic spherical Gaussian, stretched like the warped lobe.
        Asg = "asg",
    }
}
