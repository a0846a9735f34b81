//! The integral over a light's image inside of its outline, and the integral along a line light.

use glam::DVec3;

use super::{
    border::Piece,
    quadrature::{integral, plus},
    space::Space,
};

/// The largest number of halvings of an edge. The last part is shorter than the spacing of f64 directions.
const MOST_EDGE_HALVINGS: u32 = 60;
/// The smallest number of halvings of an edge. An image that leaves and comes back would look short without them.
const LEAST_EDGE_HALVINGS: u32 = 2;

/// The largest number of halvings of an interval along the outline, and along a ray. The quadrature reaches them where
/// a horizon cuts the integrand.
const OUTLINE_HALVINGS: u32 = 16;
const RAY_HALVINGS: u32 = 12;

/// The tolerance for a line that points at the shaded point: the distance of the extended line relative to its farther
/// end.
const POINTING: f64 = 1e-14;

/// A part of an outline, and the images of its ends.
#[derive(Clone, Copy)]
struct Edge {
    piece: Piece,
    from_image: DVec3,
    to_image: DVec3,
}

impl Edge {
    fn new(space: &impl Space, piece: Piece) -> Self {
        let [from_image, to_image] = piece.ends().map(|end| image_of(space, &piece, end));
        Self { piece, from_image, to_image }
    }
}

/// The image of a point on a piece. The points of straight pieces are unit vectors.
fn image_of(space: &impl Space, piece: &Piece, place: DVec3) -> DVec3 {
    match piece {
        Piece::Straight(_) => space.image(place),
        Piece::Arc { .. } => space.image(place.normalize()),
    }
}

/// The integral of the density inside of an outline above the surface. It is positive if the outline runs clockwise as
/// seen from the origin.
pub(super) fn within(space: &impl Space, outline: &[Piece], tolerance: f64) -> [f64; 2] {
    let around = outline.iter().fold(DVec3::ZERO, |sum, piece| match piece {
        Piece::Straight([from, _]) => sum + *from,
        Piece::Arc { .. } => sum + piece.ends()[0].normalize() + piece.middle().normalize(),
    });
    let middle = around.normalize_or_zero();
    if middle == DVec3::ZERO {
        return [0.0; 2];
    }
    let tip = space.tip(middle);
    let triangle = |edge: &Edge| triangle(space, tip, edge, tolerance);
    let parts = outline.iter().map(|piece| over_short_parts(space, Edge::new(space, *piece), 0, &triangle));
    parts.fold([0.0; 2], plus)
}

/// The sum over parts of an edge with short images.
fn over_short_parts(space: &impl Space, edge: Edge, halvings: u32, part: &impl Fn(&Edge) -> [f64; 2]) -> [f64; 2] {
    let Edge { piece, from_image, to_image } = edge;
    if matches!(piece, Piece::Straight([from, to]) if from == to) {
        return [0.0; 2];
    }
    let image = image_of(space, &piece, piece.middle());
    let ends = [from_image.dot(to_image), from_image.dot(image), image.dot(to_image)];
    let is_short = halvings >= LEAST_EDGE_HALVINGS && ends.iter().all(|cosine| *cosine > space.short());
    if is_short || halvings == MOST_EDGE_HALVINGS {
        return part(&edge);
    }
    let [first, second] = piece.halves();
    let halves = [Edge { piece: first, to_image: image, ..edge }, Edge { piece: second, from_image: image, ..edge }];
    halves.into_iter().fold([0.0; 2], |sum, half| plus(sum, over_short_parts(space, half, halvings + 1, part)))
}

/// The integral of the density over the triangle between `tip` and the image of an edge. It is negative if the triangle
/// runs the other way round.
fn triangle(space: &impl Space, tip: DVec3, edge: &Edge, tolerance: f64) -> [f64; 2] {
    // c(t) along the image, and its derivative.
    let slice = |t: f64| {
        let (w, turning) = turn(&edge.piece, t);
        let (c, derivative) = space.turning_image(w, turning);
        let sweep = tip.dot(c.cross(derivative));
        // The points p = (1 - s) tip + s c of the plane triangle, seen from the origin.
        let ray = |s: f64| {
            let p = tip * (1.0 - s) + c * s;
            let length = p.length();
            space.density(p / length).map(|x| x * s / (length * length * length))
        };
        let tolerance = 0.1 * tolerance / sweep.abs().max(1e-3);
        between_bends(&ray, &space.bends(tip, c), tolerance).map(|x| x * sweep)
    };
    integral(&slice, [0.0, 1.0], tolerance, OUTLINE_HALVINGS)
}

/// The integral over [0, 1] of a function that is smooth between its kinks, which are in ascending order.
fn between_bends(f: &impl Fn(f64) -> [f64; 2], bends: &[f64], tolerance: f64) -> [f64; 2] {
    let tolerance = tolerance / (bends.len() + 1) as f64;
    let ends = bends.iter().copied().chain([1.0]);
    let from = [0.0].into_iter().chain(bends.iter().copied());
    let parts = from.zip(ends).map(|(from, to)| integral(f, [from, to], tolerance, RAY_HALVINGS));
    parts.reduce(plus).unwrap_or_default()
}

/// The reflected light of a line: the width times the integral of the BRDF times cosine, divided by the distance, over
/// the angle along the line.
pub(super) fn along_line(space: &impl Space, ends: [DVec3; 2], width: f64, tolerance: f64) -> [f64; 2] {
    let axis = (ends[1] - ends[0]).normalize();
    let beside = ends[0] - axis * ends[0].dot(axis);
    let (own, towards) = (beside.length(), beside.normalize_or_zero());
    // A line that points at the shaded point looks like a point.
    if own <= POINTING * ends[0].length().max(ends[1].length()) {
        return [0.0; 2];
    }
    let (brdf, wo) = space.brdf_and_view();
    let along = |edge: &Edge| {
        let at = |t: f64| {
            let (w, turning) = turn(&edge.piece, t);
            let cosine = wo.dot((wo + w).normalize());
            space.weight().weighted(width * brdf.eval_cos(wo, w) * turning.length() * w.dot(towards) / own, cosine)
        };
        integral(&at, [0.0, 1.0], tolerance, OUTLINE_HALVINGS)
    };
    let visible_pieces = Piece::Straight(ends).above_surface();
    visible_pieces.iter().map(|piece| over_short_parts(space, Edge::new(space, *piece), 0, &along)).fold([0.0; 2], plus)
}

/// The direction to the point at `t` of a piece, and its derivative.
fn turn(piece: &Piece, t: f64) -> (DVec3, DVec3) {
    let (place, along) = piece.at(t);
    let distance = place.length();
    let w = place / distance;
    (w, (along - w * w.dot(along)) / distance)
}
