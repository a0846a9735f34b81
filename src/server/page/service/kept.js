// Keeps the last dropped scene in the browser, so that a reload shows it again. Links do not contain files.

let last = null;

/** The result of a request to the browser's database. */
const done = ( request ) => new Promise( ( resolve, reject ) => Object.assign( request, { onsuccess: () => resolve( request.result ), onerror: () => reject( request.error ) } ) );

/** The result of a request to the store of files. Closes the database, because an open database cannot be deleted. */
async function files( mode, ask ) {
	const request = indexedDB.open( 'ltcforge', 1 );
	request.onupgradeneeded = () => request.result.createObjectStore( 'files' );
	const database = await done( request );
	try {
		return await done( ask( database.transaction( 'files', mode ).objectStore( 'files' ) ) );
	} finally {
		database.close();
	}
}

/** Holds a file until a reload. */
export const hold = ( file ) => last = file;

/** Keeps a file. Without a database, for example in a private window, the file is kept until a reload. */
export async function keep( file ) {
	last = file;
	await files( 'readwrite', ( store ) => store.put( file, 'scene' ) ).catch( () => {} );
}

/** The file that was kept last, or null. */
export async function kept() {
	return last ??= await files( 'readonly', ( store ) => store.get( 'scene' ) ).catch( () => null ) ?? null;
}
