//! Positions for the names of points. Names cover neither each other nor a point.

/// A rectangle in picture coordinates.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Area {
    pub(super) left: f64,
    pub(super) top: f64,
    pub(super) width: f64,
    pub(super) height: f64,
}

impl Area {
    /// The area that this rectangle shares with another.
    fn overlap(&self, other: &Self) -> f64 {
        let length = |a: f64, a_size: f64, b: f64, b_size: f64| ((a + a_size).min(b + b_size) - a.max(b)).max(0.0);
        length(self.left, self.width, other.left, other.width) * length(self.top, self.height, other.top, other.height)
    }

    /// A square around a point.
    pub(super) fn around([x, y]: [f64; 2], half: f64) -> Self {
        Self { left: x - half, top: y - half, width: 2.0 * half, height: 2.0 * half }
    }

    /// The rectangle of all points within `half` of a horizontal or vertical line between two points.
    pub(super) fn along(a: [f64; 2], b: [f64; 2], half: f64) -> Self {
        let low = |axis: usize| a[axis].min(b[axis]) - half;
        let length = |axis: usize| (a[axis] - b[axis]).abs() + 2.0 * half;
        Self { left: low(0), top: low(1), width: length(0), height: length(1) }
    }

    /// The place in this rectangle that is nearest to a point.
    pub(super) fn near(&self, [x, y]: [f64; 2]) -> [f64; 2] {
        [x.clamp(self.left, self.left + self.width), y.clamp(self.top, self.top + self.height)]
    }

    /// Whether the line from a point to the nearest place in `name` crosses this rectangle.
    fn is_crossed(&self, point: [f64; 2], name: &Self) -> bool {
        let end = name.near(point);
        let ends = [[self.left, self.left + self.width], [self.top, self.top + self.height]];
        // The part of the line inside, from 0 to 1.
        let inside = (0..2).fold([0.0_f64, 1.0], |[enter, leave], axis| {
            let [low, high] = ends[axis].map(|edge| edge - point[axis]);
            let way = end[axis] - point[axis];
            if way == 0.0 {
                return if low <= 0.0 && high >= 0.0 { [enter, leave] } else { [1.0, 0.0] };
            }
            let [a, b] = [low / way, high / way];
            [enter.max(a.min(b)), leave.min(a.max(b))]
        });
        inside[0] <= inside[1]
    }

    /// The distance from a point to the centre of this rectangle.
    fn distance(&self, [x, y]: [f64; 2]) -> f64 {
        (self.left + 0.5 * self.width - x).hypot(self.top + 0.5 * self.height - y)
    }
}

/// The step between two tried positions.
const STEP: f64 = 5.0;
/// The distance that a name may be farther away so that its line crosses one mark less.
const DETOUR: f64 = 30.0;
/// A line that crosses a name counts as this many marks.
const NAME: f64 = 10.0;

/// A position inside `frame` for each point's name: a near position that does not cover one of `marks` or another name,
/// and whose line to the point crosses few names and marks. `None` if there is no such position.
pub(super) fn places(points: &[[f64; 2]], sizes: &[[f64; 2]], marks: &[Area], frame: &Area) -> Vec<Option<Area>> {
    let mut placed: Vec<([f64; 2], Area)> = Vec::new();
    let found = points.iter().zip(sizes).map(|(point, size)| {
        let is_free =
            |area: &Area| placed.iter().map(|(_, name)| name).chain(marks).all(|other| area.overlap(other) == 0.0);
        let free = everywhere(frame, *size).filter(is_free);
        let others: Vec<&Area> = marks.iter().filter(|mark| mark.near(*point) != *point).collect();
        let cost = |area: &Area| {
            let marks = others.iter().filter(|mark| mark.is_crossed(*point, area)).count();
            let is_over =
                |(other, name): &&([f64; 2], Area)| name.is_crossed(*point, area) || area.is_crossed(*other, name);
            let names = placed.iter().filter(is_over).count();
            area.distance(*point) + DETOUR * (marks as f64 + NAME * names as f64)
        };
        // `min_by` returns the first of several equal minima.
        let place = free.map(|area| (cost(&area), area)).min_by(|(a, _), (b, _)| a.total_cmp(b)).map(|(_, area)| area);
        placed.extend(place.map(|area| (*point, area)));
        place
    });
    found.collect()
}

/// Rectangles of `size` on a grid over `frame`.
fn everywhere(frame: &Area, [width, height]: [f64; 2]) -> impl Iterator<Item = Area> {
    let Area { left, top, .. } = *frame;
    let steps = [frame.width - width, frame.height - height].map(|room| (room / STEP).max(0.0) as u32);
    (0..=steps[1]).flat_map(move |row| {
        (0..=steps[0]).map(move |column| Area {
            left: left + f64::from(column) * STEP,
            top: top + f64::from(row) * STEP,
            width,
            height,
        })
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_of_points_close_together_hide_neither_each_other_nor_a_point() {
        let frame = Area { left: 0.0, top: 0.0, width: 300.0, height: 300.0 };
        // Four points on a vertical line near the right edge.
        let points = [[290.0, 100.0], [290.0, 106.0], [290.0, 109.0], [290.0, 110.0]];
        let marks = points.map(|point| Area::around(point, 5.0));
        let found = places(&points, &[[50.0, 14.0]; 4], &marks, &frame);
        assert_apart(&found, 4, &marks, &frame);
    }

    #[track_caller]
    fn assert_apart(found: &[Option<Area>], count: usize, marks: &[Area], frame: &Area) {
        let found: Vec<Area> = found.iter().flatten().copied().collect();
        assert_eq!(found.len(), count);
        for (i, area) in found.iter().enumerate() {
            assert!(area.left >= frame.left && area.top >= frame.top, "{area:?}");
            assert!(area.left + area.width <= frame.left + frame.width, "{area:?}");
            assert!(area.top + area.height <= frame.top + frame.height, "{area:?}");
            assert!(found[..i].iter().chain(marks).all(|other| area.overlap(other) == 0.0), "{found:?}");
        }
    }

    #[test]
    fn a_line_to_a_point_crosses_no_other_name() {
        let frame = Area { left: 0.0, top: 0.0, width: 200.0, height: 200.0 };
        // One point is above the other. Names have room below both points, but not above them.
        let points = [[190.0, 60.0], [190.0, 20.0]];
        let above = Area { left: 0.0, top: 0.0, width: 200.0, height: 65.0 };
        let found: Vec<Area> = places(&points, &[[80.0, 15.0]; 2], &[above], &frame).into_iter().flatten().collect();
        assert_eq!(found.len(), 2);
        assert!(!found[0].is_crossed(points[1], &found[1]) && !found[1].is_crossed(points[0], &found[0]), "{found:?}");
    }

    #[test]
    fn names_move_away_from_a_crowd_and_a_full_frame_has_no_names() {
        let frame = Area { left: 0.0, top: 0.0, width: 300.0, height: 300.0 };
        // Marks all around the points, so that no position next to a point is free.
        let marks: Vec<Area> =
            (0..400_u16).map(|i| Area::around([f64::from(i % 20) * 10.0, f64::from(i / 20) * 10.0], 5.0)).collect();
        assert_apart(&places(&[[90.0, 90.0]; 6], &[[50.0, 14.0]; 6], &marks, &frame), 6, &marks, &frame);
        assert_eq!(places(&[[90.0, 90.0]], &[[50.0, 14.0]], &[frame], &frame), [None]);
    }
}
