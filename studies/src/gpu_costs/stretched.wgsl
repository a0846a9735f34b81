// Directions are stretched along x and y by alpha over the mean one [Heitz 2014, section 5.3].
fn lit(alpha: vec2<f32>, seen: Seen) -> vec4<f32> {
    let mean = sqrt(alpha.x * alpha.y);
    let stretch = vec3(alpha / mean, 1.0);
    let corners = array(
        stretch * seen.corners[0],
        stretch * seen.corners[1],
        stretch * seen.corners[2],
        stretch * seen.corners[3],
    );
    return engine_clipless(mean, normalize(stretch * seen.wo), corners);
}
