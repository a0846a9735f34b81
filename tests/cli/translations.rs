//! The shaders that users take home, by the compilers and validators of others.

use std::{
    io::ErrorKind,
    path::Path,
    process::{Command, Output},
};

use crate::common::{command::run, tell_skipped};

/// What a program of Debian's package says of a file; nothing where it is not installed.
fn checked(package: &str, program: &str, args: &[&str], folder: &Path) -> Option<Output> {
    match Command::new(program).args(args).current_dir(folder).output() {
        Ok(output) => Some(output),
        Err(error) if error.kind() == ErrorKind::NotFound => {
            tell_skipped(&format!("there is no {program} (Debian: {package})"));
            None
        }
        Err(error) => panic!("{program}: {error}"),
    }
}

#[track_caller]
fn assert_sound(output: &Output) {
    let told = [&output.stdout, &output.stderr].map(|text| String::from_utf8_lossy(text));
    assert!(output.status.success(), "{told:?}");
}

/// What a shader lights by: each layout of tables, and no table.
const LIT_BY: [[&str; 2]; 3] = [["--layout", "kt2022"], ["--layout", "reflected"], ["--model", "normals"]];

/// Writes a shader.
fn write(folder: &Path, language: &str, lit_by: [&str; 2], file: &str) {
    run(folder, ["shader", "--language", language, "-o", file].iter().chain(&lit_by)).exited(0);
}

#[test]
fn spirv_is_what_vulkan_takes() {
    let folder = tempfile::tempdir().expect("a folder");
    for lit_by in LIT_BY {
        write(folder.path(), "spirv", lit_by, "ltc.spv");
        let args = ["--target-env", "vulkan1.1", "ltc.spv"];
        let Some(output) = checked("spirv-tools", "spirv-val", &args, folder.path()) else { return };
        assert_sound(&output);
    }
}

#[test]
fn glsl_is_what_opengl_takes() {
    let folder = tempfile::tempdir().expect("a folder");
    for lit_by in LIT_BY {
        write(folder.path(), "glsl", lit_by, "ltc.comp");
        let args = ["-G", "ltc.comp", "-o", "ltc.spv"];
        let Some(output) = checked("glslang-tools", "glslangValidator", &args, folder.path()) else { return };
        assert_sound(&output);
        // OpenGL ES has no binaries of this kind; the validator checks the text.
        write(folder.path(), "glsl-es", lit_by, "es.comp");
        let Some(output) = checked("glslang-tools", "glslangValidator", &["es.comp"], folder.path()) else { return };
        assert_sound(&output);
    }
}
