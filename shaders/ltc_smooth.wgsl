// Builds the matrix of layout reflected from seven numbers that vary smoothly. Compact forms of tables store these
// numbers. Any values give a matrix with a positive determinant.

/// The smallest rotation that takes +z to a unit vector other than -z.
fn ltc_from_z(axis: vec3<f32>) -> mat3x3<f32> {
    let k = 1.0 / (1.0 + axis.z);
    return mat3x3(
        vec3(1.0 - axis.x * axis.x * k, -axis.x * axis.y * k, -axis.x),
        vec3(-axis.x * axis.y * k, 1.0 - axis.y * axis.y * k, -axis.y),
        axis,
    );
}

/// Builds the matrix. root: p, l and q of the Cholesky factor (p, 0; l, q) of the upper block. slant: the stereographic
/// projection of the third column. row: the last row, times the height of the third column.
fn ltc_of_smooth(root: vec3<f32>, slant: vec2<f32>, row: vec2<f32>) -> mat3x3<f32> {
    let p = max(root.x, 0.004);
    let q = max(root.z, 0.004);
    let a = p * p;
    let b = p * root.y;
    let d = root.y * root.y + q * q;
    let bounded = clamp(slant, vec2(-1.0), vec2(1.0));
    let square = dot(bounded, bounded);
    let axis = vec3(2.0 * bounded, 1.0 - square) / (1.0 + square);
    let height = max(axis.z, 0.05);
    let f = (row.x + axis.x * a + axis.y * b) / height;
    let g = (row.y + axis.x * b + axis.y * d) / height;
    let m = ltc_from_z(axis) * mat3x3(vec3(a, b, f), vec3(b, d, g), vec3(0.0, 0.0, 1.0));
    // Rotate the first two columns so that their upper block is symmetric.
    let turn = vec2(m[0].x + m[1].y, m[1].x - m[0].y);
    let length2 = dot(turn, turn);
    if (!(length2 > 0.0)) {
        return m;
    }
    let by = turn / sqrt(length2);
    return mat3x3(m[0] * by.x - m[1] * by.y, m[0] * by.y + m[1] * by.x, m[2]);
}
