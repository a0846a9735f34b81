//! Commands `sample` and `light --occluders`, and `shader --as samplers`.

use std::fs;

use super::{
    lights::{LIGHTS, rows},
    translations::{assert_sound, checked},
};
use crate::common::command::{run, run_with_stdin};

#[test]
fn sample_prints_directions_with_their_densities() {
    let here = tempfile::tempdir().expect("a folder");
    let sample = |options: &[&str]| run_with_stdin(here.path(), ["sample", "-"].iter().chain(options), LIGHTS);
    let printed = sample(&["--count", "500"]).exited(0).stdout;
    assert_eq!(printed.lines().next(), Some("light,x,y,z,pdf"));
    let found = rows(&printed);
    assert_eq!(found.len(), 1000);
    assert!(found.iter().all(|row| {
        let length = row[1].hypot(row[2]).hypot(row[3]);
        (length - 1.0).abs() < 1e-12 && row[3] > 0.0 && row[4] > 0.0
    }));
    // The mean of 1 / pdf is the solid angle of the square, 4 asin(1 / 5), for each sampler.
    let solid_angle = 4.0 * 0.2_f64.asin();
    let uniform = rows(&sample(&["--count", "500", "--solid-angle"]).exited(0).stdout);
    for rows in [&found, &uniform] {
        let mean = rows[..500].iter().map(|row| 1.0 / row[4]).sum::<f64>() / 500.0;
        assert!((mean / solid_angle - 1.0).abs() < 0.05, "{mean}");
    }
    assert!((uniform[0][4] * solid_angle - 1.0).abs() < 1e-9);
    assert!(sample(&["--count", "0"]).exited(2).stderr.contains("0 is not in 1..=1000000"));
    let bent = "0.5,0.25,0.7,0.3,2,-1,-1,2,-1,1,2.2,1,1,2,1,-1,2\n";
    let refused = run_with_stdin(here.path(), ["sample", "-"], bent).exited(2);
    assert!(refused.stderr.contains("line 1: the light is not planar: vertex"), "{}", refused.stderr);
    assert_eq!(refused.stdout, "");
}

#[test]
fn occluders_hide_light() {
    let here = tempfile::tempdir().expect("a folder");
    let with = |occluders: &str| {
        fs::write(here.path().join("o.csv"), occluders).expect("a file");
        run_with_stdin(here.path(), ["light", "-", "--truth", "--occluders", "o.csv"], LIGHTS)
    };
    let open = with("shape,x,y,z,radius\nsphere,0,0,9,1\n").exited(0).stdout;
    assert!(open.starts_with("energy,fresnel,true_energy,true_fresnel,shadowed_energy,shadowed_fresnel\n"), "{open}");
    for row in rows(&open) {
        assert_eq!(row[2..4], row[4..6]);
    }
    let half = rows(&with("box,0,-9,0.5,9,9,0.6\n").exited(0).stdout);
    assert!(half[0][4] > 0.1 * half[0][2] && half[0][4] < 0.9 * half[0][2], "{half:?}");
    let plastic = run_with_stdin(here.path(), ["light", "-", "--f0", "0.04", "--occluders", "o.csv"], LIGHTS).exited(0);
    assert!(
        plastic.stdout.starts_with("energy,fresnel,reflected,shadowed_energy,shadowed_fresnel,shadowed_reflected\n")
    );
    for row in rows(&plastic.stdout) {
        assert!((row[5] - (0.04 * (row[3] - row[4]) + row[4])).abs() < 1e-12, "{row:?}");
    }
    let closed = "triangle,-50,-50,0.5,50,-50,0.5,0,50,0.5\nbox,-9,-9,0.1,9,9,0.2\n";
    for row in rows(&with(closed).exited(0).stdout) {
        assert!(row[4].abs() < 1e-3 * row[2] && row[5].abs() < 1e-3 * row[2], "{row:?}");
    }
    for (line, said) in [
        ("sphere,0,0,1,0.5\nsphere,0,0,1,2\n", "line 2: the sphere contains the shaded point"),
        ("cone,1\n", "line 1: shape is «cone»; an occluder is a sphere, a box or a triangle"),
    ] {
        let refused = with(line).exited(2).stderr;
        assert!(refused.contains(said), "{refused}");
    }
    let compensated = ["light", "-", "--f0", "1", "--compensate", "--occluders", "o.csv"];
    assert!(run_with_stdin(here.path(), compensated, LIGHTS).exited(2).stderr.contains("'--occluders <FILE>'"));
    let disks = run_with_stdin(here.path(), ["light", "-", "--light", "sphere", "--occluders", "o.csv"], "");
    assert!(disks.exited(2).stderr.contains("--occluders is only for polygons, not for a sphere"));
    let both = run_with_stdin(here.path(), ["light", "-", "--occluders", "-"], LIGHTS);
    assert!(both.exited(2).stderr.contains("only one of the lights and the occluders can be `-`"));
}

#[test]
fn samplers_have_their_own_shader_text() {
    let folder = tempfile::tempdir().expect("a folder");
    let here = folder.path();
    let text = run(here, ["shader", "--as", "samplers", "--language", "glsl"]).exited(0).stdout;
    let calls = "vec3 corners[4] = vec3[4](vec3(1.0), vec3(1.0), vec3(1.0), vec3(1.0));
    SamplerRectangle rectangle = sampler_normals(0.5, 0.5, vec3(0.0, 0.0, 1.0), corners, false);
    SamplerDrawn drawn = sampler_draw(rectangle, vec2(0.5));";
    let program = format!(
        "#version 450\n{text}\nlayout(location = 0) out vec4 colour;\nvoid main() {{\n    {calls}\n    \
         colour = vec4(drawn.wi, drawn.pdf + sampler_pdf(rectangle, drawn.wi));\n}}\n"
    );
    fs::write(here.join("samplers.frag"), program).expect("a file");
    let args = ["-V", "samplers.frag", "-o", "samplers.spv"];
    if let Some(output) = checked("glslang-tools", "glslangValidator", &args, here) {
        assert_sound(&output);
    }
    let output = run(here, ["shader", "--as", "samplers", "--language", "wgsl", "--rule", "fast"]).exited(2).stderr;
    assert!(output.contains("leave out --rule"), "{output}");
}
