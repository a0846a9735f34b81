//! ltcforge makes lookup tables with which renderers light glossy surfaces by area lights. The tables hold Linearly
//! Transformed Cosines. A fit to the GGX lobe takes seconds, and gives the same bytes on every machine.
//!
//! A program that only needs a table uses the core, without any feature:
//!
//! ```toml
//! ltcforge = { path = "../ltcforge", default-features = false }
//! ```
//!
//! # From a recipe to a table
//!
//! ```
//! # fn main() -> Result<(), Box<dyn std::error::Error>> {
//! use ltcforge::{Configuration, Layout, Preset, Recipe, RecipeDocument as _};
//!
//! // A recipe decides every byte of a table. `build` lists all errors of a recipe.
//! let recipe = Recipe::builder()
//!     .preset(Preset::Draft)
//!     .isotropic()
//!     .resolution("alpha", 8)
//!     .resolution("theta", 8)
//!     .build()?;
//!
//! // Fitted on all cores; the next call with this recipe reads the file.
//! let folder = tempfile::tempdir()?;
//! let file = ltcforge::cached(&recipe, folder.path())?;
//!
//! // `M` for a surface and a view direction, row-major, as a shader gets it.
//! let seen = Configuration { alpha_x: 0.3, alpha_y: 0.3, theta: 0.8, phi: 0.0 };
//! let lobe = file.table().lookup(&seen);
//! println!("{:?}, reflectance {:?}", lobe.matrix, lobe.amplitude);
//!
//! // The accuracy: the mean error between nodes, relative to the lobe's width.
//! let report = file.measure()?;
//! assert!(report.between.width.mean < 0.1);
//!
//! // The table and its manifest as files, named by the table's digest, and the shader that reads them.
//! let (digest, path) = ltcforge::write_table(&file, folder.path())?;
//! println!("{digest} in {}", path.display());
//! std::fs::write(folder.path().join("ltc.wgsl"), ltcforge::wgsl(Layout::Reflected))?;
//! # Ok(())
//! # }
//! ```
//!
//! [`fit()`] fits without a folder. [`Fit`] also sets the number of threads, reports progress and can be stopped. In a
//! build script, [`cached`] with `OUT_DIR` as the folder fits only once. They all return [`Error`] if they fail.
//!
//! # Light without a table
//!
//! [`light()`] computes in closed form the light that GGX reflects from a polygon, or from a [`light::ShapedLight`]: a
//! disk, sphere, tube or line. [`mod@light`] also has the truth by quadrature.
//!
//! ```
//! # fn main() -> Result<(), ltcforge::Error> {
//! use ltcforge::{Configuration, Sides, glam::DVec3, light};
//!
//! // A lamp of 1 x 0.4 in the tangent frame around the shaded point. It emits to the side of `half[0] x half[1]`.
//! let (centre, half) = (DVec3::new(-0.8, 0.1, 1.0), [0.2 * DVec3::Y, 0.5 * DVec3::X]);
//! let lamp = light::rectangle(centre, half, Sides::One)?;
//!
//! let seen = Configuration { alpha_x: 0.3, alpha_y: 0.1, theta: 0.8, phi: 0.0 };
//! let reflected = ltcforge::light(&seen, &lamp)?;
//! println!("iron reflects {} of a white lamp", reflected.schlick(0.56, 1.0));
//!
//! let truth = light::truth(&seen, &lamp)?;
//! assert!((reflected.energy - truth.energy).abs() < 0.01);
//! # Ok(())
//! # }
//! ```
//!
//! # Features
//!
//! | feature | adds |
//! |---|---|
//! | none | recipes, fits, tables, reports, files, the shader in WGSL |
//! | `shaders` | [`translate`]: the shader in GLSL, HLSL, MSL and SPIR-V (naga) |
//! | `textures` | [`textures`]: tables as files for engines, pictures on lights (ddsfile, exr, png, rawzip, ruzstd, zune-jpeg) |
//! | `render` | [`view`]: previews on a GPU or the CPU, plots, the trade-off (wgpu, png); includes the two above |
//! | `client` | [`client`]: requests to a service, and the lock file (ureq) |
//! | `server` | [`server`], on Unix: the HTTP service, its queue and store (axum, tokio, sled); includes `render` |
//! | `cli`, the default | [`cli`]: the commands (clap), and the binary `ltcforge`; includes all features above |
//! | `cluster` | several processes on one PostgreSQL and one object store (tokio-postgres, `object_store`) |
//!
//! # Crates
//!
//! Each module of the crate is also a separate crate, such as `ltcforge-fit`. [`mod@fit`] is the core: equal arguments
//! give equal bytes on every machine. [`mod@light`] has the models of light and the truth, [`files`] has documents and
//! containers, and [`shaders`] has the WGSL code. The other crates build on them. Vectors and matrices in signatures
//! come from [`glam`].

mod library;

#[cfg(feature = "cli")]
pub use ltcforge_cli as cli;
#[cfg(feature = "client")]
pub use ltcforge_client as client;
pub use ltcforge_files as files;
pub use ltcforge_fit as fit;
pub use ltcforge_light as light;
#[cfg(all(unix, feature = "server"))]
pub use ltcforge_server as server;
pub use ltcforge_shaders as shaders;
#[cfg(feature = "textures")]
pub use ltcforge_textures as textures;
#[cfg(feature = "shaders")]
pub use ltcforge_translate as translate;
#[cfg(feature = "render")]
pub use ltcforge_view as view;

pub use files::{
    container::{TableFile, TableFileError},
    digest::Digest,
    recipe_document::{Fault, Preset, RecipeError},
};
pub use fit::{
    BrdfKind, BrdfModel, Configuration, Layout, LobeModel, LookedUp, Metric, PerAxis, Precision, Recipe, Report,
    SecondLobe, Shear, Sides, Solver, Start, Table, WeightedF0,
};
pub use glam;
#[cfg(feature = "textures")]
pub use library::light_pyramid;
#[cfg(feature = "shaders")]
pub use library::shader;
pub use library::{
    Error, Fit, RecipeBuilder, RecipeDocument, cached, fit, light, light_by_table, light_by_table_above, write_table,
};
pub use light::{LightError, LightModel, PolygonLight, ReflectedLight};
pub use shaders::{Language, LitBy, wgsl};
