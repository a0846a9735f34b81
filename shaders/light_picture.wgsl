// The picture on the preview's rectangle light, unfiltered. Needs ggx_reference.wgsl.

/// The picture, its prefiltered levels for the light models, and their sampler. Without a picture, each texture has one
/// texel.
@group(2) @binding(0) var light_image: texture_2d<f32>;
@group(2) @binding(1) var light_pictures: texture_2d_array<f32>;
@group(2) @binding(2) var light_picture_sampler: sampler;

/// Whether the light has a picture, and how often the models read it. Both are pipeline constants.
override light_has_picture: bool = false;
override light_readings: u32 = 4u;

/// The point where a ray meets the light's plane, as fractions of the picture's width and height (xy), and its distance
/// (z).
fn light_met(start: vec3<f32>, ray: vec3<f32>) -> vec3<f32> {
    let corner = light.vertices[0].xyz;
    let x = light.vertices[1].xyz - corner;
    let y = light.vertices[3].xyz - corner;
    let away = dot(light.normal.xyz, corner - start) / dot(light.normal.xyz, ray);
    let p = start + away * ray - corner;
    return vec3(dot(p, x) / dot(x, x), dot(p, y) / dot(y, y), away);
}

/// The texel of the picture at uv, from 0 to 1.
fn light_texel(uv: vec2<f32>) -> vec3<f32> {
    let size = textureDimensions(light_image);
    let texel = vec2<u32>(clamp(uv, vec2(0.0), vec2(1.0)) * vec2<f32>(size));
    return textureLoad(light_image, min(texel, size - 1u), 0).xyz;
}

/// The colour of the light that arrives from direction wi.
fn light_colour(position: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
    if (light_has_picture) {
        return light_texel(light_met(position, wi).xy);
    }
    return vec3(1.0);
}
