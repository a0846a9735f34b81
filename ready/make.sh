#!/bin/sh
# Makes the files of this folder: ready/make.sh FOLDER. LTCFORGE is the program to run.
set -eu
out=$1
ltcforge=${LTCFORGE:-ltcforge}
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# Fits a recipe, and prints the path of the table.
fit() {
	digest=$(echo "$1" | "$ltcforge" fit - -o "$work" 2>/dev/null | tail -n 1)
	echo "$work/${digest#sha256:}.safetensors"
}

# export_as TABLE FOLDER LAYOUT CONTAINER
export_as() {
	"$ltcforge" export "$1" --layout "$3" --container "$4" --precision half -o "$2" >/dev/null
	rm "$2/ltcforge.json"
}

mixed='"precision": "f16", "fresnel": [{"f0": 1}, {"f0": 0.04, "weight": 4}]'
table=$(fit "{$mixed}")
isotropic=$(fit "{\"layout\": \"ltc2017\", $mixed}")

for container in dds c ktx2; do
	export_as "$table" "$out/anisotropic" reflected-array "$container"
done
export_as "$isotropic" "$out/isotropic" ltc2017 ktx2

for language in glsl hlsl msl wgsl; do
	"$ltcforge" shader --language "$language" --model ltc-formula --lights rectangles -o "$out/ltc_formula.$language"
	for rule in fast balanced; do
		"$ltcforge" shader --language "$language" --model normals --rule "$rule" -o "$out/normals_$rule.$language"
	done
done
