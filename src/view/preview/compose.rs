//! Differences, strips and lobes, with what has to be written on them.

use super::{
    Material, Mode, PanelError, Scene, ShaderTable, cpu,
    frame::Frame,
    radiances::{BELOW, BESIDE, Radiances},
    tone,
};
use crate::view::picture::{
    Panel, Picture, bar, caption, colour, cross, fitting, grid, headed, number, ring, tag, tag_fits,
};

/// What is beside a sphere of directions, and on it where nothing is below the horizon.
const BESIDE_COLOUR: [u8; 3] = [48, 48, 48];
const BELOW_COLOUR: [u8; 3] = [30, 34, 44];
/// Pixels of a panel's side for each pixel of a mark's radius.
const MARK: f32 = 64.0;

/// Mean of the channels' absolute differences.
fn difference(a: [f32; 3], b: [f32; 3]) -> f32 {
    ((a[0] - b[0]).abs() + (a[1] - b[1]).abs() + (a[2] - b[2]).abs()) / 3.0
}

/// Linear values from zero to `scale` in false colours.
fn false_colours(width: u32, values: impl Iterator<Item = f32>, scale: f32) -> Picture {
    let rgb: Vec<[u8; 3]> = values
        .map(|value| match value {
            BESIDE => BESIDE_COLOUR,
            BELOW => BELOW_COLOUR,
            _ => colour(value / scale),
        })
        .collect();
    Picture { width, height: rgb.len() as u32 / width, rgb }
}

fn differences(ltc: &Radiances, reference: &Radiances, scale: f32) -> Picture {
    let values = ltc.pixels.iter().zip(&reference.pixels).map(|(a, b)| difference(*a, *b));
    false_colours(ltc.width, values, scale)
}

/// A number from 0 to 1 without the zero before its point.
fn short(x: f64) -> String {
    let text = number(x as f32);
    text.strip_prefix("0.").map_or_else(|| text.clone(), |digits| format!(".{digits}"))
}

fn alphas(material: &Material) -> String {
    format!("alpha {}", bare_alphas(material))
}

fn bare_alphas(material: &Material) -> String {
    format!("{}, {}", short(material.alpha_x), short(material.alpha_y))
}

/// What is written on a material that the table covers, beside the same on one that it does not.
fn names(material: &Material) -> Vec<String> {
    let alphas = alphas(material);
    vec![alphas.clone(), alphas.clone(), alphas, bare_alphas(material)]
}

/// Writes one of its wordings into the corner of each material's cell, in all cells the first one for which all have
/// room, so that they can be compared. A cell without wordings stays as it is.
fn tag_cells(picture: &mut Picture, scene: &Scene, wordings: impl Fn(usize, &Material) -> Vec<String>) {
    let cells = if scene.materials.len() == 1 { 1 } else { 2 };
    let side = picture.width / cells;
    let tags: Vec<Vec<String>> =
        scene.materials.iter().enumerate().map(|(i, material)| wordings(i, material)).collect();
    let fits = |wording: &usize| tags.iter().filter_map(|tag| tag.get(*wording)).all(|text| tag_fits(text, side));
    let most = tags.iter().map(Vec::len).max().unwrap_or_default();
    let Some(chosen) = (0..most).find(fits) else { return };
    for (index, wordings) in (0_u32..).zip(&tags) {
        let (column, row) = (index % cells, index / cells);
        if let Some(text) = wordings.get(chosen) {
            tag(picture, text, [column * side, (row + 1) * side], side);
        }
    }
}

/// What is written on a material that the table does not cover.
fn warnings(material: &Material) -> Vec<String> {
    let alphas = alphas(material);
    vec![
        format!("{alphas}: outside the table"),
        format!("{alphas}: outside"),
        "outside the table".to_owned(),
        "outside".to_owned(),
    ]
}

/// The picture of mode `ltc`: materials that the table does not cover are marked.
pub(super) fn warned(mut picture: Picture, scene: &Scene, outside: &[Material]) -> Picture {
    tag_cells(
        &mut picture,
        scene,
        |_, material| {
            if outside.contains(material) { warnings(material) } else { Vec::new() }
        },
    );
    picture
}

/// The picture of mode `difference` or `strip`.
pub(super) fn compared(
    scene: &Scene,
    table: &ShaderTable,
    outside: &[Material],
    [ltc, reference]: [&Radiances; 2],
    errors: &[PanelError],
) -> Picture {
    let exposure = scene.exposure as f32;
    let scale = scene.difference_scale as f32;
    let mut apart = differences(ltc, reference, scale);
    let width = apart.width;
    tag_cells(&mut apart, scene, |index, material| {
        let mean = short(errors[index].mean_absolute);
        let alphas = alphas(material);
        vec![format!("{alphas}: mean {mean}"), format!("{alphas}: {mean}"), format!("mean {mean}"), mean]
    });
    let foot = bar(width, colour, ["0", &number(scale)], &["|difference| of radiance", "radiance"]);
    if scene.mode == Mode::Difference {
        let ltc = table_title(table, width / 2);
        let title = fitting(&[&format!("|{ltc} - reference|"), "|LTC - reference|", "difference"], width).to_owned();
        return grid(&[Panel { title: &title, picture: apart, foot }], 1);
    }
    let mut ltc = tone::displayed(exposure, ltc);
    let mut reference = tone::displayed(exposure, reference);
    tag_cells(&mut reference, scene, |_, material| names(material));
    tag_cells(
        &mut ltc,
        scene,
        |_, material| {
            if outside.contains(material) { warnings(material) } else { names(material) }
        },
    );
    let samples = caption(width, &[&format!("{} samples a pixel", scene.spp), &format!("{} spp", scene.spp)]);
    let mean = errors.iter().map(|error| error.mean_absolute).sum::<f64>() / errors.len() as f64;
    let mean = number(mean as f32);
    let wordings = [format!("mean |difference| of radiance {mean}"), format!("mean |difference| {mean}"), mean];
    let mean = caption(width, &wordings.each_ref().map(String::as_str));
    let panels = [
        Panel { title: fitting(&["GGX reference", "reference"], width), picture: reference, foot: samples },
        Panel { title: &table_title(table, width), picture: ltc, foot: mean },
        Panel { title: fitting(&["|LTC - reference|", "difference"], width), picture: apart, foot },
    ];
    grid(&panels, 3)
}

/// What stands above a picture by the table.
fn table_title(table: &ShaderTable, width: u32) -> String {
    let Some(label) = &table.label else { return "LTC".to_owned() };
    fitting(&[&format!("LTC, table {label}"), &format!("LTC {label}"), "LTC"], width).to_owned()
}

/// The picture of mode `lobe`: densities over directions, both on the scale of the reference, with the view direction
/// and its mirror direction marked.
pub(super) fn lobes(
    scene: &Scene,
    table: &ShaderTable,
    outside: &[Material],
    frame: &Frame,
    [ltc, reference]: [&Radiances; 2],
) -> Picture {
    let peak = reference.pixels.iter().map(|pixel| pixel[0]).fold(1e-9_f32, f32::max);
    let wo = frame.lobe_wo;
    let mirror = glam::Vec3::new(-wo.x, -wo.y, wo.z);
    let panel = |lobe: &Radiances| {
        let mut picture = false_colours(lobe.width, lobe.pixels.iter().map(|pixel| pixel[0]), peak);
        let radius = (picture.width as f32 / MARK).max(3.0);
        if let Some(at) = cpu::place_of_direction(frame, mirror) {
            cross(&mut picture, at, radius);
        }
        if let Some(at) = cpu::place_of_direction(frame, wo) {
            ring(&mut picture, at, radius);
        }
        picture
    };
    let (ltc, reference) = (panel(ltc), panel(reference));
    let title = table_title(table, ltc.width);
    let panels = [("GGX", reference), (title.as_str(), ltc)].map(|(title, picture)| {
        let foot = bar(picture.width, colour, ["0", &number(peak)], &["per steradian"]);
        Panel { title, picture, foot }
    });
    let Material { alpha_x, alpha_y, .. } = scene.materials[0];
    let [alpha_x, alpha_y, theta, phi] = [alpha_x, alpha_y, scene.lobe.theta, scene.lobe.phi].map(|x| number(x as f32));
    let configuration = [
        format!("alpha {alpha_x}, {alpha_y}; view direction: theta {theta}, phi {phi} rad"),
        format!("alpha {alpha_x}, {alpha_y}; theta {theta}, phi {phi}"),
    ];
    let panels = grid(&panels, 2);
    let mut lines = if fitting(&configuration.each_ref().map(String::as_str), panels.width).is_empty() {
        [format!("alpha {alpha_x}, {alpha_y}"), format!("theta {theta}, phi {phi}")]
            .map(|line| [line.clone(), line])
            .to_vec()
    } else {
        vec![configuration]
    };
    lines.push(["ring: view direction; cross: its mirror direction", "ring: view; cross: mirror"].map(str::to_owned));
    if !outside.is_empty() {
        let warning = "alpha is outside the table: its nearest entry is shown";
        lines.push([warning.to_owned(), "outside the table".to_owned()]);
    }
    let lines: Vec<[&str; 2]> = lines.iter().map(|line| line.each_ref().map(String::as_str)).collect();
    let lines: Vec<&[&str]> = lines.iter().map(<[&str; 2]>::as_slice).collect();
    headed(&lines, &panels)
}
