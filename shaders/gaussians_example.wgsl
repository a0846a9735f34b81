// Lights one surface with one light, by a Gaussian. It shows how to call gaussians_light.wgsl. Use its results to check
// a port. Needs ltc_math.wgsl and gaussians_light.wgsl. Replace it with your own code, and delete GaussiansExample*.

struct GaussiansExampleCase {
    /// View direction in the tangent frame, of unit length. w: alpha_x.
    wo: vec4<f32>,
    /// x: alpha_y. y: number of vertices of the light, 3 to 8; 0 for a disk, 1 for a spherical Gaussian. z: 1 if both
    /// sides of the light emit, else 0. w: kind of the surface's Gaussian, 1 for GAUSSIANS_ASG.
    light: vec4<f32>,
    /// xyz: the vertices relative to the shaded point, in the tangent frame. For a disk: centre and both half axes. For
    /// a spherical Gaussian: its axis, then its sharpness and amplitude.
    vertices: array<vec4<f32>, 8>,
}

@group(0) @binding(0) var<uniform> gaussians_case: GaussiansExampleCase;
/// x: reflected light for a Fresnel factor of one. y: the same light weighted by Schlick's fifth power. z, w: 0.
@group(0) @binding(1) var<storage, read_write> gaussians_result: vec4<f32>;

@compute @workgroup_size(1)
fn gaussians_example() {
    let kind = u32(gaussians_case.light.w);
    let view = gaussians_view(kind, gaussians_case.wo.w, gaussians_case.light.x, gaussians_case.wo.xyz);
    let count = u32(gaussians_case.light.y);
    let two_sided = gaussians_case.light.z == 1.0;
    var vertices: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = gaussians_case.vertices[i].xyz;
    }
    var parts: vec2<f32>;
    if (count == 0u) {
        parts = gaussians_disk(view, vertices[0], vertices[1], vertices[2], two_sided);
    } else if (count == 1u) {
        parts = gaussians_sg(view, vertices[0], vertices[1].x, vertices[1].y);
    } else if (count == 4u) {
        let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
        parts = gaussians_rectangle(view, corners, two_sided);
    } else {
        parts = gaussians_polygon(view, vertices, count, two_sided);
    }
    // The reflected light of radiance L is L (f0 (parts.x - parts.y) + f90 parts.y).
    gaussians_result = vec4(parts, 0.0, 0.0);
}
