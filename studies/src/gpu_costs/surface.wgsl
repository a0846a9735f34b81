// This file is compiled with each shader. It has a pixel's surface and view, and a rectangle relative to the surface in
// its tangent frame.
struct Surface {
    normal: vec2<f32>,
    alpha: vec2<f32>,
    position: vec3<f32>,
}

struct Light {
    corners: array<vec4<f32>, 4>,
}

@group(0) @binding(10) var<storage, read> surfaces: array<Surface>;
@group(0) @binding(11) var<storage, read_write> reflected: array<vec4<f32>>;
@group(0) @binding(12) var<uniform> light: Light;

struct Local {
    wo: vec3<f32>,
    corners: array<vec3<f32>, 4>,
}

fn local_view(surface: Surface) -> Local {
    let normal = normalize(vec3(surface.normal, 1.0));
    let tangent = normalize(cross(vec3(0.0, 1.0, 0.0), normal));
    let to_surface = transpose(mat3x3(tangent, cross(normal, tangent), normal));
    let wo = to_surface * normalize(-surface.position);

    return Local(wo, array(
        to_surface * (light.corners[0].xyz - surface.position),
        to_surface * (light.corners[1].xyz - surface.position),
        to_surface * (light.corners[2].xyz - surface.position),
        to_surface * (light.corners[3].xyz - surface.position),
    ));
}
