//! Recipes made in code, and read from documents.

use std::{collections::BTreeMap, path::PathBuf};

use serde_json::{Map, Value, json};

use super::Error;
use ltcforge_files::{
    digest::Digest,
    recipe_document::{DEFAULT_ENTRY_LIMIT, Preset, canonical_json, digest, parse_with},
    tabulated::locate,
};
use ltcforge_fit::{
    BrdfKind, Layout, LobeModel, Metric, Precision, Recipe, SecondLobe, Shear, Solver, Start, StoredTerms, WeightedF0,
};

/// Makes a [`Recipe`] field by field. Fields that are not set have the defaults of a recipe document.
///
/// Fields and bounds are the same as in a recipe document. A builder makes only recipes that a document can describe.
#[derive(Debug, Clone)]
#[must_use]
pub struct RecipeBuilder {
    fields: Map<String, Value>,
    nested: BTreeMap<&'static str, Map<String, Value>>,
    entry_limit: u64,
}

/// A recipe and its documents.
pub trait RecipeDocument: Sized {
    /// A builder with preset `standard`.
    fn builder() -> RecipeBuilder;

    /// Reads a recipe document. The path of a tabulated BRDF's file is relative to the working folder.
    ///
    /// # Errors
    /// [`Error::Recipe`] with every fault of the document.
    fn from_json(json: &[u8]) -> Result<Self, Error>;

    /// The canonical JSON (RFC 8785), with all defaults filled in.
    #[must_use]
    fn to_json(&self) -> String;

    /// SHA-256 of the canonical JSON: equal for recipes that give equal bytes.
    #[must_use]
    fn digest(&self) -> Digest;
}

impl RecipeDocument for Recipe {
    fn builder() -> RecipeBuilder {
        RecipeBuilder { fields: Map::new(), nested: BTreeMap::new(), entry_limit: DEFAULT_ENTRY_LIMIT }
    }

    fn from_json(json: &[u8]) -> Result<Self, Error> {
        read(json, DEFAULT_ENTRY_LIMIT)
    }

    fn to_json(&self) -> String {
        canonical_json(self)
    }

    fn digest(&self) -> Digest {
        digest(self)
    }
}

/// Reads a document. Paths of BRDF files are relative to the working folder.
fn read(json: &[u8], entry_limit: u64) -> Result<Recipe, Error> {
    let folders = [PathBuf::from(".")];
    Ok(parse_with(json, entry_limit, &|name| Ok(locate(&folders, name)?.file))?)
}

impl RecipeBuilder {
    fn set(mut self, field: &str, value: impl Into<Value>) -> Self {
        self.fields.insert(field.to_owned(), value.into());
        self
    }

    fn set_in(mut self, object: &'static str, field: &str, value: impl Into<Value>) -> Self {
        self.nested.entry(object).or_default().insert(field.to_owned(), value.into());
        self
    }

    /// The fit settings that are not set one by one.
    pub fn preset(self, preset: Preset) -> Self {
        self.set("preset", preset.name())
    }

    /// The scattering model.
    pub fn brdf(self, brdf: BrdfKind) -> Self {
        self.set("brdf", brdf.name())
    }

    /// A tabulated BRDF. `file` is the path of its file, or its digest if the working folder has
    /// `HEX.brdf.safetensors`. `build` reads the file.
    pub fn tabulated(self, file: impl Into<String>) -> Self {
        self.brdf(BrdfKind::Tabulated).set("tabulated", file.into())
    }

    /// The materials whose lobe is fitted: reflectances at normal incidence, and weights. The default is a Fresnel
    /// factor of one.
    pub fn materials(self, materials: &[WeightedF0]) -> Self {
        self.set("fresnel", json!(materials))
    }

    /// Two lobes per entry, for materials of any reflectance. `second` determines how the second lobe is used.
    pub fn two_lobes(self, second: SecondLobe) -> Self {
        self.set("fresnel", second.name())
    }

    /// The distribution that approximates a lobe.
    pub fn lobe(self, lobe: LobeModel) -> Self {
        self.set("lobe", lobe.name())
    }

    /// How the table stores lobes.
    pub fn layout(self, layout: Layout) -> Self {
        self.set("layout", layout.name())
    }

    /// Number format of the table.
    pub fn precision(self, precision: Precision) -> Self {
        self.set("precision", precision.name())
    }

    /// Whether amplitude and Fresnel term are stored.
    pub fn terms(self, terms: bool) -> Self {
        self.set("terms", terms)
    }

    /// Stores the edge term as well, which metals with F82 need.
    pub fn f82_terms(self) -> Self {
        self.set("terms", StoredTerms::F82_NAME)
    }

    /// Number of nodes on the axis `axis`: `alpha`, `ratio`, `theta` or `phi`.
    pub fn resolution(self, axis: &str, nodes: u32) -> Self {
        self.set_in("resolution", axis, nodes)
    }

    /// Lowest and highest value on an axis. A range of a single value has one node.
    pub fn range(self, axis: &str, low: f64, high: f64) -> Self {
        self.set_in("range", axis, json!([low, high]))
    }

    /// Listed nodes of an axis, ascending, instead of its range and resolution.
    pub fn nodes(self, axis: &str, nodes: &[f64]) -> Self {
        self.set_in("nodes", axis, json!(nodes))
    }

    /// The materials of layout `materials`: pairs of alpha and ratio, in the order of their numbers. Also sets the
    /// layout.
    pub fn surfaces(self, pairs: &[[f64; 2]]) -> Self {
        let list: Vec<Value> = pairs.iter().map(|[alpha, ratio]| json!({ "alpha": alpha, "ratio": ratio })).collect();
        self.set("layout", Layout::Materials.name()).set("materials", list)
    }

    /// Isotropic surfaces only: ratio 1 and one phi.
    pub fn isotropic(self) -> Self {
        self.range("ratio", 1.0, 1.0).range("phi", 0.0, 0.0)
    }

    /// The distance that the fit minimises.
    pub fn metric(self, metric: Metric) -> Self {
        self.set_in("fit", "metric", metric.name())
    }

    /// The method that minimises the distance.
    pub fn solver(self, solver: Solver) -> Self {
        self.set_in("fit", "solver", solver.name())
    }

    /// Which number skews a lobe, for a solver with a simplex.
    pub fn shear(self, shear: Shear) -> Self {
        self.set_in("fit", "shear", shear.name())
    }

    /// Where searches start, for a solver with a simplex.
    pub fn start(self, start: Start) -> Self {
        self.set_in("fit", "start", start.name())
    }

    /// Samples of the LTC in each evaluation.
    pub fn samples(self, samples: u32) -> Self {
        self.set_in("fit", "samples", samples)
    }

    /// Directions that the samples are projected on.
    pub fn directions(self, directions: u32) -> Self {
        self.set_in("fit", "directions", directions)
    }

    /// Maximum number of steps.
    pub fn steps(self, steps: u32) -> Self {
        self.set_in("fit", "steps", steps)
    }

    /// Seed of the sample sequences.
    pub fn seed(self, seed: u64) -> Self {
        self.set_in("fit", "seed", seed)
    }

    /// Maximum number of entries of the table. The default is two million.
    pub fn entry_limit(mut self, entries: u64) -> Self {
        self.entry_limit = entries;
        self
    }

    /// Builds the recipe.
    ///
    /// # Errors
    /// [`Error::Recipe`] with every field that is out of its bounds or does not fit the others.
    pub fn build(self) -> Result<Recipe, Error> {
        let mut fields = self.fields;
        for (object, nested) in self.nested {
            fields.insert(object.to_owned(), Value::Object(nested));
        }
        read(Value::Object(fields).to_string().as_bytes(), self.entry_limit)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use ltcforge_files::recipe_document::RecipeError;

    #[test]
    fn a_built_recipe_equals_its_document() {
        let built = Recipe::builder()
            .preset(Preset::Draft)
            .layout(Layout::Kt2022)
            .precision(Precision::F16)
            .materials(&[WeightedF0 { f0: 0.04, weight: 2.0 }, WeightedF0 { f0: 1.0, weight: 1.0 }])
            .terms(false)
            .resolution("alpha", 5)
            .range("theta", 0.0, 1.0)
            .samples(64)
            .seed(3)
            .build();
        let document = br#"{"preset": "draft", "layout": "kt2022", "precision": "f16", "terms": false,
            "fresnel": [{"f0": 1}, {"f0": 0.04, "weight": 2}],
            "resolution": {"alpha": 5}, "range": {"theta": [0, 1]}, "fit": {"samples": 64, "seed": 3}}"#;
        assert_eq!(built.expect("a recipe"), Recipe::from_json(document).expect("the same"));
        assert_eq!(Recipe::builder().build().expect("a recipe"), Recipe::from_json(b"{}").expect("the same"));
        let two = Recipe::builder().two_lobes(SecondLobe::Blended).build().expect("a recipe");
        assert_eq!(two, Recipe::from_json(br#"{"fresnel": "blended_lobes"}"#).expect("the same"));
    }

    #[test]
    fn an_invalid_recipe_names_every_fault() {
        let refused = Recipe::builder().samples(1).range("alpha", 0.5, f64::NAN).resolution("beta", 3).build();
        let Err(Error::Recipe(RecipeError::Faults(faults))) = refused else { panic!("{refused:?}") };
        let pointers: Vec<&str> = faults.iter().map(|fault| fault.pointer.as_str()).collect();
        assert_eq!(pointers, ["/fit/samples", "/range/alpha", "/resolution/beta"]);
    }
}
