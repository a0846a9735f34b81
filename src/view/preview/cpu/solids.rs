//! Twin of `reference_solids.wgsl`.

use std::f32::consts::{FRAC_1_PI, TAU};

use glam::{Vec2, Vec3};

use crate::preview::frame::FrameShape;
use ltcforge_fit::math::{atan2_upper, sin_cos_turns};

/// An octagon with this circumradius has the area of the unit disk: sqrt(pi / (4 sin(pi / 4))).
const OCTAGON: f32 = 1.053_907_4;

fn basis(axis: Vec3) -> [Vec3; 2] {
    let x = (if axis.z.abs() > 0.7 { Vec3::X } else { Vec3::Z }).cross(axis).normalize();
    [x, axis.cross(x)]
}

/// The ends, relative to the shaded point, and the radius or width.
fn around(shape: &FrameShape, position: Vec3) -> ([Vec3; 2], f32) {
    match *shape {
        FrameShape::Tube { ends, radius } => (ends.map(|end| end - position), radius),
        FrameShape::Line { ends, width } => (ends.map(|end| end - position), width),
        FrameShape::Polygon | FrameShape::Ellipse(_) => ([Vec3::ZERO; 2], 0.0),
    }
}

fn nearest([start, end]: [Vec3; 2]) -> Vec3 {
    let along = end - start;
    start + along * (-start.dot(along) / along.dot(along).max(1e-36)).clamp(0.0, 1.0)
}

fn cap(sine2: f32) -> f32 {
    sine2 / (1.0 + (1.0 - sine2).max(0.0).sqrt())
}

/// The distance to a tube, and the cosine at its surface.
fn tube_hit([start, end]: [Vec3; 2], radius: f32, wi: Vec3) -> Option<(f32, f32)> {
    let along = end - start;
    let mut found: Option<(f32, f32)> = None;
    let mut take = |distance: f32, cosine: f32| {
        if distance > 0.0 && found.is_none_or(|(nearer, _)| distance < nearer) {
            found = Some((distance, cosine));
        }
    };
    for middle in [start, end] {
        let away = wi.dot(middle);
        let beside = wi * away - middle;
        let height2 = radius * radius - beside.dot(beside);
        if height2 > 0.0 {
            take(away - height2.sqrt(), height2.sqrt() / radius);
        }
    }
    let normal = wi.cross(along);
    let (sine2, length2) = (normal.dot(normal), along.dot(along));
    let apart = start.dot(normal);
    let height2 = radius * radius * sine2 - apart * apart;
    if sine2 > 1e-12 * length2 && height2 > 0.0 {
        let forth = start.dot(along) * wi.dot(along) - length2 * wi.dot(start);
        let distance = -(forth + (height2 * length2).sqrt()) / sine2;
        let share = (wi * distance - start).dot(along) / length2;
        if share > 0.0 && share < 1.0 {
            let outwards = wi * distance - start - along * share;
            take(distance, (-outwards.dot(wi) / radius).max(0.0));
        }
    }
    found
}

fn tube_area(along: Vec3, radius: f32) -> (f32, f32) {
    let length = along.length();
    (TAU * radius * (length + 2.0 * radius), length / (length + 2.0 * radius))
}

pub(super) fn pdf(shape: &FrameShape, position: Vec3, wi: Vec3) -> f32 {
    let (ends, radius) = around(shape, position);
    if matches!(shape, FrameShape::Line { .. }) {
        return -1.0;
    }
    let nearest = nearest(ends);
    let distance2 = nearest.dot(nearest);
    if distance2 <= radius * radius {
        return 0.0;
    }
    let along = ends[1] - ends[0];
    if along == Vec3::ZERO {
        let beside = wi.cross(nearest);
        let is_hit = beside.dot(beside) < radius * radius && wi.dot(nearest) > 0.0;
        return if is_hit { 0.5 * FRAC_1_PI / cap(radius * radius / distance2) } else { -1.0 };
    }
    tube_hit(ends, radius, wi)
        .map_or(-1.0, |(distance, cosine)| distance * distance / (tube_area(along, radius).0 * cosine.max(1e-6)))
}

pub(super) fn sample(shape: &FrameShape, position: Vec3, u: Vec2) -> (Vec3, f32) {
    let (ends @ [start, end], size) = around(shape, position);
    let along = end - start;
    if matches!(shape, FrameShape::Line { .. }) {
        let normal = start.cross(end);
        let area = normal.dot(normal).sqrt();
        if !(area > 0.0 && size > 0.0) {
            return (Vec3::Z, 0.0);
        }
        let angle = atan2_upper(area, start.dot(end));
        let towards = start.normalize();
        let (sin, cos) = sin_cos_turns(u.x * angle * (0.5 * FRAC_1_PI));
        let direction = towards * cos + (normal / area.max(1e-18)).cross(towards) * sin;
        let distance = area / along.length() / direction.dot(along.cross(normal).normalize()).max(1e-18);
        return (direction, distance / (size * angle.max(1e-18)));
    }
    let nearest = nearest(ends);
    let distance2 = nearest.dot(nearest);
    if distance2 <= size * size {
        return (Vec3::Z, 0.0);
    }
    if along == Vec3::ZERO {
        let cap = cap(size * size / distance2);
        let towards = nearest / distance2.sqrt();
        let (sin, cos) = sin_cos_turns(u.y);
        let radius = (u.x * cap * (2.0 - u.x * cap)).max(0.0).sqrt();
        let [x, y] = basis(towards);
        return ((x * cos + y * sin) * radius + towards * (1.0 - u.x * cap), 0.5 * FRAC_1_PI / cap);
    }
    let axis = along.normalize();
    let (area, straight) = tube_area(along, size);
    let (sin, cos) = sin_cos_turns(u.y);
    let [x, y] = basis(axis);
    let across = x * cos + y * sin;
    let (foot, outwards) = if u.x < straight {
        (start + along * (u.x / straight), across)
    } else {
        let height = 1.0 - 2.0 * (u.x - straight) / (1.0 - straight);
        (if height > 0.0 { end } else { start }, axis * height + across * (1.0 - height * height).max(0.0).sqrt())
    };
    let place = foot + outwards * size;
    let away2 = place.dot(place);
    let direction = place / away2.sqrt();
    let facing = -outwards.dot(direction);
    (direction, if facing > 0.0 { away2 / (area * facing.max(1e-6)) } else { 0.0 })
}

pub(super) fn outline(shape: &FrameShape, position: Vec3, up: Vec3) -> Vec<Vec3> {
    let (ends @ [start, end], size) = around(shape, position);
    let along = end - start;
    if matches!(shape, FrameShape::Line { .. }) {
        let across = start.cross(end).try_normalize().unwrap_or(Vec3::ZERO) * (0.5 * size);
        return vec![start - across, start + across, end + across, end - across];
    }
    let nearest = nearest(ends);
    let beside = start - along * (start.dot(along) / along.dot(along).max(1e-36));
    let is_inside = nearest.dot(nearest) <= size * size;
    let (nearest, radius) = if is_inside { (up, 0.999) } else { (nearest, size) };
    if is_inside || along == Vec3::ZERO || beside.dot(beside) <= size * size {
        let sine2 = radius * radius / nearest.dot(nearest);
        let [x, y] = basis(nearest.normalize());
        let silhouette = radius * (1.0 - sine2).sqrt() * OCTAGON;
        let vertex = |i: u8| {
            let (sin, cos) = sin_cos_turns((0.5 - f32::from(i)) * 0.125);
            nearest * (1.0 - sine2) + (x * cos + y * sin) * silhouette
        };
        return (0..8).map(vertex).collect();
    }
    let sideways = along.cross(beside).normalize();
    let ends = [tube_end(start, -along, beside, sideways, size), tube_end(end, along, beside, -sideways, size)];
    ends.concat()
}

fn tube_end(end: Vec3, outwards: Vec3, beside: Vec3, sideways: Vec3, size: f32) -> [Vec3; 4] {
    let sine2 = size * size / end.dot(end);
    let centre = end * (1.0 - sine2);
    let radius = size * (1.0 - sine2).max(0.0).sqrt();
    let ahead = (outwards - end * (outwards.dot(end) / end.dot(end))).try_normalize().unwrap_or(Vec3::ZERO);
    let beside2 = beside.dot(beside);
    let touched = -(beside * (size / beside2) - sideways * ((beside2 - size * size).sqrt() / beside2.sqrt())) * size;
    let to_end = end + touched - centre;
    let (sin_end, cos_end) = (to_end.dot(sideways), to_end.dot(ahead));
    let half_arc = atan2_upper(sin_end.max(0.0), cos_end);
    let (sin, cos) = sin_cos_turns(half_arc * 0.053_051_648);
    let sine = 2.0 * sin * cos;
    let out = radius * if half_arc > 1e-3 { (1.0 + 2.0 * half_arc / sine.max(1e-6)).sqrt() - 1.0 } else { 1.0 };
    [
        centre + ahead * cos_end + sideways * sin_end,
        centre + (ahead * cos + sideways * sin) * out,
        centre + (ahead * cos - sideways * sin) * out,
        centre + ahead * cos_end - sideways * sin_end,
    ]
}
