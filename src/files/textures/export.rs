//! Exports of a table: which files, by one name.

use std::{fmt, str::FromStr};

use super::{
    About, Bundle, CompactContainer, CompactFileError, Engine, NoTextures, TextureContainer, TextureFileError,
    TextureLayout, recipe::recipe_like, sampling_of,
};
use crate::{
    files::compact::encode,
    fit::{BrdfKind, Precision, Table},
};

/// What files that hold all textures are called.
const STEM: &str = "ltc";
/// Under what the manifest of files that are no engine's has the export's name.
const MANIFEST_KEY: &str = "export";

/// Files that can be made of a table. Its name is that of an engine, layout, format and numbers with dots between, or that
/// of a compact form: `three`, `ltc2017.ktx2.f16`, `compact-js`.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Export {
    /// The files of an engine, under its names.
    Engine(Engine),
    /// Textures of a layout in a format of one's own choice.
    Textures {
        /// What axes, texels and channels are.
        layout: TextureLayout,
        /// The files' format.
        container: TextureContainer,
        /// Bits of a number.
        precision: Precision,
    },
    /// The table in its compact form.
    Compact(CompactContainer),
}

/// Why there is no export of a name.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "«{}» is no export: an export is an engine ({}), a compact form ({}), or layout.container.precision, such as \
    ltc2017.ktx2.f16, of the layouts {}, the containers {} and the precisions {}", .0.escape_debug(), names(Engine::ALL),
    names(CompactContainer::ALL), names(TextureLayout::ALL), names(TextureContainer::ALL), names(Precision::ALL)
)]
pub struct UnknownExport(pub String);

fn names<T: fmt::Display>(all: &[T]) -> String {
    all.iter().map(ToString::to_string).collect::<Vec<_>>().join(", ")
}

/// Why a table has no such files.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum ExportError {
    /// It has no such textures.
    #[error(transparent)]
    Textures(#[from] NoTextures),
    /// It has, of other sizes than the engine takes.
    #[error("{source}; this recipe gives a table that has them: {recipe}")]
    Sizes {
        /// What the engine takes, and what there is.
        source: TextureFileError,
        /// A recipe that serves.
        recipe: String,
    },
    /// The format cannot hold them.
    #[error(transparent)]
    Files(TextureFileError),
    /// It has matrices that no shader can invert.
    #[error(
        "{count} entries have matrices without an inverse, which make no light; the first is entry {entry}, {place}"
    )]
    Singular {
        /// How many.
        count: usize,
        /// The index of the first.
        entry: usize,
        /// Where it is.
        place: String,
    },
    /// It has no such compact form.
    #[error(transparent)]
    Compact(#[from] CompactFileError),
}

impl ExportError {
    /// A recipe whose table has these files, if another one would help.
    #[must_use]
    pub fn recipe(&self) -> Option<&str> {
        match self {
            Self::Textures(NoTextures::OtherLayout { recipe, .. } | NoTextures::Lacking { recipe, .. })
            | Self::Sizes { recipe, .. }
            | Self::Compact(CompactFileError::Layout { recipe, .. }) => Some(recipe),
            Self::Textures(_) | Self::Files(_) | Self::Singular { .. } | Self::Compact(_) => None,
        }
    }
}

impl Export {
    /// Every export that there is: of engines first, then textures, then compact forms.
    pub fn all() -> impl Iterator<Item = Self> {
        let textures = TextureLayout::ALL.iter().flat_map(|&layout| {
            TextureContainer::ALL.iter().flat_map(move |&container| {
                Precision::ALL.iter().map(move |&precision| Self::Textures { layout, container, precision })
            })
        });
        let compact = CompactContainer::ALL.iter().map(|&container| Self::Compact(container));
        Engine::ALL.iter().map(|&engine| Self::Engine(engine)).chain(textures).chain(compact)
    }

    /// The name of the layout that the files have, and whether the table has it. Sizes are not looked at.
    ///
    /// # Errors
    /// When it has not; the error names a recipe whose table has it. When one of its matrices has no inverse.
    pub fn layout(self, table: &Table) -> Result<&'static str, ExportError> {
        check_inverses(table)?;
        match self {
            Self::Engine(engine) => Ok(engine_textures(engine, table)?.name()),
            Self::Textures { layout, .. } => {
                layout.check(table)?;
                Ok(layout.name())
            }
            Self::Compact(container) => {
                container.check(table)?;
                Ok(table.layout.name())
            }
        }
    }

    /// The files, their manifest, and what to do with them. They follow from the arguments and this program alone. `about` says what the
    /// table is; how its textures are sampled is added.
    ///
    /// # Errors
    /// When the table has no such files.
    pub fn bundle(self, table: &Table, about: About) -> Result<Bundle, ExportError> {
        check_inverses(table)?;
        match self {
            Self::Engine(engine) => {
                let layout = engine_textures(engine, table)?;
                let textures = layout.textures(table)?;
                let made = engine.bundle(&textures, &table.axes, &about.and(sampling_of(table, layout)));
                made.map_err(|source| match source {
                    TextureFileError::Missing { .. } => {
                        let recipe = recipe_like(layout.sampling().recipe, table.layout(), table);
                        ExportError::Sizes { source, recipe }
                    }
                    other => ExportError::Files(other),
                })
            }
            Self::Textures { layout, container, precision } => {
                let textures = layout.textures(table)?;
                let about = about.of_layout(layout.name()).and(sampling_of(table, layout));
                let files = container.files(STEM, &textures, precision, &about).map_err(ExportError::Files)?;
                Ok(Bundle { files, steps: vec![] }.with_manifest(MANIFEST_KEY, &self.to_string(), &about))
            }
            Self::Compact(container) => {
                container.check(table)?;
                Self::compact_bundle(container, encode(table).map_err(CompactFileError::Form)?, &about)
            }
        }
    }

    /// [`Self::bundle`] of a table whose compact form is there already.
    ///
    /// # Errors
    /// When the bytes are no compact form.
    pub fn compact_bundle(container: CompactContainer, bytes: Vec<u8>, about: &About) -> Result<Bundle, ExportError> {
        let bundle = Bundle { files: container.files_of(STEM, bytes, about)?, steps: container.steps(STEM) };
        Ok(bundle.with_manifest(MANIFEST_KEY, container.name(), about))
    }
}

/// Refuses matrices without an inverse.
fn check_inverses(table: &Table) -> Result<(), ExportError> {
    let mut singular = table.determinants().enumerate().filter(|(_, x)| *x == 0.0 || !x.is_finite());
    let Some((entry, _)) = singular.next() else { return Ok(()) };
    Err(ExportError::Singular { count: 1 + singular.count(), entry, place: table.place_of(entry) })
}

/// The layout of the textures that an engine takes of a table.
fn engine_textures(engine: Engine, table: &Table) -> Result<TextureLayout, NoTextures> {
    let layout = match (engine.layout(), table.layout) {
        (Some(name), _) => TextureLayout::named(name)?,
        (None, layout) => TextureLayout::of_shader(layout),
    };
    layout.check(table)?;
    if table.lobe.gaussian().is_some() {
        return Err(NoTextures::OtherLobe { engine: engine.name(), lobe: table.lobe, layout: layout.name() });
    }
    match engine.layout() {
        Some(name) if table.brdf != BrdfKind::Ggx => {
            Err(NoTextures::OtherBrdf { engine: engine.name(), brdf: table.brdf(), layout: name })
        }
        _ => Ok(layout),
    }
}

impl fmt::Display for Export {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Engine(engine) => f.write_str(engine.name()),
            Self::Textures { layout, container, precision } => {
                write!(f, "{}.{}.{}", layout.name(), container.name(), precision.name())
            }
            Self::Compact(container) => f.write_str(container.name()),
        }
    }
}

impl FromStr for Export {
    type Err = UnknownExport;

    fn from_str(text: &str) -> Result<Self, UnknownExport> {
        let textures = || {
            let mut parts = text.split('.');
            let layout = TextureLayout::from_name(parts.next()?)?;
            let container = TextureContainer::from_name(parts.next()?)?;
            let precision = Precision::from_name(parts.next()?)?;
            parts.next().is_none().then_some(Self::Textures { layout, container, precision })
        };
        let engine = Engine::from_name(text).map(Self::Engine);
        let compact = || CompactContainer::from_name(text).map(Self::Compact);
        engine.or_else(compact).or_else(textures).ok_or_else(|| UnknownExport(text.to_owned()))
    }
}

#[cfg(test)]
mod tests {
    use std::{collections::BTreeSet, ops::ControlFlow};

    use super::*;
    use crate::{
        files::{
            compact::tests::{planted, unmeasured},
            digest::Digest,
            recipe_document,
        },
        fit::{Layout, Plan, fit_plan},
    };

    fn table(document: &str) -> Table {
        let recipe = recipe_document::parse(document.as_bytes(), 10_000).expect("a recipe");
        fit_plan(&Plan::new(&recipe), &|_| ControlFlow::Continue(())).expect("a table")
    }

    #[test]
    fn a_name_is_that_of_one_export() {
        let all: Vec<Export> = Export::all().collect();
        let names: BTreeSet<String> = all.iter().map(ToString::to_string).collect();
        assert_eq!(names.len(), all.len());
        assert!(all.iter().all(|export| export.to_string().parse() == Ok(*export)));
        for wrong in
            ["", "unity", "ltc2017", "ltc2017.ktx2", "ltc2017.ktx2.f64", "ltc2017.ktx2.f16.", "Three", "compact.f16"]
        {
            let error = wrong.parse::<Export>().expect_err(wrong).to_string();
            assert!(
                error.contains(&format!("«{wrong}»")) && error.contains("ktx2-zstd") && error.contains("compact-wgsl"),
                "{error}"
            );
        }
    }

    #[test]
    fn matrices_without_an_inverse_are_counted_and_the_first_is_named() {
        let mut table = planted(Layout::Reflected, [3, 2, 3, 2], true, |_, _| 0.0);
        for entry in [9, 4] {
            table.matrix[entry] = [1.0, 2.0, 3.0, 2.0, 4.0, 6.0, 0.0, 0.0, 1.0];
        }
        for name in ["wgpu", "reflected.npy.f16", "compact"] {
            let export: Export = name.parse().expect("an export");
            let error = export.bundle(&table, About::default()).expect_err(name);
            assert!(matches!(error, ExportError::Singular { count: 2, entry: 4, .. }), "{name}: {error}");
            assert_eq!(export.layout(&table), Err(error));
        }
    }

    /// An engine would light its highlights with a table of sheen; our own shader and plain textures serve any model.
    #[test]
    fn engines_are_given_no_tables_but_those_of_ggx() {
        let mut table = table(r#"{"layout": "godot", "resolution": {"alpha": 2, "theta": 2}}"#);
        table.brdf = BrdfKind::Charlie.into();
        let export = |name: &str| name.parse::<Export>().expect("an export");
        let refused = export("godot").layout(&table).expect_err("not of GGX").to_string();
        assert!(refused.contains("brdf charlie") && refused.contains("--layout godot"), "{refused}");
        let refused = export("compact").layout(&table).expect_err("not near a reflection").to_string();
        assert!(refused.contains("brdf charlie"), "{refused}");
        assert!(export("wgpu").layout(&table).is_ok() && export("godot.ktx2.f32").layout(&table).is_ok());
    }

    /// Engines and decoders light by LTCs. The numbers alone are for a shader that lights by Gaussians.
    #[test]
    fn engines_and_decoders_are_given_no_gaussians() {
        let small =
            r#"{"resolution":{"alpha":2,"ratio":2,"theta":2,"phi":2},"fit":{"samples":64,"directions":4,"steps":5}}"#;
        let table = Table { lobe: crate::fit::LobeModel::Asg, ..table(small) };
        let export = |name: &str| name.parse::<Export>().expect("an export");
        for name in ["wgpu", "compact"] {
            let refused = export(name).layout(&table).expect_err("no LTCs").to_string();
            assert!(refused.contains("lobe asg"), "{name}: {refused}");
        }
        assert!(export("reflected.ktx2.f32").layout(&table).is_ok());
    }

    #[test]
    fn a_table_that_cannot_serve_is_told_which_recipe_does() {
        let fit = r#""fit":{"samples":64,"directions":4,"steps":5}"#;
        let own = table(&format!(r#"{{"resolution":{{"alpha":2,"ratio":2,"theta":2,"phi":2}},{fit}}}"#));
        let small = table(&format!(r#"{{"layout":"ltc2017","resolution":{{"alpha":2,"theta":2}},{fit}}}"#));
        let theirs =
            table(&format!(r#"{{"layout":"kt2022","resolution":{{"alpha":2,"ratio":2,"theta":2,"phi":2}},{fit}}}"#));
        let godot = table(&format!(r#"{{"layout":"godot","resolution":{{"alpha":2,"theta":2}},{fit}}}"#));
        let refusal = |name: &str, table: &Table| {
            let export: Export = name.parse().expect("an export");
            export.bundle(table, About::default()).expect_err(name)
        };
        for (name, table, recipe) in [
            ("three", &own, r#"{"layout": "ltc2017"}"#),
            ("kt2022.dds.f32", &own, r#"{"layout": "kt2022"}"#),
            ("ltc2016-3d.ktx2.f32", &small, r#"{"layout": "ltc2016"}"#),
            ("three", &small, r#"{"layout": "ltc2017"}"#),
            ("compact-rust", &theirs, r#"{"layout": "reflected"}"#),
            ("compact", &godot, r#"{"layout": "ltc2017"}"#),
        ] {
            let refused = refusal(name, table);
            assert_eq!(refused.recipe(), Some(recipe), "{name}: {refused}");
            assert!(refused.to_string().contains(recipe), "{name}: {refused}");
        }
        for name in ["wgpu", "reflected.npz.f16", "compact-wgsl"] {
            let export: Export = name.parse().expect("an export");
            assert!(!export.bundle(&own, About::default()).expect(name).files.is_empty());
        }
        for table in [&small, &theirs, &godot] {
            let wgpu: Export = "wgpu".parse().expect("an export");
            assert_eq!(wgpu.bundle(table, About::default()).expect("every layout").files.len(), 5);
        }
    }

    #[test]
    fn every_export_has_a_manifest_of_its_files() {
        let table = planted(Layout::Reflected, [3, 2, 3, 2], true, |_, _| 0.0);
        for name in ["wgpu", "reflected.npy.f16", "reflected.dds.f32", "reflected.npz.f16", "compact", "compact-rust"] {
            let export: Export = name.parse().expect("an export");
            let about = About::new(["table 1234"]);
            // Nobody measures a planted table.
            let made = match export {
                Export::Compact(container) => Export::compact_bundle(container, unmeasured(&table), &about),
                Export::Engine(_) | Export::Textures { .. } => export.bundle(&table, about),
            };
            let Bundle { files, steps } = made.expect(name);
            let (manifest, others) = files.split_last().expect("files");
            assert_eq!(manifest.path, "ltcforge.json", "{name}");
            let manifest: serde_json::Value = serde_json::from_slice(&manifest.bytes).expect("JSON");
            let key = if name == "wgpu" { "for" } else { "export" };
            assert_eq!((&manifest[key], &manifest["about"][0]), (&name.into(), &"table 1234".into()));
            assert_eq!(manifest["steps"], serde_json::json!(steps), "{name}");
            assert_eq!(manifest["files"].as_array().map(Vec::len), Some(others.len()), "{name}");
            for (told, file) in manifest["files"].as_array().expect("files").iter().zip(others) {
                assert_eq!((&told["path"], &told["bytes"]), (&file.path.as_str().into(), &file.bytes.len().into()));
                assert_eq!(told["sha256"], Digest::of(&file.bytes).hex(), "{name}: {}", file.path);
                assert_eq!(told["rounding"], serde_json::json!(file.rounding), "{name}: {}", file.path);
            }
        }
    }

    /// The texels of a KTX2 file with four channels of 32 bits, and its sides.
    fn texels(bundle: &Bundle, path: &str) -> ([usize; 3], Vec<f32>) {
        let file = bundle.files.iter().find(|file| file.path == path).expect(path);
        let reader = ktx2::Reader::new(&file.bytes).expect("KTX2");
        let header = reader.header();
        assert_eq!(header.format, Some(ktx2::Format::R32G32B32A32_SFLOAT));
        let sides = [header.pixel_width, header.pixel_height, header.pixel_depth].map(|side| side as usize);
        let data = reader.levels().next().expect("a level").data;
        (sides, data.as_chunks::<4>().0.iter().map(|x| f32::from_le_bytes(*x)).collect())
    }

    #[test]
    fn our_shader_finds_every_number_of_a_table_of_every_layout() {
        for &layout in Layout::ALL {
            let sides = match layout.only_ranges() {
                Some(_) => r#"{"alpha":3,"theta":2}"#,
                None => r#"{"alpha":3,"ratio":2,"theta":2,"phi":3}"#,
            };
            let fit = r#""fit":{"samples":64,"directions":4,"steps":5}"#;
            let table = table(&format!(r#"{{"layout":"{layout}","resolution":{sides},{fit}}}"#));
            let bundle = Export::Engine(Engine::Wgpu).bundle(&table, About::default()).expect("textures");
            let [a, b, terms] =
                ["ltc_matrix_a", "ltc_matrix_b", "ltc_terms"].map(|name| texels(&bundle, &format!("{name}.ktx2")));
            let counts = table.axes.lengths();
            assert_eq!(a.0, [counts.phi, counts.ratio * counts.theta, counts.alpha], "{layout}");
            assert!(a.0 == b.0 && a.0 == terms.0, "{layout}");
            // As the shader does: texel (p, r * theta_nodes + t, a).
            let at = |(sides, texels): &([usize; 3], Vec<f32>), [x, y, z]: [usize; 3]| -> [f32; 4] {
                let start = 4 * ((z * sides[1] + y) * sides[0] + x);
                texels[start..start + 4].try_into().expect("a texel")
            };
            let own = table.terms.as_ref().expect("terms");
            let mut entry = 0;
            for alpha in 0..counts.alpha {
                for row in 0..counts.ratio * counts.theta {
                    for phi in 0..counts.phi {
                        let [a, b, terms] = [&a, &b, &terms].map(|texture| at(texture, [phi, row, alpha]));
                        assert_eq!([&a[..], &b[..], &terms[..1]].concat(), table.matrix[entry], "{layout}, {entry}");
                        assert_eq!(terms[1..3], [own.amplitude()[entry], own.fresnel()[entry]], "{layout}, {entry}");
                        entry += 1;
                    }
                }
            }
            assert_eq!(entry, table.matrix.len(), "{layout}");
        }
    }
}
