const CHANNELS = 9, LONGEST = 24, AXES = [ 'alpha', 'ratio', 'theta', 'phi' ];
const ISOTROPIC = { ltc2017: 4 }; // index of the element by which M^-1 is divided

// The table of a compact form: `axes` has the nodes of each axis, `matrix` nine numbers an entry, row by row. `amplitude`
// and `fresnel` are arrays or null. Entries run over alpha, ratio, theta and phi, the last fastest. Throws a RangeError
// for bytes that are not a compact form.
export function decodeTable( bytes ) {

	const view = new DataView( bytes.buffer, bytes.byteOffset, bytes.byteLength );
	let at = 8;
	const name = () => String.fromCharCode( ...bytes.subarray( at + 1, at += 1 + bytes[ at ] ) );
	if ( String.fromCharCode( ...bytes.subarray( 0, 8 ) ) !== 'LTCcomp1' ) throw new RangeError( 'not a compact table of version 1' );
	const [ brdf, lobe, layout ] = [ name(), name(), name() ];
	if ( layout !== 'reflected' && layout !== 'kt2022' && layout !== 'ltc2017' ) throw new RangeError( 'unsupported layout ' + layout );
	const nodes = [], counts = [], axes = {};
	AXES.forEach( ( axis, i ) => {

		nodes.push( view.getUint16( at, true ) );
		counts.push( view.getUint8( at + 2 ) );
		axes[ axis ] = divide( layout, i, [ view.getFloat64( at + 3, true ), view.getFloat64( at + 11, true ) ], nodes[ i ] );
		at += 19;

	} );
	const entries = nodes.reduce( ( a, b ) => a * b );
	if ( ! ( entries > 0 && entries <= 1 << 20 ) || counts.some( ( n, i ) => n < 1 || n > nodes[ i ] || n > 28 ) ) throw new RangeError( 'invalid sizes' );
	const stored = view.getUint16( at, true ), corrected = view.getUint16( at + 2, true ), correction = view.getFloat32( at + 4, true ), steps = [];
	at += 8;
	for ( let c = 0; c < CHANNELS; c ++ ) {

		steps.push( stored >> c & 1 ? view.getFloat32( at, true ) : 0 );
		at += stored >> c & 1 ? 4 : 0;

	}

	// The range coder, and a function that decodes an array of integers.
	let code = view.getUint32( at ), range = 0xffffffff;
	at += 4;
	const bit = ( chances, i ) => {

		const bound = ( range >>> 11 ) * chances[ i ], one = code >= bound;
		if ( one ) {

			code -= bound;
			range -= bound;
			chances[ i ] -= chances[ i ] >> 4;

		} else {

			range = bound;
			chances[ i ] += 2048 - chances[ i ] >> 4;

		}

		while ( range < 0x1000000 ) {

			if ( at >= bytes.length ) throw new RangeError( 'the bytes end too early' );
			code = code * 256 + bytes[ at ++ ];
			range *= 256;

		}

		return one ? 1 : 0;

	};

	const models = () => new Uint16Array( 13 * LONGEST + LONGEST + 3 ).fill( 1024 );
	const integers = ( model, lengths ) => {

		const strides = [ lengths[ 1 ] * lengths[ 2 ] * lengths[ 3 ], lengths[ 2 ] * lengths[ 3 ], lengths[ 3 ], 1 ];
		const numbers = new Int32Array( strides[ 0 ] * lengths[ 0 ] ), seconds = 13 * LONGEST, low = seconds + LONGEST + 1;
		for ( let i = 0; i < numbers.length; i ++ ) {

			let sum = 0, bits = 0, magnitude = 1;
			for ( let axis = 0; axis < 4; axis ++ ) {

				const step = strides[ axis ], place = Math.floor( i / step ) % lengths[ axis ];
				if ( place > 0 ) sum += 2 * Math.abs( numbers[ i - step ] );
				if ( place > 1 ) sum += Math.abs( numbers[ i - 2 * step ] );

			}

			const first = Math.min( 32 - Math.clz32( sum ), 12 ) * LONGEST;
			while ( bits < LONGEST && bit( model, first + bits ) ) bits ++;
			if ( bits === 0 ) continue;
			for ( let place = bits - 2; place >= 0; place -- ) magnitude = 2 * magnitude + bit( model, place + 2 === bits ? seconds + bits : low );
			numbers[ i ] = bit( model, low + 1 ) ? - magnitude : magnitude;

		}

		return numbers;

	};

	// The values of each channel at the nodes.
	const bases = nodes.map( ( n, i ) => polynomials( n, counts[ i ] ) );
	const [ coefficients, corrections ] = [ models(), models() ];
	const channels = steps.map( ( step, c ) => {

		if ( step === 0 ) return new Float64Array( entries );
		let values = Float64Array.from( integers( coefficients, counts ), k => k * step ), after = 1;
		for ( let axis = 3; axis >= 0; axis -- ) {

			values = along( values, bases[ axis ], counts[ axis ], nodes[ axis ], after );
			after *= nodes[ axis ];

		}

		if ( corrected >> c & 1 ) integers( corrections, nodes ).forEach( ( k, i ) => values[ i ] += k * ( step * correction ) );
		return values;

	} );
	if ( at !== bytes.length ) throw new RangeError( 'bytes follow the end' );

	const hasTerms = ( stored >> 7 ) !== 0;
	const table = { brdf, lobe, layout, axes, matrix: new Float32Array( 9 * entries ), amplitude: hasTerms ? new Float32Array( entries ) : null, fresnel: hasTerms ? new Float32Array( entries ) : null };
	for ( let i = 0; i < entries; i ++ ) {

		const [ , ratio, theta, phi ] = nodes;
		const place = [ axes.alpha[ Math.floor( i / ( phi * theta * ratio ) ) ], axes.ratio[ Math.floor( i / ( phi * theta ) ) % ratio ], axes.theta[ Math.floor( i / phi ) % theta ], axes.phi[ i % phi ] ];
		const entry = store( layout, place, channels.map( channel => channel[ i ] ) );
		table.matrix.set( entry.matrix, 9 * i );
		if ( hasTerms ) [ table.amplitude[ i ], table.fresnel[ i ] ] = [ entry.amplitude, entry.fresnel ];

	}

	return table;

}

// The textures of a table in RGBA. Layouts `reflected` and `kt2022`: three volumes, x = phi, y = ratio * (nodes of theta)
// + theta, z = alpha. Layout `ltc2017`: LTC_1 and LTC_2, x = roughness, y = theta. The last channel of LTC_2 is the form
// factor of spheres; for it x is the cosine and y the length.
export function texturesOf( table ) {

	const { layout, axes, matrix, amplitude, fresnel } = table, entries = matrix.length / 9;
	const terms = i => amplitude ? [ amplitude[ i ], fresnel[ i ] ] : [ 1, 0 ];
	const texture = ( name, size, texel ) => {

		const data = new Float32Array( 4 * entries );
		for ( let i = 0; i < entries; i ++ ) data.set( texel( i, matrix.subarray( 9 * i, 9 * i + 9 ) ), 4 * i );
		return { name, width: size[ 0 ], height: size[ 1 ], depth: size[ 2 ], data };

	};

	const theta = axes.theta.length, alpha = axes.alpha.length;
	if ( ! ( layout in ISOTROPIC ) ) {

		const size = [ axes.phi.length, axes.ratio.length * theta, alpha ];
		return [
			texture( 'ltc_matrix_a', size, ( i, m ) => m.subarray( 0, 4 ) ),
			texture( 'ltc_matrix_b', size, ( i, m ) => m.subarray( 4, 8 ) ),
			texture( 'ltc_terms', size, ( i, m ) => [ m[ 8 ], ...terms( i ), 0 ] ),
		];

	}

	const size = [ alpha, theta, 1 ], entry = i => ( i % alpha ) * theta + Math.floor( i / alpha );
	const along = ( i, n ) => i / Math.max( n - 1, 1 );
	const of = ( i, ...places ) => places.map( place => matrix[ 9 * entry( i ) + place ] );
	return [
		texture( 'LTC_1', size, i => of( i, 0, 6, 2, 8 ) ),
		texture( 'LTC_2', size, i => [ ...terms( entry( i ) ), 0,
			clippedFormFactor( 2 * along( i % alpha, alpha ) - 1, along( Math.floor( i / alpha ), theta ) ) ] ),
	];

}

// The form factor of a spherical cap above the horizon, divided by that of the whole cap straight ahead. c is the cosine
// of the angle between the normal and the cap's middle; length is that of its vector form factor.
function clippedFormFactor( c, length ) {

	if ( Math.abs( c ) >= Math.sqrt( length ) ) return Math.max( c, 0 );
	const cosSigma = Math.sqrt( Math.max( 1 - length, 0 ) ), root = Math.sqrt( Math.max( length - c * c, 0 ) );
	const clipped = Math.atan2( root, - cosSigma * c ) * length * c - cosSigma * root + Math.atan2( root, cosSigma );
	return Math.max( clipped / ( Math.PI * length ), 0 );

}

// The nodes of an axis, evenly spaced in a coordinate of the layout.
function divide( layout, axis, [ low, high ], n ) {

	const ceiling = 0.9999 * ( Math.PI / 2 ), even = [ x => x, x => x ];
	const power = p => [ x => Math.pow( x, 1 / p ), u => Math.pow( u, p ) ];
	const versine = [ x => Math.SQRT2 * Math.sin( 0.5 * x ), u => 2 * Math.atan2( u, Math.sqrt( 2 - u * u ) ) ];
	const grazing = [ x => 1 - Math.sqrt( Math.max( 1 - x / ceiling, 0 ) ), u => ( 1 - ( 1 - u ) * ( 1 - u ) ) * ceiling ];
	const spacings = {
		reflected: [ power( 1.6 ), power( 1.3 ), grazing, even ],
		kt2022: [ even, even, even, even ],
		ltc2017: [ [ Math.sqrt, u => u * u ], even, versine, even ],
	};
	const [ invert, value ] = spacings[ layout ][ axis ];
	const floor = layout in ISOTROPIC || axis > 1 ? 0 : 1e-4, last = Math.max( n - 1, 1 );
	const [ from, to ] = [ invert( low ), invert( high ) ];
	const at = i => i === 0 ? low : i === last ? high : value( from + ( to - from ) * ( i / last ) );
	return Float64Array.from( { length: n }, ( _, i ) => Math.max( at( i ), floor ) );

}

// Polynomials that are orthonormal on n nodes [Gram 1883], one in each row.
function polynomials( n, count ) {

	const rows = [ new Float64Array( n ).fill( 1 / Math.sqrt( n ) ) ];
	for ( let k = 1, before = 0; k < count; k ++ ) {

		const weight = Math.sqrt( k * k * ( n * n - k * k ) / ( 4 * ( 4 * ( k * k ) - 1 ) ) ), previous = before;
		rows.push( rows[ k - 1 ].map( ( last, i ) => ( ( i - 0.5 * ( n - 1 ) ) * last - previous * ( k > 1 ? rows[ k - 2 ][ i ] : 0 ) ) / weight ) );
		before = weight;

	}

	return rows;

}

// The array with one axis of `count` coefficients, `after` numbers each, replaced by values at n nodes.
function along( array, basis, count, n, after ) {

	const blocks = array.length / ( count * after ), made = new Float64Array( blocks * n * after );
	for ( let b = 0; b < blocks; b ++ ) for ( let i = 0; i < n; i ++ ) for ( let k = 0; k < count; k ++ ) {

		const factor = basis[ k ][ i ], to = ( b * n + i ) * after, from = ( b * count + k ) * after;
		for ( let j = 0; j < after; j ++ ) made[ to + j ] += factor * array[ from + j ];

	}

	return made;

}

// The matrix and terms that a layout stores, from the nine smooth numbers of an entry. Matrices are lists of three columns.
function store( layout, [ alpha, ratio, theta, phi ], numbers ) {

	[ alpha, theta ] = [ Math.max( alpha, 1e-4 ), Math.min( theta, 0.9999 * ( Math.PI / 2 ) ) ];
	const inX = theta === 0 || phi === 0, inY = theta === 0 || phi === Math.PI / 2;
	let [ p, l, q, across, along, rowX, rowY, amplitude, fresnel ] = numbers;
	if ( inY ) l = across = rowX = 0;
	if ( inX ) l = along = rowY = 0;
	if ( layout !== 'reflected' ) [ rowX, rowY ] = [ rowX, rowY ].map( x => x * ( alpha / ( alpha + 0.002 ) ) );
	[ across, along ] = [ across, along ].map( x => Math.min( Math.max( x, - 1 ), 1 ) );
	[ p, q ] = [ Math.max( p, 0.004 ), Math.max( q, 0.004 ) ];
	const [ a, b, d ] = [ p * p, p * l, l * l + q * q ], square = across * across + along * along;
	const column = [ 2 * across / ( 1 + square ), 2 * along / ( 1 + square ), ( 1 - square ) / ( 1 + square ) ];
	const [ x, y, z ] = column, height = Math.max( z, 0.05 );
	const [ f, g ] = [ ( rowX + x * a + y * b ) / height, ( rowY + x * b + y * d ) / height ];
	const s = turned( times( rotation( column ), [ [ a, b, f ], [ b, d, g ], [ 0, 0, 1 ] ] ) );
	amplitude = Math.max( amplitude, 0 );
	if ( layout === 'reflected' ) return { matrix: rowMajor( s ), amplitude, fresnel };

	// The lobe is its reflection times s.
	const cosPhi = phi === Math.PI / 2 ? 0 : Math.cos( phi ), sinPhi = Math.sin( phi );
	const wo = [ Math.sin( theta ) * cosPhi, Math.sin( theta ) * sinPhi, Math.cos( theta ) ], k = reflection( alpha, Math.max( alpha * ratio, 1e-5 ), wo );
	amplitude *= k.amplitude;
	fresnel = amplitude * Math.pow( Math.max( fresnel + k.grazing, 0 ), 5 );
	let m = times( k.matrix, s );
	const direction = unit( m[ 2 ] ), frame = rotation( direction );
	const local = turned( times( transposed( frame ), m ) );
	const [ xx, xy, yy ] = [ local[ 0 ][ 0 ], local[ 0 ][ 1 ], local[ 1 ][ 1 ] ];
	const larger = 0.5 * ( xx + yy ) + Math.sqrt( Math.pow( 0.5 * ( xx - yy ), 2 ) + xy * xy );
	const lacking = Math.max( ( layout === 'kt2022' ? 1e-4 : 1e-5 ) * larger - ( xx * yy - xy * xy ) / larger, 0 );
	local[ 0 ][ 0 ] += lacking;
	local[ 1 ][ 1 ] += lacking;
	m = times( frame, local );
	for ( const [ axis, mirrored ] of [ inY, inX ].entries() ) for ( let other = 0; other < 3; other ++ ) if ( mirrored && other !== axis ) m[ axis ][ other ] = m[ other ][ axis ] = 0;
	const inverse = ISOTROPIC[ layout ] ?? null;
	if ( inverse !== null ) {

		const [ [ ma, , me ], [ , mc ], [ mb, , md ] ] = m;
		m = [ [ md, 0, - me ], [ 0, ( ma * md - mb * me ) / mc, 0 ], [ - mb, 0, ma ] ];

	}

	// The element is on the diagonal, so rows and columns give the same index.
	const norm = inverse === null ? Math.hypot( ...m[ 2 ] ) : m[ inverse / 4 ][ inverse / 4 ];
	m = m.map( column => column.map( element => element / norm ) );
	if ( layout in ISOTROPIC ) m = m.map( ( column, i ) => column.map( ( element, j ) => {

		const bounded = Math.min( Math.max( element, - 60000 ), 60000 );
		return i === j ? Math.max( bounded, 1e-30 ) : bounded;

	} ) );
	return { matrix: rowMajor( m ), amplitude, fresnel };

}

// The reflection at the middle of the visible normals.
function reflection( ax, ay, wo ) {

	const s = unit( [ ax * wo[ 0 ], ay * wo[ 1 ], wo[ 2 ] ] );
	const wm = unit( [ ax * s[ 0 ], ay * s[ 1 ], s[ 2 ] + 1 ] ), d = dot( wo, wm );
	const r = wm.map( ( n, i ) => 2 * d * n - wo[ i ] );
	const column = axis => {

		const tilt = wm.map( ( n, i ) => ( i === axis ? 1 : 0 ) - wm[ axis ] * n ), along = dot( wo, tilt );
		return wm.map( ( n, i ) => 2 * ax * ( along * n + d * tilt[ i ] ) );

	};

	const lambda = w => 0.5 * ( Math.sqrt( 1 + Math.pow( ax * w[ 0 ] / w[ 2 ], 2 ) + Math.pow( ay * w[ 1 ] / w[ 2 ], 2 ) ) - 1 );
	const perG1 = 1 + lambda( wo ), g = r[ 2 ] > 0 ? perG1 / ( perG1 + lambda( r ) ) : 0;
	return { matrix: [ column( 0 ), column( 1 ), r ], amplitude: g * g, grazing: 1 - d };

}

// The smallest rotation that takes +z to a direction.
function rotation( [ x, y, z ] ) {

	const k = 1 / ( 1 + z );
	return [ [ 1 - x * x * k, - x * y * k, - x ], [ - x * y * k, 1 - y * y * k, - y ], [ x, y, z ] ];

}

// The first two columns, rotated so that their upper block is symmetric.
function turned( [ x, y, z ] ) {

	let [ cos, sin ] = [ x[ 0 ] + y[ 1 ], x[ 1 ] - y[ 0 ] ];
	const length = Math.sqrt( cos * cos + sin * sin );
	if ( ! ( length > 0 ) ) return [ x, y, z ];
	[ cos, sin ] = [ cos / length, sin / length ];
	return [ x.map( ( e, i ) => e * cos - y[ i ] * sin ), x.map( ( e, i ) => e * sin + y[ i ] * cos ), z ];

}

function times( a, b ) {

	return b.map( column => [ 0, 1, 2 ].map( i => a[ 0 ][ i ] * column[ 0 ] + a[ 1 ][ i ] * column[ 1 ] + a[ 2 ][ i ] * column[ 2 ] ) );

}

function transposed( m ) {

	return [ 0, 1, 2 ].map( i => m.map( column => column[ i ] ) );

}

function rowMajor( m ) {

	return transposed( m ).flat();

}

function dot( a, b ) {

	return a[ 0 ] * b[ 0 ] + a[ 1 ] * b[ 1 ] + a[ 2 ] * b[ 2 ];

}

function unit( v ) {

	const length = Math.sqrt( dot( v, v ) );
	return v.map( element => element / length );

}
