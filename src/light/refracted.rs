//! The light that an interface transmits, with checked arguments.

use glam::DVec3;

use super::{
    LightError, PolygonLight,
    rules::surface_and_view,
    transmission::{ETA_APART, ETA_RANGE, Transmitted, transmitted},
};
use ltcforge_fit::Configuration;

/// The transmission of a light below a rough interface, in f64. It is [`transmitted`] for a checked surface and light.
/// `eta` is the refractive index on the light's side divided by the refractive index on the viewer's side.
///
/// # Errors
/// [`LightError::Domain`] for a roughness outside [0, 1], a view direction on or below the horizon, and an index
/// outside [`ETA_RANGE`] or within [`ETA_APART`] of one.
pub fn by_refraction(at: &Configuration, eta: f64, light: &PolygonLight) -> Result<Transmitted<f64>, LightError> {
    let (alpha, wo) = surface_and_view(at)?;
    let is_known = (ETA_RANGE[0]..=ETA_RANGE[1]).contains(&eta) && (eta - 1.0).abs() >= ETA_APART;
    if !is_known {
        let allowed = "it must be from 1/3 to 3 and differ from 1 by at least 0.02";
        return Err(LightError::Domain { what: "eta", value: eta, allowed });
    }
    let vertices: Vec<[f64; 3]> = light.vertices().iter().map(DVec3::to_array).collect();
    Ok(transmitted(alpha, wo.to_array(), eta, &vertices, light.sides()))
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_fit::Sides;

    #[test]
    fn indices_and_surfaces_that_have_no_answer_are_named() {
        let vertices = [[-1.0, -1.0], [-1.0, 1.0], [1.0, 1.0], [1.0, -1.0]].map(|[x, y]| DVec3::new(x, y, -1.0));
        let light = PolygonLight::new(vertices.to_vec(), Sides::Two).expect("a light");
        let at = Configuration { alpha_x: 0.3, alpha_y: 0.3, theta: 0.4, phi: 1.0 };
        let through = by_refraction(&at, 1.5, &light).expect("glass");
        assert!(through.dielectric > 0.5 && through.dielectric < through.energy, "{through:?}");
        for eta in [f64::NAN, 0.0, -1.5, 1.0, 1.01, 3.1, f64::INFINITY] {
            let refused = by_refraction(&at, eta, &light).expect_err("no index");
            assert!(refused.to_string().starts_with(&format!("eta is {eta};")), "{refused}");
        }
        let below = Configuration { theta: 1.6, ..at };
        assert!(by_refraction(&below, 1.5, &light).expect_err("no view").to_string().starts_with("theta is 1.6;"));
    }
}
