//! Nine materials under one lamp: the truth, light by a table and by model `normals`, and the error of each model. This
//! is the picture docs/materials.png.

mod glass;
mod list;
mod rendered;
mod shade;
mod sphere;
#[cfg(test)]
mod tests;

use self::{
    list::{MATERIALS, Material},
    rendered::{Apart, Sphere},
    shade::{TRUTH_TOLERANCE, Way},
};
use ltcforge::view::picture::{
    Anchor, GROUND, LINE, Picture, bar, beside, colour, fitting, headed, number, short_digest, write,
};
use ltcforge::{
    files::{container, digest::Digest, recipe_document},
    fit::{BrdfKind, PerAxis, Plan, SecondLobe, Table, fit_plan},
};
use std::ops::ControlFlow;

use ltcforge_light::{LightError, LightModel, Lighting, NormalsRule, TableUse};

/// Options of the picture.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MaterialChoices {
    /// Side of each panel in pixels, at least one.
    pub size: u32,
    /// The rule of model `normals`.
    pub rule: NormalsRule,
    /// Whether the light and the lobe of the table are cut at the surface.
    pub cut: bool,
    /// The radiance difference at the end of the colour bar.
    pub difference_scale: f64,
}

/// A table, with the digest of its file and the ranges that it covers.
#[derive(Debug, Clone, Copy)]
pub struct NamedTable<'a> {
    /// The table.
    pub table: &'a Table,
    /// The digest of its file, in hexadecimal.
    pub digest: &'a str,
    /// The ranges of its axes.
    pub range: &'a PerAxis<[f64; 2]>,
}

/// The picture, and the errors of the models.
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialSpheres {
    /// A column for each material.
    pub picture: Picture,
    /// The errors of the table in the order of the columns, without glass, then those of model `normals`.
    pub errors: Vec<MaterialError>,
    /// The materials with a roughness that the table does not cover. The picture uses the nearest entry for them.
    pub outside: Vec<&'static str>,
}

/// The error of a model for one material.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
pub struct MaterialError {
    /// The material.
    pub material: &'static str,
    /// The model.
    pub model: LightModel,
    /// Mean absolute difference in radiance, over the sphere and over channels.
    pub mean_absolute_error: f64,
    /// Mean true radiance, over the sphere and over channels.
    pub mean_radiance: f64,
}

/// The recipe of the picture's table: the default, with a second lobe for plastic and the edge term of F82.
const RECIPE: &str = r#"{"fresnel": "two_lobes", "terms": "f82"}"#;

/// Fits [`RECIPE`] and draws the picture. Returns the picture as PNG, and text with a line for each error.
///
/// # Errors
/// The recipe is invalid, or the light or the PNG cannot be computed.
pub fn drawn() -> Result<(Vec<u8>, String), Box<dyn std::error::Error>> {
    let recipe = recipe_document::parse(RECIPE.as_bytes(), recipe_document::DEFAULT_ENTRY_LIMIT)?;
    let table = fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).ok_or("the fit was stopped")?;
    let digest = Digest::of(&container::encode(&recipe, &table)?).hex();
    let named = NamedTable { table: &table, digest: &digest, range: &recipe.range };
    let MaterialSpheres { picture, errors, .. } = material_spheres(named, &MaterialChoices::default())?;
    let line = |MaterialError { material, model, mean_absolute_error, mean_radiance }: &MaterialError| {
        format!(
            "{model}, {material}: mean absolute error {mean_absolute_error:.5} of mean radiance {mean_radiance:.5}\n"
        )
    };
    Ok((picture.png()?, errors.iter().map(line).collect()))
}

impl Default for MaterialChoices {
    /// Together the columns are as wide as a page.
    fn default() -> Self {
        Self { size: 92, rule: NormalsRule::ALL[0], cut: false, difference_scale: 0.02 }
    }
}

/// Draws the picture with a table for GGX. Renders on the current rayon pool, whose size does not change the picture.
///
/// # Errors
/// [`LightError::OtherLights`] if the table is for another scattering model, and the errors of its light.
pub fn material_spheres(named: NamedTable<'_>, choices: &MaterialChoices) -> Result<MaterialSpheres, LightError> {
    let NamedTable { table, digest, range } = named;
    let &MaterialChoices { size, rule, cut, difference_scale } = choices;
    if table.brdf() != BrdfKind::Ggx {
        return Err(LightError::OtherLights { lights: BrdfKind::Ggx, table: table.brdf() });
    }
    let second = table.model().fresnel().second();
    let by_table = Lighting::Table(table, TableUse { cut, blend: second == Some(SecondLobe::Blended) });
    let lobe = table.lobe.name().to_uppercase();
    let lobes = if second.is_some() { ", two lobes an entry" } else { "" };
    let mut models = vec![(
        by_table,
        LightModel::of_lobe(table.lobe),
        lobe.clone(),
        format!("{lobe}, table {}{lobes}", short_digest(digest)),
    )];
    if let Some(form) = LightModel::Normals.closed_form(Some(rule)) {
        let long = format!("normals, rule {rule}: no table; glass by its own closed form");
        models.push((Lighting::ClosedForm(form), LightModel::Normals, "normals".to_owned(), long));
    }

    let truth = spheres(Way::Truth, size)?;
    let mut parts = vec![
        labels(size, MATERIALS.iter().map(|material| material.name.to_owned())),
        row(&["truth: each material's own formula, by quadrature", "truth"], size, &truth, Sphere::shown),
    ];
    let mut errors = Vec::new();
    for (lighting, model, short, long) in models {
        let lit = spheres(Way::Model(lighting), size)?;
        parts.push(row(&[&long, &short], size, &lit, Sphere::shown));
        let pairs: Vec<_> = lit.iter().zip(&truth).map(|(lit, truth)| lit.as_ref().zip(truth.as_ref())).collect();
        let title = format!("|{short} - truth|, and its mean over the sphere");
        let apart = |(lit, truth): &(&Sphere, &Sphere)| lit.difference(truth, difference_scale);
        parts.push(row(&[&title, &short], size, &pairs, apart));
        let apart: Vec<Option<Apart>> = pairs.iter().map(|pair| pair.map(|(lit, truth)| lit.apart(truth))).collect();
        let mean = |apart: &Option<Apart>| apart.as_ref().map(|apart| told(apart.mean_absolute));
        parts.push(labels(size, apart.iter().map(|apart| mean(apart).unwrap_or_default())));
        errors.extend(MATERIALS.iter().zip(apart).filter_map(|(Material { name: material, .. }, apart)| {
            let Apart { mean_absolute: mean_absolute_error, mean_radiance } = apart?;
            Some(MaterialError { material, model, mean_absolute_error, mean_radiance })
        }));
    }
    let end = number(difference_scale as f32);
    parts.push(bar(parts[0].width, colour, ["0", &end], &["|difference| of radiance, mean of the channels"]));
    let outside = MATERIALS.iter().filter(|material| is_outside(material, range)).map(|material| material.name);
    Ok(MaterialSpheres { picture: below(&parts), errors, outside: outside.collect() })
}

/// A mean error as text below a sphere.
fn told(error: f64) -> String {
    if error < TRUTH_TOLERANCE { "exact".to_owned() } else { format!("{error:.5}") }
}

/// The sphere of every material.
fn spheres(way: Way<'_>, size: u32) -> Result<Vec<Option<Sphere>>, LightError> {
    MATERIALS.iter().map(|material| Sphere::new(material, way, size)).collect()
}

/// Whether the table does not cover a roughness of the material.
fn is_outside(material: &Material, range: &PerAxis<[f64; 2]>) -> bool {
    /// The tolerance for rounding errors, relative to the end of a range.
    const ROUNDING: f64 = 1e-6;
    let is_within = |[low, high]: [f64; 2], x: f64| (low * (1.0 - ROUNDING)..=high * (1.0 + ROUNDING)).contains(&x);
    material.roughnesses().any(|[x, y]| {
        let alpha = x.max(y);
        !(is_within(range.alpha, alpha) && is_within(range.ratio, x.min(y) / alpha))
    })
}

/// Panels next to each other, below a title. A panel without content shows that there is no table for it.
fn row<T>(title: &[&str], size: u32, contents: &[Option<T>], draw: impl Fn(&T) -> Picture) -> Picture {
    let panel = |content: &Option<T>| content.as_ref().map_or_else(|| absent(size), &draw);
    headed(&[title], &beside(&contents.iter().map(panel).collect::<Vec<_>>()))
}

fn absent(size: u32) -> Picture {
    let mut picture = Picture::filled(size, size, GROUND);
    write(&mut picture, fitting(&["no table", "-"], size), size / 2, size / 2, Anchor::Middle, size);
    picture
}

/// A line with one text per panel.
fn labels(size: u32, words: impl Iterator<Item = String>) -> Picture {
    let label = |word: String| {
        let mut picture = Picture::filled(size, LINE, GROUND);
        write(&mut picture, fitting(&[&word], size), size / 2, LINE / 2, Anchor::Middle, size);
        picture
    };
    beside(&words.map(label).collect::<Vec<_>>())
}

/// Pictures below each other, aligned at the left.
fn below(pictures: &[Picture]) -> Picture {
    let width = pictures.iter().map(|picture| picture.width).max().unwrap_or(1);
    let height = pictures.iter().map(|picture| picture.height).sum::<u32>();
    let mut whole = Picture::filled(width, height.max(1), GROUND);
    let mut top = 0;
    for picture in pictures {
        whole.put(picture, 0, top);
        top += picture.height;
    }
    whole
}
