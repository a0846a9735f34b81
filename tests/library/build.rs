//! A program that needs a table at build time: it builds a recipe, fits it once, and writes the files that it needs.

use std::{
    env,
    error::Error,
    fs,
    ops::ControlFlow,
    os::unix::fs::MetadataExt,
    path::PathBuf,
    sync::atomic::{AtomicU64, Ordering},
};

use ltcforge::{
    Configuration, Digest, Fit, Layout, LobeModel, Preset, Recipe, RecipeDocument as _, TableFile, glam::DMat3,
};

fn main() -> Result<(), Box<dyn Error>> {
    println!("cargo::rerun-if-changed=build.rs");
    let out = PathBuf::from(env::var_os("OUT_DIR").ok_or("cargo sets OUT_DIR")?);

    let axes = [("alpha", 3), ("ratio", 3), ("theta", 4), ("phi", 3)];
    let builder = Recipe::builder().preset(Preset::Draft).samples(128).seed(1);
    let builder = axes.into_iter().fold(builder, |builder, (axis, nodes)| builder.resolution(axis, nodes));
    let recipe = builder.clone().build()?;

    // An invalid recipe is an error that lists every fault.
    let refused = Recipe::builder().samples(1).resolution("beta", 2).build();
    let faults = refused.err().ok_or("it has two faults")?.to_string();

    let table = ltcforge::cached(&recipe, &out)?;
    let bytes = table.to_bytes()?;
    // A second call reads the file: it leaves it as it is, where a fit would write it anew.
    let kept = out.join(format!("{}.safetensors", recipe.digest().hex()));
    let written = fs::metadata(&kept)?.ino();
    let hit = ltcforge::cached(&recipe, &out)? == table && fs::metadata(&kept)?.ino() == written;

    // The same with progress, on as many threads as there are cores; and once stopped half-way.
    let most = AtomicU64::new(0);
    let watched = Fit::new(&recipe).progress(|done| {
        most.fetch_max(done, Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    let same = watched.run()? == table && TableFile::from_bytes(&bytes)? == table;
    let stopped =
        Fit::new(&recipe).progress(|done| if done < 9 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) });
    let stopped = matches!(stopped.run(), Err(ltcforge::Error::Stopped));

    // Gaussians in place of Linearly Transformed Cosines.
    let gaussians = |lobe| -> Result<Digest, Box<dyn Error>> {
        Ok(Digest::of(&ltcforge::fit(&builder.clone().lobe(lobe).build()?)?.to_bytes()?))
    };
    let gaussians = [gaussians(LobeModel::Sg)?, gaussians(LobeModel::Asg)?].map(|digest| digest.to_string());

    let found = table.table().lookup(&Configuration { alpha_x: 0.5, alpha_y: 0.25, theta: 0.7, phi: 0.3 });
    let determinant = DMat3::from_cols_array(&found.matrix).determinant();
    let error = table.measure().expect("a report").between.width.mean;
    let (digest, path) = ltcforge::write_table(&table, out.join("tables"))?;
    fs::write(out.join("ltc.wgsl"), ltcforge::wgsl(Layout::Reflected))?;

    let facts = format!(
        "/// Digest of the table.\npub const DIGEST: &str = \"{}\";\n\
        /// Digests of the same tables of Gaussians, round and stretched.\npub const GAUSSIANS: [&str; 2] = {gaussians:?};\n\
        /// Entries that the progress callback was told of.\npub const ENTRIES: u64 = {};\n\
        /// Whether all ways to the table gave the same one.\npub static SAME: bool = {};\n\
        /// Whether a cached table was read rather than fitted again.\npub static HIT: bool = {hit};\n\
        /// Whether the callback stopped the fit.\npub static STOPPED: bool = {stopped};\n\
        /// Determinant of a matrix.\npub static DETERMINANT: f64 = {determinant:?};\n\
        /// Mean error between nodes, in lobe widths.\npub static ERROR: f64 = {error:?};\n\
        /// What an invalid recipe says.\npub const FAULTS: &str = {faults:?};\n",
        Digest::of(&bytes),
        most.into_inner(),
        same && digest == Digest::of(&bytes) && fs::read(path)? == bytes,
    );
    fs::write(out.join("facts.rs"), facts)?;
    fs::write(out.join("table.safetensors"), bytes)?;
    Ok(())
}
