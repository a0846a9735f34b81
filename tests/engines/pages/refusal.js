/** The message of the error that `work` throws; nothing where it throws none. */
export function refusal( work ) {

	try {

		work();

	} catch ( error ) {

		return `${ error.name }: ${ error.message }`;

	}

	return null;

}
