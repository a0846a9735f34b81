// Lights of the scene in WGSL; as webgl/lights.js, whose comments hold here. SHAPES_USED is a constant that stands before these.

export const LIGHTS = `
const HORIZON: f32 = 1e-6;

fn is_shape(l: i32, shape: u32) -> bool {
	return (SHAPES_USED & (1u << shape)) != 0u && scene.light_shape[l] == i32(shape);
}
fn is_pictured(l: i32) -> bool {
	return (SHAPES_USED & 16u) != 0u && scene.light_picture[l] >= 0;
}
fn is_solid(l: i32) -> bool {
	return is_shape(l, 2u) || is_shape(l, 3u);
}

fn solid_basis(axis: vec3<f32>) -> mat2x3<f32> {
	let x = normalize(cross(select(vec3(0.0, 0.0, 1.0), vec3(1.0, 0.0, 0.0), abs(axis.z) > 0.7), axis));
	return mat2x3(x, cross(axis, x));
}

fn solid_nearest(l: i32, position: vec3<f32>) -> vec3<f32> {
	let start = scene.light_centre[l].xyz - position;
	let along = scene.light_x[l].xyz - scene.light_centre[l].xyz;
	return start + along * clamp(-dot(start, along) / max(dot(along, along), 1e-36), 0.0, 1.0);
}

fn unit_of(v: vec3<f32>) -> vec3<f32> {
	return v / sqrt(max(dot(v, v), 1e-36));
}
`;

export const OUTLINES = `
struct Outline {
	v: array<vec3<f32>, 8>,
	count: u32,
}

fn tube_end(end: vec3<f32>, outwards: vec3<f32>, beside: vec3<f32>, sideways: vec3<f32>, size: f32) -> array<vec3<f32>, 4> {
	let sine2 = size * size / dot(end, end);
	let centre = end * (1.0 - sine2);
	let radius = size * sqrt(max(1.0 - sine2, 0.0));
	let ahead = unit_of(outwards - end * (dot(outwards, end) / dot(end, end)));
	let beside2 = dot(beside, beside);
	let touched = -(beside * (size / beside2) - sideways * (sqrt(beside2 - size * size) / sqrt(beside2))) * size;
	let to_end = end + touched - centre;
	let cos_end = dot(to_end, ahead);
	let sin_end = dot(to_end, sideways);
	let half_arc = atan2(max(sin_end, 0.0), cos_end);
	let turn = vec2(sin(half_arc / 3.0), cos(half_arc / 3.0));
	let sine = 2.0 * turn.x * turn.y;
	let reach = radius * select(1.0, sqrt(1.0 + 2.0 * half_arc / max(sine, 1e-6)) - 1.0, half_arc > 1e-3);
	return array<vec3<f32>, 4>(
		centre + ahead * cos_end + sideways * sin_end, centre + (ahead * turn.y + sideways * turn.x) * reach,
		centre + (ahead * turn.y - sideways * turn.x) * reach, centre + ahead * cos_end - sideways * sin_end);
}

fn solid_outline(l: i32, position: vec3<f32>, sky: vec3<f32>) -> Outline {
	let start = scene.light_centre[l].xyz - position;
	let end = scene.light_x[l].xyz - position;
	let along = end - start;
	let size = scene.light_centre[l].w;
	var found: Outline;
	if (is_shape(l, 3u)) {
		let across = unit_of(cross(start, end)) * (0.5 * size);
		found.v = array<vec3<f32>, 8>(start - across, start + across, end + across, end - across, start, start, start, start);
		found.count = 4u;
		return found;
	}
	found.count = 8u;
	var nearest = solid_nearest(l, position);
	let beside = start - along * (dot(start, along) / max(dot(along, along), 1e-36));
	let is_inside = dot(nearest, nearest) <= size * size;
	if (is_inside || dot(along, along) == 0.0 || dot(beside, beside) <= size * size) {
		nearest = select(nearest, sky, is_inside);
		let radius = select(size, 0.999, is_inside);
		let sine2 = radius * radius / dot(nearest, nearest);
		let basis = solid_basis(unit_of(nearest)) * (radius * sqrt(1.0 - sine2) * 1.0539074);
		for (var i = 0; i < 8; i++) {
			let turn = (0.5 - f32(i)) * 0.78539816;
			found.v[i] = nearest * (1.0 - sine2) + basis * vec2(cos(turn), sin(turn));
		}
		return found;
	}
	let sideways = normalize(cross(along, beside));
	let a = tube_end(start, -along, beside, sideways, size);
	let b = tube_end(end, along, beside, -sideways, size);
	found.v = array<vec3<f32>, 8>(a[0], a[1], a[2], a[3], b[0], b[1], b[2], b[3]);
	return found;
}

fn outline_of(l: i32, at: Shaded) -> Outline {
	let to_local = transpose(mat3x3(at.x, at.y, at.z));
	var found: Outline;
	found.count = u32(scene.light_corners[l]);
	for (var i = 0; i < 8; i++) {
		found.v[i] = scene.light_vertices[8 * l + i].xyz - at.position;
	}
	if (is_solid(l)) {
		found = solid_outline(l, at.position, at.z);
	}
	for (var i = 0; i < 8; i++) {
		found.v[i] = to_local * found.v[i];
	}
	return found;
}
`;

const PICTURE = `
@group(1) @binding(6) var light_pictures: texture_2d_array<f32>;
fn picture_at(l: i32, position: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
	let normal = scene.light_normal[l].xyz;
	let away = dot(normal, scene.light_vertices[8 * l].xyz - position) / dot(normal, wi);
	let offset = position + away * wi - scene.light_centre[l].xyz;
	let across = vec2(dot(offset, scene.light_x[l].xyz), dot(offset, scene.light_y[l].xyz)) * vec2(scene.light_x[l].w, scene.light_y[l].w);
	let size = vec2<i32>(textureDimensions(light_pictures));
	let texel = clamp(vec2<i32>((0.5 + vec2(0.5, -0.5) * across) * vec2<f32>(size)), vec2(0), size - 1);
	return textureLoad(light_pictures, texel, scene.light_picture[l], 0).rgb;
}
`;

/** What a sampler of lights needs; with what those emit that have pictures. */
export const sampledLights = ( hasPictures ) => `${ hasPictures ? PICTURE : '' }
fn emitted(l: i32, position: vec3<f32>, wi: vec3<f32>) -> vec3<f32> {
${ hasPictures ? '	if (is_pictured(l)) {\n		return scene.light_radiance[l] * picture_at(l, position, wi);\n	}' : '' }
	return vec3(scene.light_radiance[l]);
}

fn tube_hit(l: i32, position: vec3<f32>, wi: vec3<f32>) -> vec2<f32> {
	let radius = scene.light_centre[l].w;
	let along = scene.light_x[l].xyz - scene.light_centre[l].xyz;
	let from_start = position - scene.light_centre[l].xyz;
	var found = vec2(-1.0, 0.0);
	for (var i = 0; i < 2; i++) {
		let from_end = select(from_start, from_start - along, i == 1);
		let away = -dot(wi, from_end);
		let beside = from_end + wi * away;
		let height2 = radius * radius - dot(beside, beside);
		let distance = away - sqrt(max(height2, 0.0));
		if (height2 > 0.0 && distance > 0.0 && (found.x < 0.0 || distance < found.x)) {
			found = vec2(distance, sqrt(height2) / radius);
		}
	}
	let normal = cross(wi, along);
	let sine2 = dot(normal, normal);
	let length2 = dot(along, along);
	let apart = dot(from_start, normal);
	let height2 = radius * radius * sine2 - apart * apart;
	if (sine2 > 1e-12 * length2 && height2 > 0.0) {
		let forth = length2 * dot(wi, from_start) - dot(from_start, along) * dot(wi, along);
		let distance = -(forth + sqrt(height2 * length2)) / sine2;
		let share = dot(from_start + wi * distance, along) / length2;
		if (distance > 0.0 && share > 0.0 && share < 1.0 && (found.x < 0.0 || distance < found.x)) {
			let outwards = from_start + wi * distance - along * share;
			found = vec2(distance, max(-dot(outwards, wi) / radius, 0.0));
		}
	}
	return found;
}

fn tube_area(along: vec3<f32>, radius: f32) -> vec2<f32> {
	let straight = length(along);
	return vec2(6.2831853 * radius * (straight + 2.0 * radius), straight / (straight + 2.0 * radius));
}

fn sphere_cap(sine2: f32) -> f32 {
	return sine2 / (1.0 + sqrt(max(1.0 - sine2, 0.0)));
}

fn light_pdf(l: i32, position: vec3<f32>, wi: vec3<f32>) -> f32 {
	if (is_shape(l, 3u)) {
		return -1.0;
	}
	if (is_shape(l, 2u)) {
		let radius = scene.light_centre[l].w;
		let nearest = solid_nearest(l, position);
		let distance2 = dot(nearest, nearest);
		if (distance2 <= radius * radius) {
			return 0.0;
		}
		let along = scene.light_x[l].xyz - scene.light_centre[l].xyz;
		if (dot(along, along) == 0.0) {
			let beside = cross(wi, nearest);
			let is_hit = dot(beside, beside) < radius * radius && dot(wi, nearest) > 0.0;
			return select(-1.0, 0.15915494 / sphere_cap(radius * radius / distance2), is_hit);
		}
		let hit = tube_hit(l, position, wi);
		return select(-1.0, hit.x * hit.x / (tube_area(along, radius).x * max(hit.y, 1e-6)), hit.x > 0.0);
	}
	let normal = scene.light_normal[l].xyz;
	let cosine = dot(normal, wi);
	if (-cosine <= HORIZON) {
		return -1.0;
	}
	let away = dot(normal, scene.light_vertices[8 * l].xyz - position) / cosine;
	if (away <= 0.0) {
		return -1.0;
	}
	let hit = position + away * wi;
	var is_hit = true;
	if (is_shape(l, 1u)) {
		let offset = hit - scene.light_centre[l].xyz;
		let across = vec2(dot(offset, scene.light_x[l].xyz), dot(offset, scene.light_y[l].xyz)) * vec2(scene.light_x[l].w, scene.light_y[l].w);
		is_hit = dot(across, across) <= 1.0;
	} else {
		var a = scene.light_vertices[8 * l + scene.light_corners[l] - 1].xyz;
		for (var i = 0; i < scene.light_corners[l]; i++) {
			let b = scene.light_vertices[8 * l + i].xyz;
			is_hit = is_hit && dot(cross(b - a, hit - a), normal) <= 0.0;
			a = b;
		}
	}
	return select(-1.0, away * away / (scene.light_normal[l].w * -cosine), is_hit);
}

fn light_point(l: i32, u: vec2<f32>) -> vec3<f32> {
	if (is_shape(l, 1u)) {
		let turn = sqrt(u.x) * vec2(cos(6.2831853 * u.y), sin(6.2831853 * u.y));
		return scene.light_centre[l].xyz + turn.x * scene.light_x[l].xyz + turn.y * scene.light_y[l].xyz;
	}
	var i = 2;
	for (var k = 2; k + 1 < scene.light_corners[l]; k++) {
		i += select(0, 1, u.x >= scene.light_vertices[8 * l + k].w);
	}
	let first = scene.light_vertices[8 * l + i - 1];
	let second = scene.light_vertices[8 * l + i];
	let origin = scene.light_vertices[8 * l].xyz;
	let root = sqrt(clamp((u.x - first.w) / (second.w - first.w), 0.0, 1.0));
	return origin + root * ((1.0 - u.y) * (first.xyz - origin) + u.y * (second.xyz - origin));
}

fn light_sample(l: i32, position: vec3<f32>, u: vec2<f32>) -> vec4<f32> {
	if (!is_solid(l)) {
		let way = light_point(l, u) - position;
		let distance2 = dot(way, way);
		let direction = way / sqrt(max(distance2, 1e-36));
		let facing = -dot(scene.light_normal[l].xyz, direction);
		return vec4(direction, select(0.0, distance2 / (scene.light_normal[l].w * facing), facing > HORIZON));
	}
	let start = scene.light_centre[l].xyz - position;
	let end = scene.light_x[l].xyz - position;
	let along = end - start;
	let size = scene.light_centre[l].w;
	if (is_shape(l, 3u)) {
		let normal = cross(start, end);
		let area = length(normal);
		let angle = atan2(area, dot(start, end));
		let towards = normalize(start);
		let direction = towards * cos(u.x * angle) + cross(normal / max(area, 1e-18), towards) * sin(u.x * angle);
		let distance = area / length(along) / max(dot(direction, normalize(cross(along, normal))), 1e-18);
		return vec4(direction, select(0.0, distance / (size * max(angle, 1e-18)), area > 0.0 && size > 0.0));
	}
	let nearest = solid_nearest(l, position);
	let distance2 = dot(nearest, nearest);
	if (distance2 <= size * size) {
		return vec4(0.0);
	}
	let turn = vec2(cos(6.2831853 * u.y), sin(6.2831853 * u.y));
	if (dot(along, along) == 0.0) {
		let cap = sphere_cap(size * size / distance2);
		let towards = nearest / sqrt(distance2);
		let beside = turn * sqrt(max(u.x * cap * (2.0 - u.x * cap), 0.0));
		return vec4(solid_basis(towards) * beside + towards * (1.0 - u.x * cap), 0.15915494 / cap);
	}
	let axis = normalize(along);
	let area = tube_area(along, size);
	var outwards = solid_basis(axis) * turn;
	var place = start + along * (u.x / area.y);
	if (u.x >= area.y) {
		let height = 1.0 - 2.0 * (u.x - area.y) / (1.0 - area.y);
		outwards = axis * height + outwards * sqrt(max(1.0 - height * height, 0.0));
		place = select(start, end, height > 0.0);
	}
	place += outwards * size;
	let away2 = dot(place, place);
	let direction = place / sqrt(away2);
	let facing = -dot(outwards, direction);
	return vec4(direction, select(0.0, away2 / (area.x * max(facing, 1e-6)), facing > 0.0));
}
`;
