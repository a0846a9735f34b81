//! Pages, packages and shaders of the examples, for the tests of all engines.

use std::{
    os::unix::fs::symlink,
    sync::{LazyLock, OnceLock},
};

use super::*;

/// A page, as `example.js` reports it.
#[derive(Deserialize)]
struct Example {
    /// The mean errors of the pictures, in linear radiance: by the `stock` engine, by a `table`, and by each rule of
    /// `normals`.
    errors: BTreeMap<String, f64>,
    /// The browser's warnings and errors.
    faults: Vec<String>,
}

/// The examples by engine and number of lights.
type Examples = BTreeMap<String, BTreeMap<String, Example>>;

/// Checks the errors on an example's page against upper bounds, under one light and under four. `None` without a
/// browser. One run draws all engines, because they share the truth.
pub(crate) fn hold_errors(engine: &str, greatest: &[(&str, [f64; 2])]) -> Option<&'static BTreeMap<String, f64>> {
    static EXAMPLES: OnceLock<Option<Examples>> = OnceLock::new();
    let examples = EXAMPLES.get_or_init(|| script("example.js", &[])).as_ref()?;
    for (lights, index) in [("1", 0), ("4", 1)] {
        let Example { errors, faults } = &examples[engine][lights];
        print(&format!("examples/{engine}, {lights} lights: mean errors {errors:.5?}"));
        assert_eq!(*faults, [""; 0]);
        for (way, most) in greatest {
            let error = errors.get(*way).unwrap_or_else(|| panic!("{way}: {errors:?}"));
            assert!(*error < most[index], "{way}, {lights} lights: {errors:?}");
        }
        // The examples show anisotropy, which stock engines do not support.
        assert!(errors["stock"] > 100.0 * errors["fast"], "{lights} lights: {errors:?}");
    }
    Some(&examples[engine]["1"].errors)
}

/// The difference between two pictures.
#[derive(Debug, Deserialize)]
pub(crate) struct Apart {
    pub(crate) most: f64,
    pub(crate) mean: f64,
}

/// The output of `package.js`.
#[derive(Deserialize)]
pub(crate) struct Package {
    /// The difference between each picture and `ours`, a picture of a patched material.
    #[serde(rename = "fromOurs")]
    pub(crate) from_ours: BTreeMap<String, Apart>,
    /// The difference between each picture and the picture of the stock engine.
    #[serde(rename = "fromStock")]
    pub(crate) from_stock: BTreeMap<String, Apart>,
    /// Error messages. `None` if there was no error.
    refusals: BTreeMap<String, Option<String>>,
    /// The difference between a coat and white metal, with and without clusters.
    #[serde(default)]
    pub(crate) coats: Vec<f64>,
    /// Whether a rejected material has none of our chunks.
    #[serde(default, rename = "leavesRefused")]
    pub(crate) leaves_refused: bool,
    /// Whether a user's own chunk is kept.
    #[serde(default, rename = "leavesOwn")]
    pub(crate) leaves_own: bool,
    /// The share of the pixels of the README's page that are lit.
    readme: f64,
    faults: Vec<String>,
}

impl Package {
    /// Checks that these pictures are identical to `ours`.
    pub(crate) fn same_as_ours(&self, names: &[&str]) {
        for name in names {
            assert!(self.from_ours[*name].most == 0.0, "{name}: {:?}", self.from_ours);
        }
    }

    /// Checks that these pictures are identical to those of the stock engine.
    pub(crate) fn same_as_stock(&self, names: &[&str]) {
        for name in names {
            assert!(self.from_stock[*name].most == 0.0, "{name}: {:?}", self.from_stock);
        }
    }

    /// Checks that these pictures differ from `ours` by at least this much. Otherwise the other checks could not fail.
    pub(crate) fn differ_from_ours(&self, names: &[(&str, f64)]) {
        for (name, least) in names {
            assert!(self.from_ours[*name].mean > *least, "{name}: {:?}", self.from_ours);
        }
    }
}

/// The report of an example's package, packed with npm. Checks `refusals` and the page of the README. `None` if it
/// cannot run.
pub(crate) fn package(engine: &str, refusals: &[(&str, &str)]) -> Option<Package> {
    let folder = tempfile::tempdir().expect("a folder");
    let package = packed(engine, folder.path(), &RULES_GLSL)?;
    let words = ["--engine", engine, "--package", &package.to_string_lossy()];
    let report: Package = script("package.js", &words)?;
    assert_eq!(report.faults, [""; 0]);
    for (what, part) in refusals {
        let message = report.refusals[*what].as_deref().unwrap_or_else(|| panic!("{what} is accepted"));
        assert!(message.contains(part), "{what}: {message}");
    }
    assert_eq!(report.refusals.len(), refusals.len());
    // The sky is black. The lamps and their reflections cover a tenth of the page or more.
    assert!((0.05..0.5).contains(&report.readme), "{}", report.readme);
    Some(report)
}

/// The folder of an example.
fn example(engine: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(engine)
}

/// Packs the files of an example with npm into a folder, and checks that the package has the files `more`. `None`
/// without npm.
pub(crate) fn packed(engine: &str, folder: &Path, more: &[&str]) -> Option<PathBuf> {
    if !starts("npm") {
        report_skipped("npm is missing (Debian: npm)");
        return None;
    }
    let pack = |more: &[&str]| {
        let mut command = Command::new("npm");
        command
            .current_dir(example(engine))
            .args(["pack", "--offline", "--json", "--foreground-scripts=false"])
            .args(more);
        command.env("LTCFORGE", env!("CARGO_BIN_EXE_ltcforge"));
        let output = command.stdin(Stdio::null()).output().expect("npm runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).expect("JSON")
    };
    let report = pack(&["--dry-run"]);
    // npm 12 prints an object with an entry per package instead of a list.
    let report = report.get(0).or_else(|| report.get(format!("ltcforge-{engine}"))).expect("a package");
    assert_eq!(report["version"], env!("CARGO_PKG_VERSION"));
    let files: BTreeSet<&str> =
        report["files"].as_array().expect("files").iter().map(|file| file["path"].as_str().expect("a path")).collect();
    for file in ["README.md", "ggx_area_light.js", "index.d.ts"].iter().chain(more) {
        assert!(files.contains(file), "{file}: {files:?}");
        if file.starts_with("shaders/") {
            assert!(files.contains(types_of(file).as_str()), "{file}: {files:?}");
        }
    }
    assert!(!files.iter().any(|file| file.contains("node_modules") || file.contains(".png")), "{files:?}");
    pack(&["--pack-destination", &folder.to_string_lossy()]);
    let archive = report["filename"].as_str().expect("a name");
    let unpacked = Command::new("tar").current_dir(folder).args(["-xzf", archive]).status().expect("tar runs");
    assert!(unpacked.success());
    Some(folder.join("package"))
}

/// The rules of the closed form in GLSL ES. Every package has them.
pub(crate) const RULES_GLSL: [&str; 3] =
    ["shaders/normals_fast.glsl.js", "shaders/normals_balanced.glsl.js", "shaders/normals_fine.glsl.js"];

/// Writes the shaders of all examples with their own build step. Later calls do nothing.
pub(crate) fn build_shaders() {
    static BUILT: LazyLock<()> = LazyLock::new(|| {
        for engine in ["three", "babylon", "playcanvas"] {
            let mut command = Command::new("node");
            command.current_dir(example(engine)).arg("../common/shaders.js");
            command.env("LTCFORGE", env!("CARGO_BIN_EXE_ltcforge"));
            assert!(command.status().expect("node runs").success(), "{engine}");
        }
    });
    LazyLock::force(&BUILT);
}

/// The file with the types of a module.
fn types_of(module: &str) -> String {
    format!("{}.d.ts", module.trim_end_matches(".js"))
}

/// A program in TypeScript for each package, with all materials that it accepts.
const PROGRAMS: [(&str, &str); 3] = [
    (
        "three",
        "import { MeshBasicMaterial, MeshPhysicalMaterial, MeshStandardMaterial } from 'three';
import { MeshPhysicalNodeMaterial, MeshStandardNodeMaterial } from 'three/webgpu';
import * as webgl from 'ltcforge-three';
import * as webgpu from 'ltcforge-three/webgpu';
import glsl from 'ltcforge-three/shaders/normals_fast.glsl.js';
import wgsl from 'ltcforge-three/shaders/normals_fast.wgsl.js';
for ( const M of [ MeshStandardMaterial, MeshPhysicalMaterial, MeshStandardNodeMaterial, MeshPhysicalNodeMaterial ] ) {
    webgl.setAlphas( new M(), 0.1, 0.2 );
    webgpu.setAlphas( webgpu.withClosedFormAreaLights( new M(), { wgsl, glsl } ), 0.1, 0.2 );
}
// @ts-expect-error: This material has no roughness.
webgl.setAlphas( new MeshBasicMaterial(), 0.1, 0.2 );
const node: MeshPhysicalNodeMaterial = webgpu.withClosedFormAreaLights( new MeshPhysicalNodeMaterial(), { wgsl } );
webgpu.withoutAreaLights( node );
const lit: MeshPhysicalMaterial = webgl.withClosedFormAreaLights( new MeshPhysicalMaterial(), glsl );
webgl.withoutAreaLights( lit );",
    ),
    (
        "babylon",
        "import * as BABYLON from 'babylonjs';
import { areaLightsPlugin, setAlphas, withClosedFormAreaLights, withoutAreaLights } from 'ltcforge-babylon';
import normals from 'ltcforge-babylon/shaders/normals_fast.glsl.js';
declare const scene: BABYLON.Scene;
for ( const M of [ BABYLON.PBRMaterial, BABYLON.PBRMetallicRoughnessMaterial, BABYLON.PBRSpecularGlossinessMaterial ] ) {
    const lit = withClosedFormAreaLights( new M( 'lit', scene ), normals, BABYLON );
    setAlphas( lit, 0.1, 0.2 );
    withoutAreaLights( lit );
}
areaLightsPlugin( BABYLON );",
    ),
    (
        "playcanvas",
        "import { type GraphicsDevice, StandardMaterial } from 'playcanvas';
import { setAlphas, withClosedFormAreaLights, withoutAreaLights } from 'ltcforge-playcanvas';
import normals from 'ltcforge-playcanvas/shaders/normals_fast.glsl.js';
declare const device: GraphicsDevice;
const lit: StandardMaterial = withClosedFormAreaLights( new StandardMaterial(), normals, device );
setAlphas( lit, 0.1, 0.2 );
withoutAreaLights( lit );",
    ),
];

#[test]
#[ignore = "make test-all runs it"]
fn strict_typescript_accepts_the_packages() {
    let modules = here().join("node_modules");
    if !starts("node") || !modules.join("typescript").exists() {
        report_skipped("node or TypeScript is missing (run npm ci in tests/engines)");
        return;
    }
    build_shaders();
    let folder = tempfile::tempdir().expect("a folder");
    let linked = folder.path().join("node_modules");
    fs::create_dir(&linked).expect("a folder");
    for module in fs::read_dir(&modules).expect("packages").map(|entry| entry.expect("a package")) {
        symlink(module.path(), linked.join(module.file_name())).expect("a link");
    }
    for (engine, program) in PROGRAMS {
        symlink(example(engine), linked.join(format!("ltcforge-{engine}"))).expect("a link");
        fs::write(folder.path().join(format!("{engine}.mts")), program).expect("a program");
    }
    let mut tsc = Command::new("node");
    tsc.current_dir(folder.path()).arg("node_modules/typescript/bin/tsc");
    tsc.args("--strict --noEmit --skipLibCheck --preserveSymlinks --target es2022 --module nodenext".split(' '));
    let output = tsc.args(PROGRAMS.map(|(engine, _)| format!("{engine}.mts"))).output().expect("node runs");
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stdout));
}

/// The three numbers of a version.
fn version(text: &str) -> Vec<u32> {
    text.trim_start_matches(['>', '=', '<']).split('.').map(|number| number.parse().expect("a number")).collect()
}

#[test]
fn packages_accept_the_tested_versions_of_their_engines() {
    let parse = |path: PathBuf| -> serde_json::Value {
        serde_json::from_str(&fs::read_to_string(path).expect("a package.json")).expect("JSON")
    };
    let tested = parse(here().join("package.json"));
    for engine in ["three", "babylon", "playcanvas"] {
        let package = parse(example(engine).join("package.json"));
        for (name, range) in package["peerDependencies"].as_object().expect("engines") {
            // Both packages of Babylon.js have the same versions.
            let name = if name == "@babylonjs/core" { "babylonjs" } else { name };
            let tested = version(tested["dependencies"][name].as_str().expect("a version"));
            let (from, to) = range.as_str().and_then(|range| range.split_once(' ')).expect("a range");
            assert!(version(from) <= tested && tested < version(to), "{engine}: {range}, tested with {tested:?}");
        }
    }
}
