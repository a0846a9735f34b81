//! Fits on all cores.

use std::{fmt, num::NonZeroUsize, ops::ControlFlow};

use super::Error;
use ltcforge_files::container::{TableFile, TableFileError};
use ltcforge_fit::{Plan, Progress, Recipe, fit_plan};

/// Fits a recipe on all cores: [`Fit`] with its defaults.
///
/// # Errors
/// [`Error::Threads`].
pub fn fit(recipe: &Recipe) -> Result<TableFile, Error> {
    Fit::new(recipe).run()
}

/// A fit and its settings. Neither threads nor progress change the table.
#[must_use]
pub struct Fit<'a> {
    recipe: &'a Recipe,
    threads: Option<NonZeroUsize>,
    progress: Option<Box<Progress<'a>>>,
}

impl fmt::Debug for Fit<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("Fit").field("recipe", self.recipe).field("threads", &self.threads).finish_non_exhaustive()
    }
}

impl<'a> Fit<'a> {
    /// A fit on all cores, without progress.
    pub fn new(recipe: &'a Recipe) -> Self {
        Self { recipe, threads: None, progress: None }
    }

    /// The number of threads. The default is the number of cores.
    pub fn threads(mut self, threads: NonZeroUsize) -> Self {
        self.threads = Some(threads);
        self
    }

    /// A callback that gets the number of finished entries, out of [`Recipe::entries`], and may stop the fit. Several
    /// threads call it.
    pub fn progress(mut self, progress: impl Fn(u64) -> ControlFlow<()> + Sync + 'a) -> Self {
        self.progress = Some(Box::new(progress));
        self
    }

    /// Runs the fit to its end.
    ///
    /// # Errors
    /// [`Error::Stopped`] when the progress callback stops the fit, [`Error::Threads`], and [`Error::Table`] for a
    /// recipe without the file of its tabulated BRDF.
    pub fn run(self) -> Result<TableFile, Error> {
        if !self.recipe.model().is_complete() {
            let missing = "a recipe that was read from a table has no BRDF file; build the recipe again".to_owned();
            return Err(TableFileError::Brdf(missing).into());
        }
        let threads = self.threads.map_or(0, NonZeroUsize::get);
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build();
        let pool = pool.map_err(|error| Error::Threads(error.to_string()))?;
        let go_on = |_| ControlFlow::Continue(());
        let progress: &Progress = self.progress.as_deref().unwrap_or(&go_on);
        let table = pool.install(|| fit_plan(&Plan::new(self.recipe), progress)).ok_or(Error::Stopped)?;
        Ok(TableFile { recipe: self.recipe.clone(), table })
    }
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicU64, Ordering};

    use super::{super::RecipeDocument as _, *};
    use ltcforge_fit::{Layout, Metric, Solver, Start};

    fn small() -> Recipe {
        let axes = ["alpha", "ratio", "theta", "phi"];
        let builder = axes.into_iter().fold(Recipe::builder(), |builder, axis| builder.resolution(axis, 3));
        builder.samples(32).directions(4).steps(3).build().expect("a recipe")
    }

    #[test]
    fn progress_counts_every_entry_and_threads_change_nothing() {
        let recipe = small();
        let most = AtomicU64::new(0);
        let one = Fit::new(&recipe).threads(NonZeroUsize::MIN).progress(|done| {
            most.fetch_max(done, Ordering::Relaxed);
            ControlFlow::Continue(())
        });
        assert_eq!(one.run().expect("a table"), fit(&recipe).expect("a table"));
        assert_eq!(most.into_inner(), recipe.entries());
    }

    /// Any thread can fit any row. Within a row, each search starts from the result of the previous search.
    #[test]
    fn warm_starts_give_the_same_table_on_any_number_of_threads() {
        let builder = Recipe::builder().layout(Layout::Godot).resolution("alpha", 6).resolution("theta", 7);
        let builder = builder.metric(Metric::L3).solver(Solver::NelderMead).start(Start::Warm);
        let recipe = builder.samples(64).directions(4).steps(20).build().expect("a recipe");
        let on = |threads: usize| {
            let threads = NonZeroUsize::new(threads).expect("not zero");
            Fit::new(&recipe).threads(threads).run().expect("a table")
        };
        assert_eq!(on(1), on(2));
    }

    #[test]
    fn progress_can_stop_the_fit() {
        let recipe = small();
        let stopped = Fit::new(&recipe)
            .progress(|done| if done < 5 { ControlFlow::Continue(()) } else { ControlFlow::Break(()) });
        assert!(matches!(stopped.run(), Err(Error::Stopped)));
    }
}
