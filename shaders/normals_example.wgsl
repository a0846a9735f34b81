// Lights one surface with one light, without a table. It shows how to call the functions of a rule. Use its results
// to check a port. Replace it with your own code, and delete NormalsExample*.

struct NormalsExampleCase {
    /// View direction in the tangent frame, of unit length. w: alpha_x.
    wo: vec4<f32>,
    /// x: alpha_y. y: number of vertices of the light, 3 to 8; 0 for a disk. z: 1 if both sides of the light emit, else
    /// 0.
    light: vec4<f32>,
    /// xyz: the vertices relative to the shaded point, in the tangent frame. For a disk: centre and both half axes.
    vertices: array<vec4<f32>, 8>,
}

@group(0) @binding(0) var<uniform> normals_case: NormalsExampleCase;
/// x: reflected light for a Fresnel factor of one. y: the same light weighted by Schlick's fifth power. z, w: 0.
@group(0) @binding(1) var<storage, read_write> normals_result: vec4<f32>;

@compute @workgroup_size(1)
fn normals_example() {
    let view = normals_view(normals_case.wo.w, normals_case.light.x, normals_case.wo.xyz);
    let count = u32(normals_case.light.y);
    let two_sided = normals_case.light.z == 1.0;
    var vertices: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = normals_case.vertices[i].xyz;
    }
    var parts: vec2<f32>;
    if (count == 0u) {
        parts = normals_disk(view, vertices[0], vertices[1], vertices[2], two_sided);
    } else if (count == 4u) {
        let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
        parts = normals_rectangle(view, corners, two_sided);
    } else {
        parts = normals_polygon(view, &vertices, count, two_sided);
    }
    // The reflected light of radiance L is L (f0 (parts.x - parts.y) + f90 parts.y).
    normals_result = vec4(parts, 0.0, 0.0);
}
