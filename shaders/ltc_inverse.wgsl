/// The inverse of M: the adjugate divided by its largest element. The determinant may underflow, and the inverse of a
/// sharp lobe has elements of size 1 / alpha. This form needs no determinant and keeps vertices of any size in range.
fn ltc_inverse(m: mat3x3<f32>) -> LtcInverse {
    let x = cross(m[1], m[2]);
    let y = cross(m[2], m[0]);
    let z = cross(m[0], m[1]);
    let most = max(max(abs(x), abs(y)), abs(z));
    let largest = max(max(most.x, most.y), most.z);
    let side = select(0.0, sign(dot(m[2], z)), largest > 1e-30 && largest < 1e30);
    let scale = side / max(largest, 1e-30);
    return LtcInverse(transpose(mat3x3(x * scale, y * scale, z * scale)), side);
}
