//! A scene as both renderers read it: the uniforms of the shaders, in f32.

use std::sync::Arc;

use glam::{DVec3, Vec3};

use super::{
    Camera, Scene, Surface,
    light::{Ellipse, Outline, Shape},
    light_picture::LightPicture,
    scene::MAX_MATERIALS,
};
use ltcforge_fit::{MAX_VERTICES, math::sin_cos};

/// Radiance of the background.
const BACKGROUND: f32 = 0.02;
/// The distance at which a floor ends, in radii of the scene's sphere. The floor fades out over the second half of this
/// distance.
const FLOOR_END: f32 = 12.0;
/// A smaller cosine of the view direction is raised to this value, because a surface reflects no light along the
/// horizon.
pub(super) const LOWEST_VIEW: f32 = 1e-3;

/// Uniforms of `sphere.wgsl`, except the rendered part.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Frame {
    pub(super) surface: Surface,
    pub(super) eye: Vec3,
    /// Three vectors: from the middle of the image plane, at distance one, to its right and upper edges, and from the
    /// eye to the middle.
    pub(super) right: Vec3,
    pub(super) up: Vec3,
    pub(super) forward: Vec3,
    /// Width of a pixel at distance one.
    pub(super) pixel: f32,
    pub(super) f0: Vec3,
    pub(super) exposure: f32,
    pub(super) background: Vec3,
    pub(super) floor_end: f32,
    pub(super) lobe_wo: Vec3,
    /// `alpha_x, alpha_y`, cosine and sine of the tangent frame's rotation.
    pub(super) materials: Vec<[f32; 4]>,
    pub(super) size: u32,
    /// Cells per side of the picture.
    pub(super) cells: u32,
    pub(super) spp: u32,
    pub(super) light: FrameLight,
    /// The picture on the light.
    pub(super) picture: Option<Arc<LightPicture>>,
    /// Whether light from below the surface is cut off. It is a constant of the pipeline.
    pub(super) is_cut: bool,
    /// Whether the light that is lost between facets is added back. It is a constant of the pipeline.
    pub(super) is_compensated: bool,
}

/// Uniforms of `ggx_reference.wgsl`.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct FrameLight {
    pub(super) vertices: Vec<Vec3>,
    /// Area of the triangles of the fan up to each vertex, relative to the total area.
    pub(super) area_up_to: Vec<f32>,
    pub(super) shape: FrameShape,
    pub(super) normal: Vec3,
    pub(super) area: f32,
    pub(super) radiance: f32,
    pub(super) two_sided: bool,
}

/// The shape of the light, as uniforms.
pub(super) type FrameShape = Shape<Vec3, f32>;

impl FrameShape {
    /// `light_shape` in the shader.
    pub(super) fn number(&self) -> u32 {
        match self {
            Self::Polygon => 0,
            Self::Ellipse(_) => 1,
            Self::Tube { .. } => 2,
            Self::Line { .. } => 3,
        }
    }
}

impl FrameLight {
    /// Whether the polygon that replaces the light emits from both sides. Polygons for spheres and tubes do.
    pub(super) fn is_two_sided(&self) -> bool {
        self.two_sided || matches!(self.shape, FrameShape::Tube { .. } | FrameShape::Line { .. })
    }

    /// The number of vertices of the polygon that replaces the light for models that only support polygons.
    pub(super) fn outline_vertices(&self) -> usize {
        match self.shape {
            FrameShape::Polygon | FrameShape::Ellipse(_) => self.vertices.len(),
            FrameShape::Tube { .. } => MAX_VERTICES,
            FrameShape::Line { .. } => 4,
        }
    }
}

/// A part of a picture, and a range of its samples.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub(super) struct Part {
    /// The first tile of the part, in a list of tiles, and the number of tiles.
    pub(super) first_tile: u32,
    pub(super) tiles: u32,
    pub(super) first_sample: u32,
    pub(super) samples: u32,
}

impl Frame {
    /// The frame of a scene. `of_lobe` is true for mode `lobe`. Domain: a scene without faults.
    pub(super) fn new(scene: &Scene, of_lobe: bool) -> Self {
        let cells = if of_lobe || scene.materials.len() == 1 { 1 } else { 2 };
        let (eye, [right, up, forward]) = if of_lobe { lobe_view(scene.lobe.phi) } else { view(&scene.camera) };
        let half = if of_lobe { 1.0 } else { libm::tan(0.5 * scene.camera.field_of_view) };
        let side = (scene.size / cells).max(1);
        let Outline { vertices, normal, area, area_up_to, shape } = scene.light.outline();
        Self {
            surface: scene.surface,
            eye: eye.as_vec3(),
            right: (right * half).as_vec3(),
            up: (up * half).as_vec3(),
            forward: forward.as_vec3(),
            pixel: (2.0 * half / f64::from(side)) as f32,
            f0: DVec3::from(scene.f0).as_vec3(),
            exposure: scene.exposure as f32,
            background: Vec3::splat(BACKGROUND),
            floor_end: FLOOR_END,
            lobe_wo: lobe_wo(scene.lobe.theta, scene.lobe.phi),
            materials: scene
                .materials
                .iter()
                .map(|m| {
                    let (sin, cos) = sin_cos(m.rotation);
                    [m.alpha_x as f32, m.alpha_y as f32, cos as f32, sin as f32]
                })
                .collect(),
            size: scene.size,
            cells,
            spp: scene.spp,
            light: FrameLight {
                vertices: vertices.into_iter().map(DVec3::as_vec3).collect(),
                area_up_to: area_up_to.into_iter().map(|share| share as f32).collect(),
                shape: shape.as_f32(),
                normal: normal.as_vec3(),
                area: area as f32,
                radiance: scene.light.intensity as f32,
                two_sided: scene.light.two_sided,
            },
            picture: LightPicture::of(scene).filter(|_| !of_lobe).map(Arc::new),
            is_cut: scene.cut,
            is_compensated: scene.compensate,
        }
    }

    /// The material of a cell; `None` beyond the last material.
    pub(super) fn material(&self, cell: u32) -> Option<[f32; 4]> {
        self.materials.get(cell as usize).copied()
    }

    /// The words of `struct Scene`, for a part of the picture.
    pub(super) fn scene_words(&self, part: &Part) -> Vec<u32> {
        let mut words = Words::default();
        words.vector(self.eye, self.pixel);
        words.vector(self.right, 0.0);
        words.vector(self.up, 0.0);
        words.vector(self.forward, 0.0);
        words.vector(self.f0, self.exposure);
        words.vector(self.background, self.floor_end);
        words.vector(self.lobe_wo, 0.0);
        for cell in 0..MAX_MATERIALS {
            // A negative alpha marks a cell without material.
            words.floats(self.materials.get(cell).copied().unwrap_or([-1.0; 4]));
        }
        let surface = match self.surface {
            Surface::Sphere => 0,
            Surface::Floor => 1,
        };
        words.0.extend([self.size, self.cells, surface, self.spp]);
        words.0.extend([part.first_tile, part.first_sample, part.samples, 0]);
        words.0
    }

    /// The words of `struct Light`.
    pub(super) fn light_words(&self) -> Vec<u32> {
        let light = &self.light;
        let mut words = Words::default();
        for i in 0..MAX_VERTICES {
            match light.vertices.get(i) {
                Some(vertex) => words.vector(*vertex, light.area_up_to[i]),
                None => words.vector(Vec3::ZERO, 1.0),
            }
        }
        match light.shape {
            FrameShape::Ellipse(Ellipse { centre, half_axes: [(x, per_x2), (y, per_y2)] }) => {
                words.vector(centre, 0.0);
                words.vector(x, per_x2);
                words.vector(y, per_y2);
            }
            FrameShape::Tube { ends: [start, end], radius: size }
            | FrameShape::Line { ends: [start, end], width: size } => {
                words.vector(start, size);
                words.vector(end, 0.0);
                words.floats([0.0; 4]);
            }
            FrameShape::Polygon => words.floats([0.0; 12]),
        }
        words.vector(light.normal, light.area);
        words.vector(Vec3::splat(light.radiance), self.picture.as_ref().map_or(0.0, |picture| picture.base()));
        words.0.extend([light.outline_vertices() as u32, u32::from(light.is_two_sided()), 0, 0]);
        words.0
    }
}

/// The position of the camera, and its right, up and forward directions.
fn view(camera: &Camera) -> (DVec3, [DVec3; 3]) {
    let ((sin_a, cos_a), (sin_e, cos_e)) = (sin_cos(camera.azimuth), sin_cos(camera.elevation));
    let back = DVec3::new(sin_a * cos_e, sin_e, cos_a * cos_e);
    let right = DVec3::new(cos_a, 0.0, -sin_a);
    (DVec3::from(camera.target) + back * camera.distance, [right, back.cross(right), -back])
}

/// The camera for the sphere of directions. It looks down at 40 degrees, perpendicular to the plane of the view
/// direction and its mirror direction. The view direction is on the left.
fn lobe_view(phi: f64) -> (DVec3, [DVec3; 3]) {
    let ((sin, cos), (sin_e, cos_e)) = (sin_cos(phi), sin_cos(0.7));
    let right = DVec3::new(-cos, -sin, 0.0);
    let back = DVec3::new(-sin * cos_e, cos * cos_e, sin_e);
    (back, [right, back.cross(right), -back])
}

/// The view direction in the tangent frame, raised to [`LOWEST_VIEW`].
fn lobe_wo(theta: f64, phi: f64) -> Vec3 {
    let ((sin_t, cos_t), (sin_p, cos_p)) = (sin_cos(theta), sin_cos(phi));
    DVec3::new(sin_t * cos_p, sin_t * sin_p, cos_t.max(f64::from(LOWEST_VIEW))).normalize().as_vec3()
}

/// Uniforms as 32-bit words.
#[derive(Default)]
struct Words(Vec<u32>);

impl Words {
    fn vector(&mut self, v: Vec3, w: f32) {
        self.floats([v.x, v.y, v.z, w]);
    }

    fn floats<const N: usize>(&mut self, numbers: [f32; N]) {
        self.0.extend(numbers.map(f32::to_bits));
    }
}
