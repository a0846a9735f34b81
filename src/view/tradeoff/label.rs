//! Where the names of points are written, so that they hide neither each other nor a point.

/// A box in a picture's coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Area {
    /// The part of this box that another covers, in units of area.
    fn overlap(&self, other: &Self) -> f64 {
        let length = |a: f64, a_size: f64, b: f64, b_size: f64| ((a + a_size).min(b + b_size) - a.max(b)).max(0.0);
        length(self.left, self.width, other.left, other.width) * length(self.top, self.height, other.top, other.height)
    }

    /// A square around a point.
    pub(super) fn around([x, y]: [f64; 2], half: f64) -> Self {
        Self { left: x - half, top: y - half, width: 2.0 * half, height: 2.0 * half }
    }

    fn is_inside(&self, frame: &Self) -> bool {
        self.left >= frame.left
            && self.top >= frame.top
            && self.left + self.width <= frame.left + frame.width
            && self.top + self.height <= frame.top + frame.height
    }
}

/// Distances and directions from a point at which its name may stand, best first.
const DISTANCES: [f64; 6] = [12.0, 20.0, 30.0, 44.0, 60.0, 80.0];
/// Around the circle, the upper right first; y grows downwards.
const DIRECTIONS: [[f64; 2]; 8] =
    [[0.7, -0.7], [0.7, 0.7], [-0.7, -0.7], [-0.7, 0.7], [1.0, 0.0], [-1.0, 0.0], [0.0, -1.0], [0.0, 1.0]];

/// A place of `size` for each point's name, inside `frame`: the first that hides nothing, or else what hides least.
/// Names hide each other last of all.
pub(super) fn places(points: &[[f64; 2]], sizes: &[[f64; 2]], taken: &[Area], frame: &Area) -> Vec<Area> {
    /// How much worse it is to hide another name than to hide a point.
    const NAME_WEIGHT: f64 = 100.0;
    let mut names: Vec<Area> = Vec::new();
    for (point, size) in points.iter().zip(sizes) {
        let cost = |area: &Area| {
            let of_names: f64 = names.iter().map(|name| area.overlap(name)).sum();
            let of_points: f64 = taken.iter().map(|mark| area.overlap(mark)).sum();
            let outside = if area.is_inside(frame) { 0.0 } else { 1e9 };
            NAME_WEIGHT * of_names + of_points + outside
        };
        let candidates = DISTANCES.iter().flat_map(|r| DIRECTIONS.iter().map(move |to| beside(*point, *to, *r, *size)));
        // `min_by` keeps the first of equals.
        let best = candidates.min_by(|a, b| cost(a).total_cmp(&cost(b)));
        names.extend(best);
    }
    names
}

/// The box of `size` whose nearest point lies `distance` from `point` towards `to`.
fn beside([x, y]: [f64; 2], [dx, dy]: [f64; 2], distance: f64, [width, height]: [f64; 2]) -> Area {
    let anchor = |d: f64, size: f64| match d {
        d if d > 0.1 => 0.0,
        d if d < -0.1 => size,
        _ => 0.5 * size,
    };
    Area { left: x + dx * distance - anchor(dx, width), top: y + dy * distance - anchor(dy, height), width, height }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_points_close_together_hide_neither_each_other_nor_a_point() {
        let frame = Area { left: 0.0, top: 0.0, width: 300.0, height: 300.0 };
        // Four on a vertical line at the right end.
        let points = [[290.0, 100.0], [290.0, 106.0], [290.0, 109.0], [290.0, 110.0]];
        let taken = points.map(|point| Area::around(point, 5.0));
        let found = places(&points, &[[50.0, 14.0]; 4], &taken, &frame);
        assert_eq!(found.len(), 4);
        for (i, area) in found.iter().enumerate() {
            assert!(area.is_inside(&frame), "{area:?}");
            assert!(found[..i].iter().chain(&taken).all(|other| area.overlap(other) == 0.0), "{found:?}");
        }
    }
}
