//! Whose lobes the entries of a table are fitted to, where a scene has both metal and dielectrics.
//!
//! Schlick's factor moves the lobe of plastic away from that of metal. One lobe stands between them, nearer to one or the other;
//! two lobes an entry, blended, stand for both. Each choice is fitted at configurations of the scene themselves, without a table
//! between, and held to the lobe of the material that is there: so the choices differ by what they are, and by nothing else.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::{
    held::{Held, Stopped},
    needs::{Needs, Place},
};
use ltcforge_fit::{
    BrdfModel, FITTER_VERSION, FitSettings, GivenNodes, Layout, LobeFresnel, LobeModel, LookedUp, PerAxis, Plan,
    Precision, Recipe, SecondLobe, StoredTerms, WeightedF0, fit_plan,
};

/// By how much more the surface of dielectrics counts in a mix than it covers: a mix is drawn to what reflects more, as the
/// square of that. By its surface alone it counts next to nothing, and a mix by that was the best lobe of none of the scenes tried.
const COUNTS: [f64; 2] = [16.0, 256.0];

/// Weights of a mix have three digits.
const DIGITS: f64 = 1000.0;
/// Places at which all choices are tried.
const TRIED: usize = 64;

/// Lobes that a table may have.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lobes {
    /// Whose they are.
    pub(crate) fresnel: LobeFresnel,
    /// Their mean error at places of the scene, as a part of the lobe's width; zero where there is no other choice.
    pub(crate) error: f64,
}

/// The lobes that a scene's tables may have, the best first: two an entry where these are better and the layout's readers may have
/// them, then the single ones. Runs on the current rayon pool, whose size changes nothing.
///
/// # Errors
/// [`Stopped`] where `go_on` says no.
pub(crate) fn lobes(
    needs: &Needs<'_>,
    may_be_two: bool,
    held: &Held,
    fit: FitSettings,
    go_on: &(dyn Fn() -> bool + Sync),
) -> Result<Vec<Lobes>, Stopped> {
    let parts = needs.reflectances();
    let [rest, metal] = parts[..] else {
        return Ok(vec![Lobes { fresnel: LobeFresnel::mix(parts).unwrap_or_default(), error: 0.0 }]);
    };
    let mixed = |counts: f64| {
        let (of_rest, most) = (rest.weight * counts, metal.weight.max(rest.weight * counts));
        let weight = |weight: f64| (weight / most * DIGITS).ceil() / DIGITS;
        vec![WeightedF0 { weight: weight(of_rest), ..rest }, WeightedF0 { weight: weight(metal.weight), ..metal }]
    };
    let single = COUNTS.map(mixed).into_iter().chain([vec![rest], vec![metal]]).filter_map(LobeFresnel::mix);
    let measured = |fresnel: LobeFresnel| {
        let of = |place: &Place| Some((*place, fitted_at(needs, &fresnel, place, fit, go_on)?));
        let found: Option<Vec<_>> = held.places()[..TRIED].par_iter().map(of).collect();
        Ok(Lobes { error: held.error_of(&found.ok_or(Stopped)?), fresnel })
    };
    let mut found = single.map(measured).collect::<Result<Vec<_>, Stopped>>()?;
    found.sort_by(|a, b| a.error.total_cmp(&b.error));
    if may_be_two {
        let two = measured(LobeFresnel::Two(SecondLobe::Blended))?;
        if two.error < found[0].error {
            found.insert(0, two);
        }
    }
    Ok(found)
}

/// The lobe that is fitted for a place alone.
fn fitted_at(
    needs: &Needs<'_>,
    fresnel: &LobeFresnel,
    place: &Place,
    fit: FitSettings,
    go_on: &(dyn Fn() -> bool + Sync),
) -> Option<LookedUp> {
    let at = &place.at;
    let ratio = at.alpha_y / at.alpha_x;
    let phi = if ratio == 1.0 { 0.0 } else { at.phi };
    let recipe = Recipe {
        fitter: FITTER_VERSION,
        brdf: BrdfModel::from(needs.brdf()).with_fresnel(fresnel.clone()),
        lobe: LobeModel::Ltc,
        layout: Layout::Reflected,
        resolution: PerAxis { alpha: 1, ratio: 1, theta: 1, phi: 1 },
        range: PerAxis { alpha: [at.alpha_x; 2], ratio: [ratio; 2], theta: [at.theta; 2], phi: [phi; 2] },
        fit,
        terms: StoredTerms::Schlick,
        precision: Precision::F32,
        given: GivenNodes::default(),
    };
    let progress = |_| if go_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    Some(fit_plan(&Plan::new(&recipe), &progress)?.lookup(at))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Scene;
    use ltcforge_files::recipe_document::Preset;

    fn found(list: &str, may_be_two: bool) -> Vec<Lobes> {
        let scene = Scene::from_list(list.as_bytes()).expect("a scene");
        let needs = Needs::of(&scene, false).expect("lobes");
        lobes(&needs, may_be_two, &Held::new(&needs), Preset::Draft.fit(), &|| true).expect("nothing stops it")
    }

    fn list(plastic: u32, metal: u32) -> String {
        format!(
            r#"{{"materials": [{{"alpha_x": 0.2, "alpha_y": 0.2, "f0": 0.04, "weight": {plastic}}},
                {{"alpha_x": 0.25, "alpha_y": 0.25, "weight": {metal}}}]}}"#
        )
    }

    #[test]
    fn the_lobe_is_nearer_to_what_there_is_more_of() {
        let of = |plastic, metal| match &found(&list(plastic, metal), false)[0].fresnel {
            LobeFresnel::Mix(parts) if parts.len() == 1 => parts[0].f0,
            LobeFresnel::Mix(_) => 0.5,
            _ => 1.0,
        };
        assert_eq!(of(9, 1), 0.04);
        assert!(of(1, 9) > 0.04);
        assert_eq!(found(&list(1, 0), true)[0].fresnel.to_string(), "f0 0.04 with weight 1");
    }

    #[test]
    fn two_lobes_serve_a_mixed_scene_far_better_than_any_one() {
        let found = found(&list(1, 1), true);
        let (two, one) = (&found[0], &found[1]);
        assert_eq!((one.fresnel.second(), two.fresnel.second()), (None, Some(SecondLobe::Blended)));
        assert!(two.error < 0.7 * one.error, "{} {}", one.error, two.error);
    }
}
