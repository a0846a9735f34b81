/// The reflected light of a disk, replaced by the regular octagon of the same area. The disk emits towards half_x x
/// half_y.
fn normals_disk(view: NormalsView, centre: vec3<f32>, half_x: vec3<f32>, half_y: vec3<f32>, two_sided: bool) -> vec2<f32> {
    var vertices: array<vec3<f32>, 8>;
    var turn = vec2(0.97368348, 0.4033129);
    for (var i = 0u; i < 8u; i++) {
        vertices[i] = centre + half_x * turn.x + half_y * turn.y;
        turn = 0.70710678 * vec2(turn.x + turn.y, turn.y - turn.x);
    }
    return normals_polygon(view, &vertices, 8u, two_sided);
}
