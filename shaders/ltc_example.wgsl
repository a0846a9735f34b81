// Lights one surface with one light. It shows how to call the other files. Use its results to check a port. Needs
// ltc_math.wgsl, ltc_table.wgsl, ltc_light.wgsl and ltc_shapes.wgsl. Replace it with your own code, and delete group 1
// and LtcExample*.

struct LtcExampleCase {
    /// View direction in the tangent frame, of unit length. w: alpha_x.
    wo: vec4<f32>,
    /// x: alpha_y. y: shape of the light: number of vertices of a polygon (3 to 8), 0 for a disk, 1 for a sphere, 2 for
    /// a tube, 9 for a line. z: 1 if both sides of the light emit, else 0. w: radius of a sphere or tube, width of a
    /// line.
    light: vec4<f32>,
    /// xyz: the vertices relative to the shaded point, in the tangent frame. For a disk: centre and both half axes. For
    /// a sphere: its centre. For a tube or line: both ends.
    vertices: array<vec4<f32>, 8>,
}

struct LtcExampleResult {
    /// The columns of M.
    m: array<vec4<f32>, 3>,
    /// amplitude, fresnel, the covered part of the lobe, 0.
    terms: vec4<f32>,
}

@group(1) @binding(0) var<uniform> ltc_case: LtcExampleCase;
@group(1) @binding(1) var<storage, read_write> ltc_result: LtcExampleResult;

@compute @workgroup_size(1)
fn ltc_example() {
    let lobe = ltc_lookup(ltc_case.wo.w, ltc_case.light.x, ltc_case.wo.xyz);
    let inverse = ltc_inverse(lobe.m);
    let count = u32(ltc_case.light.y);
    let two_sided = ltc_case.light.z == 1.0;
    var vertices: array<vec3<f32>, 8>;
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = ltc_case.vertices[i].xyz;
    }
    var covered: f32;
    if (count == 0u) {
        covered = ltc_disk(inverse, vertices[0], vertices[1], vertices[2], two_sided);
    } else if (count == 1u) {
        covered = ltc_sphere(inverse, vertices[0], ltc_case.light.w);
    } else if (count == 2u) {
        covered = ltc_tube(inverse, vertices[0], vertices[1], ltc_case.light.w);
    } else if (count == 9u) {
        covered = ltc_line(inverse, vertices[0], vertices[1], ltc_case.light.w);
    } else if (count == 4u) {
        let corners = array<vec3<f32>, 4>(vertices[0], vertices[1], vertices[2], vertices[3]);
        covered = ltc_rectangle(inverse, corners, two_sided);
    } else {
        covered = ltc_polygon(inverse, vertices, count, two_sided);
    }
    // The reflected light of radiance L is L (f0 (amplitude - fresnel) + f90 fresnel) covered.
    ltc_result.m[0] = vec4(lobe.m[0], 0.0);
    ltc_result.m[1] = vec4(lobe.m[1], 0.0);
    ltc_result.m[2] = vec4(lobe.m[2], 0.0);
    ltc_result.terms = vec4(lobe.amplitude, lobe.fresnel, covered, 0.0);
}
