//! Clips an outline of arcs with a circle.

#![allow(clippy::neg_cmp_op_on_partial_ord, reason = "NaN counts as what the comparison denies")]

use super::arc::{Arc, ArcKind, Circle, Extent};
use ltcforge_fit::math::{Scalar, Triple, cross, dot, minus, plus, scaled, unit};

/// Rounding tolerance of an arc's angle. A short arc that ends behind its start by less than this is empty. A wide arc
/// that ends less than this after its start goes all around.
const BEHIND: f64 = 1.5;
/// The angle from an exit to an entry above which the two can be the same point, up to rounding.
const ALL_AROUND: f64 = 6.0;

/// The part of an outline on the inner side of a circle, closed along the circle by arcs of a given kind. `is_in`
/// returns true for directions in the region of the outline.
///
/// Each arc is cut where it enters and leaves the circle. The gaps are closed along the circle: each exit leads to the
/// next entry, counterclockwise about the circle's axis.
pub(super) fn clip<T: Scalar>(
    arcs: &[Arc<T>],
    circle: Circle<T>,
    kind: ArcKind,
    is_in: impl Fn(Triple<T>) -> bool,
) -> Vec<Arc<T>> {
    // If the circle is a point, nothing is outside of it, or nothing is inside.
    if !(circle.offset.abs() < T::ONE - T::UNCERTAINTY) {
        return if circle.offset > T::ZERO { Vec::new() } else { arcs.to_vec() };
    }
    let mut cut = Cut { circle, kept: Vec::with_capacity(arcs.len() + 2), exits: Vec::new(), entries: Vec::new() };
    for arc in arcs {
        cut.add(arc);
    }
    if cut.exits.is_empty() {
        let start = circle.start();
        if is_in(start) {
            cut.kept.push(Arc { circle, from: start, to: start, kind, extent: Extent::Whole });
        }
        return cut.kept;
    }
    for from in &cut.exits {
        let (to, extent) = cut.next_entry(*from);
        cut.kept.push(Arc { circle, from: *from, to, kind, extent });
    }
    cut.kept
}

/// The state of a clip.
struct Cut<T> {
    circle: Circle<T>,
    kept: Vec<Arc<T>>,
    exits: Vec<Triple<T>>,
    entries: Vec<Triple<T>>,
}

/// A point on an arc: its direction, and its angle from the start.
type ArcPoint<T> = (Triple<T>, T);

impl<T: Scalar> Cut<T> {
    /// Keeps the part of an arc that is inside.
    fn add(&mut self, arc: &Arc<T>) {
        // Ends that an earlier clip put on the circle count as inside.
        let is_in = |w: Triple<T>| self.circle.depth(w) > -T::of(4.0) * T::UNCERTAINTY;
        let ends = (is_in(arc.from), is_in(arc.to));
        let Some(crossing) = Crossing::new(arc, &self.circle) else {
            self.add_uncrossed(arc, ends);
            return;
        };
        let track = Track::new(arc);
        let (along, half) = (|w| track.along(w), crossing.half_angle);
        let (start, end) = ((arc.from, T::ZERO), (arc.to, track.end));
        match ends {
            (true, true) => {
                let farthest = along(crossing.farthest);
                let beyond = T::of(0.5) * T::TAU - half;
                if farthest < track.end {
                    self.keep(arc, start, track.snapped_within(crossing.exit, farthest - beyond), [false, true]);
                    self.keep(arc, track.snapped_within(crossing.entry, farthest + beyond), end, [true, false]);
                } else {
                    self.kept.push(*arc);
                }
            }
            (false, false) => {
                let nearest = along(crossing.nearest);
                if nearest < track.end {
                    let from = track.snapped_within(crossing.entry, nearest - half);
                    let to = track.snapped_within(crossing.exit, nearest + half);
                    self.keep(arc, from, to, [true, true]);
                }
            }
            (true, false) => self.keep(arc, start, track.snapped(crossing.exit), [false, true]),
            (false, true) => self.keep(arc, track.snapped(crossing.entry), end, [true, false]),
        }
    }

    /// Handles an arc whose circle does not cross the clipping circle. It is inside or outside as a whole; ends that
    /// differ are rounding errors.
    fn add_uncrossed(&mut self, arc: &Arc<T>, ends: (bool, bool)) {
        let is_kept = match ends {
            (true, true) => true,
            (false, false) => false,
            _ => self.circle.depth(arc.middle()) > T::ZERO,
        };
        if is_kept {
            self.kept.push(*arc);
        }
        match (ends, is_kept) {
            ((true, false), true) => self.exits.push(arc.to),
            ((true, false), false) => self.exits.push(arc.from),
            ((false, true), true) => self.entries.push(arc.from),
            ((false, true), false) => self.entries.push(arc.to),
            _ => {}
        }
    }

    /// Keeps a piece of an arc. `[enters, exits]` is true for ends that are on the circle.
    fn keep(&mut self, arc: &Arc<T>, (from, start): ArcPoint<T>, (to, end): ArcPoint<T>, [enters, exits]: [bool; 2]) {
        if enters {
            self.entries.push(from);
        }
        if exits {
            self.exits.push(to);
        }
        if end > start {
            let extent = if end - start > T::of(0.5) * T::TAU { Extent::Wide } else { Extent::Short };
            self.kept.push(Arc { from, to, extent, ..*arc });
        }
    }

    /// The next entry counterclockwise from an exit, and the extent of the circle between them.
    fn next_entry(&self, exit: Triple<T>) -> (Triple<T>, Extent) {
        let middle = self.circle.middle();
        let a = minus(exit, middle);
        let (mut nearest, mut at) = (T::TAU + T::TAU, exit);
        for entry in &self.entries {
            let b = minus(*entry, middle);
            let apart = minus(a, b);
            let same = T::of(400.0) * T::UNCERTAINTY * T::UNCERTAINTY;
            let angle = up(T::atan2(dot(self.circle.axis, cross(a, b)), dot(a, b)));
            let angle = if angle > T::of(ALL_AROUND) && dot(apart, apart) < same { T::ZERO } else { angle };
            if angle < nearest {
                (nearest, at) = (angle, *entry);
            }
        }
        (at, if nearest > T::of(0.5) * T::TAU { Extent::Wide } else { Extent::Short })
    }
}

/// The points where the circle of an arc crosses the clipping circle, and its points farthest inside and outside.
struct Crossing<T> {
    entry: Triple<T>,
    exit: Triple<T>,
    nearest: Triple<T>,
    farthest: Triple<T>,
    /// Half of the angle of the part inside.
    half_angle: T,
}

impl<T: Scalar> Crossing<T> {
    /// `None` if the circles do not cross.
    fn new(arc: &Arc<T>, clip: &Circle<T>) -> Option<Self> {
        let (axis, middle, radius) = (arc.circle.axis, arc.circle.middle(), arc.circle.radius());
        let tilt = dot(clip.axis, axis);
        let inwards = minus(clip.axis, scaled(axis, tilt));
        let length = dot(inwards, inwards).sqrt();
        let cos = (clip.offset - arc.circle.offset * tilt) / (radius * length).max(T::of(1e-30));
        if !(cos.abs() < T::ONE - T::UNCERTAINTY) {
            return None;
        }
        let sin = (T::ONE - cos * cos).sqrt();
        let inwards = scaled(inwards, T::ONE / length);
        let at = |x: T, y: T| {
            let offset = plus(scaled(inwards, x), scaled(cross(axis, inwards), y));
            plus(middle, scaled(offset, radius))
        };
        Some(Self {
            entry: at(cos, -sin),
            exit: at(cos, sin),
            nearest: at(T::ONE, T::ZERO),
            farthest: at(-T::ONE, T::ZERO),
            half_angle: T::atan2(sin, cos),
        })
    }
}

/// Angles along an arc from its start.
struct Track<'a, T> {
    arc: &'a Arc<T>,
    middle: Triple<T>,
    /// The start, and the direction a quarter turn later.
    axes: [Triple<T>; 2],
    /// The angle of the whole arc.
    end: T,
}

impl<'a, T: Scalar> Track<'a, T> {
    fn new(arc: &'a Arc<T>) -> Self {
        let middle = arc.circle.middle();
        let start = minus(arc.from, middle);
        let mut track = Self { arc, middle, axes: [start, cross(arc.circle.axis, start)], end: T::TAU };
        let angle = track.angle(arc.to);
        track.end = match arc.extent {
            Extent::Whole => T::TAU,
            Extent::Wide if angle >= T::ZERO && angle < T::of(BEHIND) => T::TAU,
            Extent::Wide => up(angle),
            Extent::Short if angle < -T::of(BEHIND) => angle + T::TAU,
            Extent::Short => angle.max(T::ZERO),
        };
        track
    }

    /// The angle from the start, in [-pi, pi].
    fn angle(&self, w: Triple<T>) -> T {
        let radius = minus(w, self.middle);
        T::atan2(dot(self.axes[1], radius), dot(self.axes[0], radius))
    }

    /// The angle from the start, in [0, 2 pi].
    fn along(&self, w: Triple<T>) -> T {
        up(self.angle(w))
    }

    /// A crossing at an angle, or an end of the arc if rounding puts the crossing beyond this end.
    fn snapped_within(&self, w: Triple<T>, angle: T) -> ArcPoint<T> {
        if angle > T::ZERO && angle < self.end {
            (w, angle)
        } else if angle > T::of(0.5) * self.end {
            (self.arc.to, self.end)
        } else {
            (self.arc.from, T::ZERO)
        }
    }

    /// The only crossing on the arc, or an end of the arc if rounding puts the crossing beyond this end.
    fn snapped(&self, w: Triple<T>) -> ArcPoint<T> {
        let angle = self.along(w);
        if angle < self.end {
            (w, angle)
        } else if angle - self.end < (T::TAU - self.end) * T::of(0.5) {
            (self.arc.to, self.end)
        } else {
            (self.arc.from, T::ZERO)
        }
    }
}

impl<T: Scalar> Circle<T> {
    /// Any direction on the circle.
    fn start(&self) -> Triple<T> {
        let across =
            if self.axis[0].abs() < T::of(0.5) { [T::ONE, T::ZERO, T::ZERO] } else { [T::ZERO, T::ONE, T::ZERO] };
        plus(self.middle(), scaled(unit(cross(self.axis, across)), self.radius()))
    }
}

/// Converts an angle from [-pi, pi] to [0, 2 pi].
fn up<T: Scalar>(angle: T) -> T {
    if angle < T::ZERO { angle + T::TAU } else { angle }
}
