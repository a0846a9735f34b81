// Sampling of lights: directions, and densities per steradian.
/** Intersects a tube or line with the ray along wi. x: distance, negative for a miss. y: cosine at the surface. */
vec2 tube_hit( int l, vec3 position, vec3 wi ) {
	float radius = light_centre[l].w * ( is_shape( l, 3 ) ? 0.5 : 1.0 );
	vec3 along = light_x[l].xyz - light_centre[l].xyz;
	vec3 from_start = position - light_centre[l].xyz;
	vec2 found = vec2( - 1.0, 0.0 );
	for ( int i = 0; i < 2; i ++ ) {
		vec3 from_end = i == 1 ? from_start - along : from_start;
		float away = - dot( wi, from_end );
		vec3 beside = from_end + wi * away;
		float height2 = radius * radius - dot( beside, beside );
		float distance = away - sqrt( max( height2, 0.0 ) );
		if ( height2 > 0.0 && distance > 0.0 && ( found.x < 0.0 || distance < found.x ) ) found = vec2( distance, sqrt( height2 ) / radius );
	}
	vec3 normal = cross( wi, along );
	float sine2 = dot( normal, normal );
	float length2 = dot( along, along );
	float apart = dot( from_start, normal );
	float height2 = radius * radius * sine2 - apart * apart;
	if ( sine2 > 1e-12 * length2 && height2 > 0.0 ) {
		float forth = length2 * dot( wi, from_start ) - dot( from_start, along ) * dot( wi, along );
		float distance = - ( forth + sqrt( height2 * length2 ) ) / sine2;
		float share = dot( from_start + wi * distance, along ) / length2;
		if ( distance > 0.0 && share > 0.0 && share < 1.0 && ( found.x < 0.0 || distance < found.x ) ) {
			vec3 outwards = from_start + wi * distance - along * share;
			found = vec2( distance, max( - dot( outwards, wi ) / radius, 0.0 ) );
		}
	}
	return found;
}

/** x: area of a tube. y: fraction of the area in its straight part. */
vec2 tube_area( vec3 along, float radius ) {
	float straight = length( along );
	return vec2( 6.2831853 * radius * ( straight + 2.0 * radius ), straight / ( straight + 2.0 * radius ) );
}

/** 1 - cosine of a spherical cap, from the squared sine. */
float sphere_cap( float sine2 ) { return sine2 / ( 1.0 + sqrt( max( 1.0 - sine2, 0.0 ) ) ); }

/** The cosine at which a flat light emits, from the cosine at its front. Not above zero behind a light with one side. */
float emitting( int l, float cosine ) { return light_two_sided[l] != 0 ? abs( cosine ) : cosine; }

/** Intersects a polygon or ellipse with the ray along wi. x: distance, negative for a miss. y: cosine at which the light emits. */
vec2 flat_hit( int l, vec3 position, vec3 wi ) {
	vec3 normal = light_normal[l].xyz;
	float cosine = dot( normal, wi );
	float away = abs( cosine ) > HORIZON ? dot( normal, light_vertices[8 * l].xyz - position ) / cosine : - 1.0;
	if ( away <= 0.0 ) return vec2( - 1.0, 0.0 );
	vec3 hit = position + away * wi;
	bool is_hit = true;
	if ( is_shape( l, 1 ) ) {
		vec3 offset = hit - light_centre[l].xyz;
		vec2 across = vec2( dot( offset, light_x[l].xyz ), dot( offset, light_y[l].xyz ) ) * vec2( light_x[l].w, light_y[l].w );
		is_hit = dot( across, across ) <= 1.0;
	} else {
		vec3 a = light_vertices[8 * l + light_corners[l] - 1].xyz;
		for ( int i = 0; i < light_corners[l]; i ++ ) {
			vec3 b = light_vertices[8 * l + i].xyz;
			is_hit = is_hit && dot( cross( b - a, hit - a ), normal ) <= 0.0;
			a = b;
		}
	}
	return vec2( is_hit ? away : - 1.0, emitting( l, - cosine ) );
}

#if SHAPES_USED & 32
/** A ball: centre and radius. A box: lowest and highest coordinates. Without extent, they are missing. */
uniform vec4 ball;
uniform vec3 box_low, box_high;

/** xyz: the normal of the occluder that a ray meets first. w: its distance, zero if there is none. */
vec4 occluder_hit( vec3 from, vec3 ray ) {
	vec4 found = vec4( 0.0 );
	vec3 middle = from - ball.xyz;
	float along = - dot( middle, ray );
	float height2 = ball.w * ball.w - dot( middle + along * ray, middle + along * ray );
	float away = along - sqrt( max( height2, 0.0 ) );
	if ( height2 > 0.0 && away > 1e-4 ) found = vec4( ( middle + away * ray ) / ball.w, away );
	vec3 low = ( box_low - from ) / ray, high = ( box_high - from ) / ray;
	vec3 enters = min( low, high ), leaves = max( low, high );
	float enter = max( max( enters.x, enters.y ), enters.z );
	if ( enter > 1e-4 && enter < min( min( leaves.x, leaves.y ), leaves.z ) && ( found.w == 0.0 || enter < found.w ) ) found = vec4( - sign( ray ) * vec3( equal( enters, vec3( enter ) ) ), enter );
	return found;
}

/** Whether an occluder hides a light in the direction wi. */
bool is_hidden( int l, vec3 position, vec3 wi ) {
	float away = occluder_hit( position, wi ).w;
	if ( away == 0.0 ) return false;
	float of_light = is_solid( l ) ? tube_hit( l, position, wi ).x : flat_hit( l, position, wi ).x;
	return of_light < 0.0 || away < of_light;
}
#else
bool is_hidden( int l, vec3 position, vec3 wi ) { return false; }
#endif

/** The density of light_sample in the direction wi. Negative if wi misses the light, zero if light_sample does not sample the light. */
float light_pdf( int l, vec3 position, vec3 wi ) {
	if ( is_shape( l, 3 ) ) return - 1.0;
	if ( is_shape( l, 2 ) ) {
		float radius = light_centre[l].w;
		vec3 nearest = solid_nearest( l, position );
		float distance2 = dot( nearest, nearest );
		if ( distance2 <= radius * radius ) return 0.0;
		vec3 along = light_x[l].xyz - light_centre[l].xyz;
		if ( dot( along, along ) == 0.0 ) {
			vec3 beside = cross( wi, nearest );
			bool is_hit = dot( beside, beside ) < radius * radius && dot( wi, nearest ) > 0.0;
			return is_hit ? 0.15915494 / sphere_cap( radius * radius / distance2 ) : - 1.0;
		}
		vec2 hit = tube_hit( l, position, wi );
		return hit.x > 0.0 ? hit.x * hit.x / ( tube_area( along, radius ).x * max( hit.y, 1e-6 ) ) : - 1.0;
	}
	vec2 hit = flat_hit( l, position, wi );
	return hit.x > 0.0 && hit.y > HORIZON ? hit.x * hit.x / ( light_normal[l].w * hit.y ) : - 1.0;
}

#if SHAPES_USED & 16
uniform highp sampler2DArray light_pictures;
/** The colour of a picture where wi meets the rectangle, relative to its radiance. Texels are not interpolated. */
vec3 picture_at( int l, vec3 position, vec3 wi ) {
	vec3 normal = light_normal[l].xyz;
	vec3 offset = position + dot( normal, light_vertices[8 * l].xyz - position ) / dot( normal, wi ) * wi - light_centre[l].xyz;
	vec2 at = 0.5 + vec2( 0.5, - 0.5 ) * vec2( dot( offset, light_x[l].xyz ), dot( offset, light_y[l].xyz ) ) * vec2( light_x[l].w, light_y[l].w );
	ivec2 size = textureSize( light_pictures, 0 ).xy;
	return texelFetch( light_pictures, ivec3( clamp( ivec2( at * vec2( size ) ), ivec2( 0 ), size - 1 ), light_picture[l] ), 0 ).rgb;
}
#endif

/** The radiance that a light emits towards a point along wi. */
vec3 emitted( int l, vec3 position, vec3 wi ) {
#if SHAPES_USED & 16
	if ( is_pictured( l ) ) return light_radiance[l] * picture_at( l, position, wi );
#endif
	return light_radiance[l];
}

/** A point on a polygon or ellipse, uniformly distributed by area. */
vec3 light_point( int l, vec2 u ) {
	if ( is_shape( l, 1 ) ) {
		float radius = sqrt( u.x );
		return light_centre[l].xyz + radius * ( cos( 6.2831853 * u.y ) * light_x[l].xyz + sin( 6.2831853 * u.y ) * light_y[l].xyz );
	}
	int i = 2;
	for ( int k = 2; k + 1 < light_corners[l]; k ++ ) i += u.x >= light_vertices[8 * l + k].w ? 1 : 0;
	vec4 first = light_vertices[8 * l + i - 1];
	vec4 second = light_vertices[8 * l + i];
	vec3 origin = light_vertices[8 * l].xyz;
	float root = sqrt( clamp( ( u.x - first.w ) / ( second.w - first.w ), 0.0, 1.0 ) );
	return origin + root * ( ( 1.0 - u.y ) * ( first.xyz - origin ) + u.y * ( second.xyz - origin ) );
}

/** xyz: a sampled direction to the light. w: its density, zero if the light does not emit towards the shaded point. */
vec4 light_sample( int l, vec3 position, vec2 u ) {
	if ( ! is_solid( l ) ) {
		vec3 way = light_point( l, u ) - position;
		float distance2 = dot( way, way );
		vec3 direction = way / sqrt( max( distance2, 1e-36 ) );
		float facing = emitting( l, - dot( light_normal[l].xyz, direction ) );
		return vec4( direction, facing > HORIZON ? distance2 / ( light_normal[l].w * facing ) : 0.0 );
	}
	vec3 start = light_centre[l].xyz - position;
	vec3 end = light_x[l].xyz - position;
	vec3 along = end - start;
	float size = light_centre[l].w;
	if ( is_shape( l, 3 ) ) {
		vec3 normal = cross( start, end );
		float area = length( normal );
		float angle = atan( area, dot( start, end ) );
		vec3 towards = normalize( start );
		vec3 direction = towards * cos( u.x * angle ) + cross( normal / max( area, 1e-18 ), towards ) * sin( u.x * angle );
		float distance = area / length( along ) / max( dot( direction, normalize( cross( along, normal ) ) ), 1e-18 );
		return vec4( direction, area > 0.0 && size > 0.0 ? distance / ( size * max( angle, 1e-18 ) ) : 0.0 );
	}
	vec3 nearest = solid_nearest( l, position );
	float distance2 = dot( nearest, nearest );
	if ( distance2 <= size * size ) return vec4( 0.0 );
	vec2 turn = vec2( cos( 6.2831853 * u.y ), sin( 6.2831853 * u.y ) );
	if ( dot( along, along ) == 0.0 ) {
		float cap = sphere_cap( size * size / distance2 );
		vec3 towards = nearest / sqrt( distance2 );
		vec2 beside = turn * sqrt( max( u.x * cap * ( 2.0 - u.x * cap ), 0.0 ) );
		return vec4( solid_basis( towards ) * beside + towards * ( 1.0 - u.x * cap ), 0.15915494 / cap );
	}
	vec3 axis = normalize( along );
	vec2 area = tube_area( along, size );
	vec3 outwards = solid_basis( axis ) * turn;
	vec3 place = start + along * ( u.x / area.y );
	if ( u.x >= area.y ) {
		float height = 1.0 - 2.0 * ( u.x - area.y ) / ( 1.0 - area.y );
		outwards = axis * height + outwards * sqrt( max( 1.0 - height * height, 0.0 ) );
		place = height > 0.0 ? end : start;
	}
	place += outwards * size;
	float away2 = dot( place, place );
	vec3 direction = place / sqrt( away2 );
	float facing = - dot( outwards, direction );
	return vec4( direction, facing > 0.0 ? away2 / ( area.x * max( facing, 1e-6 ) ) : 0.0 );
}
