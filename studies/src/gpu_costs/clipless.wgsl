fn lit(alpha: vec2<f32>, seen: Seen) -> vec4<f32> {
    return engine_clipless(sqrt(alpha.x * alpha.y), seen.wo, seen.corners);
}
