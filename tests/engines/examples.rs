//! What the tests of all examples need: their pages, their packages and their shaders.

use super::*;

/// The output of `example.js`.
#[derive(Deserialize)]
struct Example {
    /// Pictures by the `stock` engine, by a `table` and by the rules of `normals`, in linear radiance.
    errors: BTreeMap<String, f64>,
    /// The browser's warnings and errors.
    faults: Vec<String>,
}

/// The mean errors that an example's page shows; `None` where there is no browser.
pub fn errors(engine: &str, lights: &str) -> Option<BTreeMap<String, f64>> {
    let Example { errors, faults } = script("example.js", &["--engine", engine, "--lights", lights])?;
    tell(&format!("examples/{engine}, {lights} lights: mean errors {errors:.5?}"));
    assert_eq!(faults, [""; 0]);
    Some(errors)
}

/// The folder of an example.
fn example(engine: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("examples").join(engine)
}

/// The files of an example as npm packs them, in a folder; `None` where there is no npm. `more` have to be among them.
pub fn packed(engine: &str, folder: &Path, more: &[&str]) -> Option<PathBuf> {
    if !starts("npm") {
        tell_skipped("there is no npm (Debian: npm)");
        return None;
    }
    let pack = |more: &[&str]| {
        let mut command = Command::new("npm");
        command.current_dir(example(engine)).args(["pack", "--offline", "--json", "--ignore-scripts"]).args(more);
        let output = command.stdin(Stdio::null()).output().expect("npm runs");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        serde_json::from_slice::<serde_json::Value>(&output.stdout).expect("JSON")
    };
    let told = pack(&["--dry-run"]);
    // npm 12 has an object by package in place of a list.
    let told = told.get(0).or_else(|| told.get(format!("ltcforge-{engine}"))).expect("a package");
    assert_eq!(told["version"], env!("CARGO_PKG_VERSION"));
    let files: BTreeSet<&str> =
        told["files"].as_array().expect("files").iter().map(|file| file["path"].as_str().expect("a path")).collect();
    for file in ["README.md", "ggx_area_light.js", "index.d.ts"].iter().chain(more) {
        assert!(files.contains(file), "{file}: {files:?}");
    }
    assert!(!files.iter().any(|file| file.contains("node_modules") || file.contains(".png")), "{files:?}");
    pack(&["--pack-destination", &folder.to_string_lossy()]);
    let archive = told["filename"].as_str().expect("a name");
    let unpacked = Command::new("tar").current_dir(folder).args(["-xzf", archive]).status().expect("tar runs");
    assert!(unpacked.success());
    Some(folder.join("package"))
}

/// Files of an example that have the text of a shader, and the words after `ltcforge shader` that print it.
pub type Shader = (&'static str, &'static [&'static str]);

/// The rules in GLSL ES.
pub const RULES_GLSL: [Shader; 3] = [
    ("shaders/normals_fast.glsl.js", &["--language", "glsl-es", "--model", "normals", "--rule", "fast"]),
    ("shaders/normals_balanced.glsl.js", &["--language", "glsl-es", "--model", "normals", "--rule", "balanced"]),
    ("shaders/normals_fine.glsl.js", &["--language", "glsl-es", "--model", "normals", "--rule", "fine"]),
];

/// Compares an example's shaders with those that the command prints, or writes them anew.
pub fn hold_shaders(engine: &str, shaders: &[Shader]) {
    let folder = tempfile::tempdir().expect("a folder");
    for (file, words) in shaders {
        let text = run(folder.path(), ["shader"].iter().chain(*words)).exited(0).stdout;
        assert!(!text.contains(['`', '$', '\\']), "{file}: the text is no template of JavaScript");
        let printed =
            format!("export default /* {} */ `{text}`;\n", if file.contains("wgsl") { "wgsl" } else { "glsl" });
        let path = example(engine).join(file);
        if env::var("UPDATE_GOLDEN").is_ok_and(|name| name == engine) {
            fs::write(&path, printed).expect("the example");
            continue;
        }
        let stands = fs::read_to_string(&path).expect("the example");
        for (number, (stands, printed)) in stands.lines().zip(printed.lines()).enumerate() {
            assert_eq!(stands, printed, "{file}: line {}; UPDATE_GOLDEN={engine} writes it anew", number + 1);
        }
        assert_eq!(stands.len(), printed.len(), "{file}");
    }
}
