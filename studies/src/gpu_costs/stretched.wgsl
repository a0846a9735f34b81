// Directions are stretched along x and y by alpha divided by the mean alpha [Heitz 2014, section 5.3].
fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {
    let mean = sqrt(alpha.x * alpha.y);
    let stretch = vec3(alpha / mean, 1.0);
    let corners = array(
        stretch * local.corners[0],
        stretch * local.corners[1],
        stretch * local.corners[2],
        stretch * local.corners[3],
    );
    return engine_clipless(mean, normalize(stretch * local.wo), corners);
}
