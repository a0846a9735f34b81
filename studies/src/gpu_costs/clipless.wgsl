fn lit(alpha: vec2<f32>, local: Local) -> vec4<f32> {
    return engine_clipless(sqrt(alpha.x * alpha.y), local.wo, local.corners);
}
