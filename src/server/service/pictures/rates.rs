//! The rate of each kind of renderer.

use std::time::Instant;

use super::{
    picture::{CPU, Subject},
    rate::{Rate, Took},
};
use ltcforge_view::preview::Adapter;

/// What renders a picture, as far as its time depends on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum RendererKind {
    /// A scene on a GPU.
    Gpu,
    /// A scene on the CPU.
    Cpu,
    /// A plot, which the CPU draws.
    Plot,
}

/// A rate for each kind.
#[derive(Debug)]
pub(super) struct Rates {
    gpu: Rate,
    cpu: Rate,
    plot: Rate,
}

impl RendererKind {
    /// What will render a picture. `last` rendered the last scene. Before the first one a GPU is expected, unless
    /// `adapter` excludes it.
    pub(super) fn expected(subject: &Subject, last: Option<&str>, adapter: Adapter) -> Self {
        match (subject, last) {
            (Subject::Plot(_), _) => Self::Plot,
            (Subject::Scene(_), Some(name)) => Self::of_scene(name),
            (Subject::Scene(_), None) if adapter == Adapter::Cpu => Self::Cpu,
            (Subject::Scene(_), None) => Self::Gpu,
        }
    }

    /// The kind of the adapter that rendered a scene.
    pub(super) fn of_scene(adapter: &str) -> Self {
        if adapter == CPU { Self::Cpu } else { Self::Gpu }
    }
}

impl Rates {
    pub(super) fn new(now: Instant) -> Self {
        let rate = Rate::new(now);
        Self { gpu: rate, cpu: rate, plot: rate }
    }

    /// Predicted seconds of a picture.
    pub(super) fn seconds(&self, kind: RendererKind, cost: f64, now: Instant) -> f64 {
        self.rate(kind).seconds(cost, now)
    }

    /// Whether a kind was measured.
    pub(super) fn is_known(&self, kind: RendererKind) -> bool {
        self.rate(kind).is_known()
    }

    /// Takes a measurement into account.
    pub(super) fn learn(&mut self, kind: RendererKind, cost: f64, took: Took, now: Instant) {
        self.rate_mut(kind).learn(cost, took, now);
    }

    /// Sets what a probe measured.
    pub(super) fn set_probed(&mut self, kind: RendererKind, rate: f64, now: Instant) {
        *self.rate_mut(kind) = Rate::probed(rate, now);
    }

    fn rate(&self, kind: RendererKind) -> &Rate {
        match kind {
            RendererKind::Gpu => &self.gpu,
            RendererKind::Cpu => &self.cpu,
            RendererKind::Plot => &self.plot,
        }
    }

    fn rate_mut(&mut self, kind: RendererKind) -> &mut Rate {
        match kind {
            RendererKind::Gpu => &mut self.gpu,
            RendererKind::Cpu => &mut self.cpu,
            RendererKind::Plot => &mut self.plot,
        }
    }
}

#[cfg(test)]
mod tests {
    use std::time::Duration;

    use super::*;
    use ltcforge_view::plots::Plot;

    #[test]
    fn each_kind_has_a_rate_of_its_own() {
        let now = Instant::now();
        let scene = Subject::Scene(Box::default());
        let kind = |last, adapter| RendererKind::expected(&scene, last, adapter);
        assert_eq!(kind(None, Adapter::Any), RendererKind::Gpu);
        assert_eq!(kind(None, Adapter::Cpu), RendererKind::Cpu);
        assert_eq!(kind(Some("cpu"), Adapter::Any), RendererKind::Cpu);
        assert_eq!(kind(Some("llvmpipe"), Adapter::Any), RendererKind::Gpu);
        let plot = Subject::Plot(Plot::Matrix);
        assert_eq!(RendererKind::expected(&plot, Some("llvmpipe"), Adapter::Any), RendererKind::Plot);

        let all = [RendererKind::Gpu, RendererKind::Cpu, RendererKind::Plot];
        for learned in all {
            let mut rates = Rates::new(now);
            let before = rates.seconds(learned, 1e9, now);
            rates.learn(learned, 1e9, Took::Finished(Duration::from_secs(100)), now);
            for kind in all {
                assert_eq!(rates.seconds(kind, 1e9, now) != before, kind == learned, "{kind:?} {learned:?}");
            }
        }
    }
}
