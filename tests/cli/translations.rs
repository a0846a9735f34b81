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

#[test]
fn spirv_is_what_vulkan_takes() {
    let folder = tempfile::tempdir().expect("a folder");
    for layout in ["kt2022", "reflected"] {
        run(folder.path(), ["shader", "--language", "spirv", "--layout", layout, "-o", "ltc.spv"]).exited(0);
        let args = ["--target-env", "vulkan1.1", "ltc.spv"];
        let Some(output) = checked("spirv-tools", "spirv-val", &args, folder.path()) else { return };
        assert_sound(&output);
    }
}

#[test]
fn glsl_is_what_opengl_takes() {
    let folder = tempfile::tempdir().expect("a folder");
    for layout in ["kt2022", "reflected"] {
        run(folder.path(), ["shader", "--language", "glsl", "--layout", layout, "-o", "ltc.comp"]).exited(0);
        let args = ["-G", "ltc.comp", "-o", "ltc.spv"];
        let Some(output) = checked("glslang-tools", "glslangValidator", &args, folder.path()) else { return };
        assert_sound(&output);
    }
}
