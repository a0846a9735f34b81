//! The lobes that the entries of a table are fitted to, for a scene with both metal and dielectrics.
//!
//! Schlick's factor makes the lobe of plastic differ from the lobe of metal. A single lobe is a compromise between
//! them. Two blended lobes per entry represent both. Each choice is fitted at configurations of the scene, without a
//! table, and compared with the lobe of the material there. The choices differ only in their lobes.

use std::ops::ControlFlow;

use rayon::prelude::*;

use crate::{
    needs::Needs,
    probes::{Probes, Stopped},
    scene::Place,
};
use ltcforge_fit::{
    GoOn, Layout, LobeFresnel, LookedUp, PerAxis, Plan, Recipe, SecondLobe, StoredTerms, Table, WeightedF0, fit_plan,
};

/// Factors on the area of dielectrics in a mix. A mix follows the square of the reflectance, so dielectrics hardly
/// count without a factor. A mix without a factor was not the best lobe in any scene that we tried.
const COUNTS: [f64; 2] = [16.0, 256.0];

/// Weights of a mix have three digits.
const DIGITS: f64 = 1000.0;
/// Places at which all choices are tried.
const TRIED: usize = 64;

/// A choice of lobes for a table.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Lobes {
    /// The materials to which the lobes are fitted.
    pub(crate) fresnel: LobeFresnel,
    /// The error of the lobes at the first places of the scene; empty if there is no other choice.
    pub(crate) errors: Vec<f64>,
}

/// The choices of lobes for tables like `base`, best first: two lobes per entry if they are allowed and better, then
/// the single lobes. `stock` are the errors of the light with an engine's own table. A lobe that is farther from metal
/// or from dielectrics than this table comes last. Runs on the current rayon pool. The size of the pool does not change
/// the result.
///
/// # Errors
/// [`Stopped`] if `go_on` returns `false`.
pub(crate) fn lobes(
    needs: &Needs<'_>,
    may_be_two: bool,
    (probes, stock): (&Probes, Option<&[f64]>),
    base: &Recipe,
    go_on: &GoOn<'_>,
) -> Result<Vec<Lobes>, Stopped> {
    let parts = needs.reflectances();
    let mixed = |rest: WeightedF0, metal: WeightedF0, counts: f64| {
        let most = metal.weight.max(rest.weight * counts);
        let weight = |weight: f64| (weight / most * DIGITS).ceil() / DIGITS;
        let rest = WeightedF0 { weight: weight(rest.weight * counts), ..rest };
        vec![rest, WeightedF0 { weight: weight(metal.weight), ..metal }]
    };
    let single = match parts[..] {
        [rest, metal] => {
            let mixes = COUNTS.map(|counts| mixed(rest, metal, counts));
            mixes.into_iter().chain([vec![rest], vec![metal]]).collect()
        }
        _ => vec![parts.clone()],
    };
    let mut single: Vec<LobeFresnel> = single.into_iter().filter_map(LobeFresnel::mix).collect();
    // The lobe of a perfect mirror is that of engines. It may be nearer under some lights.
    if single.is_empty() || stock.is_some() || probes.are_lit() {
        single.push(LobeFresnel::default());
    }
    if let [only] = &single[..] {
        return Ok(vec![Lobes { fresnel: only.clone(), errors: Vec::new() }]);
    }
    let measured = |fresnel: LobeFresnel| {
        let lobe = |place: &Place| fitted_at(place, &fresnel, base, go_on);
        let found = probes.places.par_iter().take(TRIED).map(lobe).collect::<Result<Vec<_>, Stopped>>()?;
        let farther = stock.map_or(1.0, |stock| probes.farther(&found, stock));
        let errors = probes.errors_of_lobes(&found);
        Ok((farther, probes.mean(&errors), Lobes { fresnel, errors }))
    };
    let mut found = single.into_iter().map(measured).collect::<Result<Vec<_>, Stopped>>()?;
    found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.total_cmp(&b.1)));
    if may_be_two && parts.len() == 2 {
        let two = measured(LobeFresnel::Two(SecondLobe::Blended))?;
        if two.1 < found[0].1 {
            found.insert(0, two);
        }
    }
    Ok(found.into_iter().map(|(.., lobes)| lobes).collect())
}

/// The lobe that is fitted for one place of the scene.
fn fitted_at(place: &Place, fresnel: &LobeFresnel, base: &Recipe, go_on: &GoOn<'_>) -> Result<LookedUp, Stopped> {
    let at = &place.at;
    let ratio = at.alpha_y / at.alpha_x;
    let phi = if ratio == 1.0 { 0.0 } else { at.phi };
    let recipe = Recipe {
        brdf: base.brdf.clone().with_fresnel(fresnel.clone()),
        layout: Layout::Reflected,
        resolution: PerAxis { alpha: 1, ratio: 1, theta: 1, phi: 1 },
        range: PerAxis { alpha: [at.alpha_x; 2], ratio: [ratio; 2], theta: [at.theta; 2], phi: [phi; 2] },
        terms: StoredTerms::Schlick,
        ..base.clone()
    };
    Ok(fitted(&recipe, go_on)?.lookup(at))
}

/// Fits the table of a recipe. Runs on the current rayon pool. The size of the pool does not change the result.
///
/// # Errors
/// [`Stopped`] if `go_on` returns `false`.
pub(crate) fn fitted(recipe: &Recipe, go_on: &GoOn<'_>) -> Result<Table, Stopped> {
    let progress = |_| if go_on() { ControlFlow::Continue(()) } else { ControlFlow::Break(()) };
    fit_plan(&Plan::new(recipe), &progress).ok_or(Stopped)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{Scene, probes::POINTS};
    use ltcforge_files::recipe_document::{DEFAULT_ENTRY_LIMIT, parse};

    fn found(list: &str, may_be_two: bool) -> Vec<Lobes> {
        let scene = Scene::from_list(list.as_bytes()).expect("a scene");
        let needs = Needs::of(&scene, false).expect("lobes");
        let base = parse(br#"{"preset": "draft"}"#, DEFAULT_ENTRY_LIMIT).expect("a recipe");
        lobes(&needs, may_be_two, (&Probes::new(&needs, POINTS), None), &base, &|| true).expect("nothing stops it")
    }

    fn list(plastic: u32, metal: u32) -> String {
        format!(
            r#"{{"materials": [{{"alpha_x": 0.2, "alpha_y": 0.2, "f0": 0.04, "weight": {plastic}}},
                {{"alpha_x": 0.25, "alpha_y": 0.25, "weight": {metal}}}]}}"#
        )
    }

    #[test]
    fn the_lobe_is_nearer_to_the_larger_surface() {
        let f0 = |plastic, metal| match &found(&list(plastic, metal), false)[0].fresnel {
            LobeFresnel::Mix(parts) if parts.len() == 1 => parts[0].f0,
            LobeFresnel::Mix(_) => 0.5,
            _ => 1.0,
        };
        assert_eq!(f0(9, 1), 0.04);
        assert!(f0(1, 9) > 0.04);
        assert_eq!(found(&list(1, 0), true)[0].fresnel.to_string(), "f0 0.04 with weight 1");
    }

    #[test]
    fn two_lobes_serve_a_mixed_scene_far_better_than_one() {
        let found = found(&list(1, 1), true);
        let (two, one) = (&found[0], &found[1]);
        assert_eq!((one.fresnel.second(), two.fresnel.second()), (None, Some(SecondLobe::Blended)));
        let [one, two] = [one, two].map(|lobes| lobes.errors.iter().sum::<f64>());
        assert!(two < 0.7 * one, "{one} {two}");
    }
}
