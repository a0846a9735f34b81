//! The calls of a program or build script: build a recipe, fit it once, and write the needed files.

use std::{
    error::Error,
    fs,
    ops::ControlFlow,
    sync::atomic::{AtomicU64, Ordering},
};

use ltcforge::{
    Configuration, Digest, Fit, Layout, LobeModel, Preset, Recipe, RecipeBuilder, RecipeDocument as _, TableFile,
    glam::DMat3,
};

type Result = std::result::Result<(), Box<dyn Error>>;

/// The digest that `tests/cli/same_bytes.rs` pins for the command.
const PINNED_DIGEST: &str = "sha256:2c3d0be191fa318bae02c01a19581ccfd5ffe169f39cf14adc6ab35065d221d3";
const PINNED_GAUSSIANS: [(LobeModel, &str); 2] = [
    (LobeModel::Sg, "sha256:3f719fc926b56fa7c427aa842ea95aee574242605683c00d634ed8b246fbf74b"),
    (LobeModel::Asg, "sha256:82ca1d11e86d7361f151d7fed723c6f913bb8d1e8405bb61b556b9c5c6a7dc37"),
];
/// Entries of [`small`].
const ENTRIES: u64 = 3 * 3 * 4 * 3;

fn small() -> RecipeBuilder {
    let axes = [("alpha", 3), ("ratio", 3), ("theta", 4), ("phi", 3)];
    let builder = Recipe::builder().preset(Preset::Draft).samples(128).seed(1);
    axes.into_iter().fold(builder, |builder, (axis, nodes)| builder.resolution(axis, nodes))
}

#[test]
fn the_bytes_of_a_written_table_are_pinned() -> Result {
    let table = ltcforge::fit(&small().build()?)?;
    let bytes = table.to_bytes()?;
    assert_eq!(Digest::of(&bytes).to_string(), PINNED_DIGEST);
    assert_eq!(TableFile::from_bytes(&bytes)?, table);
    let folder = tempfile::tempdir()?;
    let (digest, path) = ltcforge::write_table(&table, folder.path().join("tables"))?;
    assert_eq!(digest.to_string(), PINNED_DIGEST);
    assert_eq!(fs::read(path)?, bytes);
    Ok(())
}

#[test]
fn the_bytes_of_gaussians_are_pinned() -> Result {
    for (lobe, pinned) in PINNED_GAUSSIANS {
        let table = ltcforge::fit(&small().lobe(lobe).build()?)?;
        assert_eq!(Digest::of(&table.to_bytes()?).to_string(), pinned, "{lobe:?}");
    }
    Ok(())
}

#[test]
fn a_cached_table_is_not_fitted_again() -> Result {
    let (recipe, folder) = (small().build()?, tempfile::tempdir()?);
    let table = ltcforge::cached(&recipe, folder.path())?;
    // A second fit would replace the file and its modification time.
    let kept = folder.path().join(format!("{}.safetensors", recipe.digest().hex()));
    let long_ago = std::time::SystemTime::UNIX_EPOCH;
    fs::File::options().write(true).open(&kept)?.set_modified(long_ago)?;
    assert_eq!(ltcforge::cached(&recipe, folder.path())?, table);
    assert_eq!(fs::metadata(&kept)?.modified()?, long_ago);
    Ok(())
}

#[test]
fn a_fit_reports_progress_and_can_be_stopped() -> Result {
    let recipe = small().build()?;
    let most = AtomicU64::new(0);
    let watched = Fit::new(&recipe).progress(|done| {
        most.fetch_max(done, Ordering::Relaxed);
        ControlFlow::Continue(())
    });
    assert_eq!(Digest::of(&watched.run()?.to_bytes()?).to_string(), PINNED_DIGEST);
    assert_eq!(most.into_inner(), ENTRIES);

    let stopped =
        Fit::new(&recipe).progress(|done| if done < 9 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) });
    assert!(matches!(stopped.run(), Err(ltcforge::Error::Stopped)));
    Ok(())
}

#[test]
fn a_table_is_looked_up_measured_and_read_by_a_shader() -> Result {
    let file = ltcforge::fit(&small().build()?)?;
    let found = file.table().lookup(&Configuration { alpha_x: 0.5, alpha_y: 0.25, theta: 0.7, phi: 0.3 });
    assert!(DMat3::from_cols_array(&found.matrix).determinant() > 0.0, "{found:?}");
    let error = file.measure()?.between.width.mean;
    assert!(error > 0.0 && error < 1.0, "{error}");
    let shader = ltcforge::wgsl(Layout::Reflected);
    assert!(shader.contains("fn ltc_lookup(") && shader.contains("fn ltc_restore("));
    Ok(())
}

#[test]
fn an_invalid_recipe_lists_every_fault() {
    let faults = Recipe::builder().samples(1).resolution("beta", 2).build().expect_err("two faults").to_string();
    assert!(faults.contains("/fit/samples") && faults.contains("/resolution/beta"), "{faults}");
}
