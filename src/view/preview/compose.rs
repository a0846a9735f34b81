//! Differences, strips and lobes, with their labels.

use super::{
    Material, Mode, PanelError, Scene, ShaderTable, cpu,
    frame::Frame,
    radiances::{BELOW, BESIDE, Radiances},
    tone,
};
use crate::picture::{
    Panel, Picture, bar, beside, caption, colour, cross, fitting, grid, headed, number, ring, tag, tag_fits,
};
use ltcforge_light::LightModel;

/// Colours beside a sphere of directions, and on it below the horizon, where the lobe is zero.
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

/// The wordings of a material's label, where the table covers it: one for each of [`warnings`].
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

/// The wordings of a material's label, the longest first, where the table does not cover it.
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
pub(super) fn warned(mut picture: Picture, scene: &Scene, out_of_range: &[Material]) -> Picture {
    tag_cells(
        &mut picture,
        scene,
        |_, material| {
            if out_of_range.contains(material) { warnings(material) } else { Vec::new() }
        },
    );
    picture
}

/// The picture of mode `difference` or `strip`.
pub(super) fn compared(
    scene: &Scene,
    table: &ShaderTable,
    out_of_range: &[Material],
    [ltc, reference]: [&Radiances; 2],
    errors: &[PanelError],
) -> Picture {
    let exposure = scene.exposure as f32;
    let scale = scene.difference_scale as f32;
    let mut apart = differences(ltc, reference, scale);
    let width = apart.width;
    tag_cells(&mut apart, scene, |index, material| mean_tags(&errors[index], material));
    let foot = scale_bar(width, scale);
    let short = short_title(scene.model, table);
    if scene.mode == Mode::Difference {
        let ltc = model_title(scene.model, table, width / 2);
        let titles = [format!("|{ltc} - reference|"), format!("|{short} - reference|"), "difference".to_owned()];
        let title = fitting(&titles.each_ref().map(String::as_str), width).to_owned();
        return grid(&[Panel { title: &title, picture: apart, foot }], 1);
    }
    let mut ltc = tone::displayed(exposure, ltc);
    let mut reference = tone::displayed(exposure, reference);
    tag_cells(&mut reference, scene, |_, material| names(material));
    tag_cells(
        &mut ltc,
        scene,
        |_, material| {
            if out_of_range.contains(material) { warnings(material) } else { names(material) }
        },
    );
    let title = format!("|{short} - reference|");
    let panels = [
        Panel { title: &reference_title(table, width), picture: reference, foot: samples(scene, width) },
        Panel { title: &model_title(scene.model, table, width), picture: ltc, foot: mean_error(errors, width) },
        Panel { title: fitting(&[&title, "difference"], width), picture: apart, foot },
    ];
    grid(&panels, 3)
}

/// The picture of mode `models`: the reference and each model above how far it is from the reference.
pub(super) fn models(
    scene: &Scene,
    table: &ShaderTable,
    out_of_range: &[Material],
    lit: &[(LightModel, Radiances)],
    reference: &Radiances,
    errors: &[PanelError],
) -> Picture {
    let (exposure, scale) = (scene.exposure as f32, scene.difference_scale as f32);
    let width = reference.width;
    let mut truth = tone::displayed(exposure, reference);
    tag_cells(&mut truth, scene, |_, material| names(material));
    let mut columns =
        vec![grid(&[Panel { title: &reference_title(table, width), picture: truth, foot: samples(scene, width) }], 1)];
    for (model, radiances) in lit {
        let own: Vec<PanelError> = errors.iter().filter(|error| error.model == *model).copied().collect();
        let mut shown = tone::displayed(exposure, radiances);
        let warns = |material: &Material| *model == LightModel::Ltc && out_of_range.contains(material);
        tag_cells(&mut shown, scene, |_, m| if warns(m) { warnings(m) } else { names(m) });
        let mut apart = differences(radiances, reference, scale);
        tag_cells(&mut apart, scene, |index, material| mean_tags(&own[index], material));
        let title = format!("|{} - reference|", short_title(*model, table));
        let panels = [
            Panel { title: &model_title(*model, table, width), picture: shown, foot: mean_error(&own, width) },
            Panel { title: fitting(&[&title, "difference"], width), picture: apart, foot: scale_bar(width, scale) },
        ];
        columns.push(grid(&panels, 1));
    }
    beside(&columns)
}

/// The colours of differences.
fn scale_bar(width: u32, scale: f32) -> Picture {
    bar(width, colour, ["0", &number(scale)], &["|difference| of radiance", "radiance"])
}

/// How many samples the reference took.
fn samples(scene: &Scene, width: u32) -> Picture {
    caption(width, &[&format!("{} samples a pixel", scene.spp), &format!("{} spp", scene.spp)])
}

/// The mean error over all materials.
fn mean_error(errors: &[PanelError], width: u32) -> Picture {
    let mean = errors.iter().map(|error| error.mean_absolute).sum::<f64>() / errors.len() as f64;
    let mean = number(mean as f32);
    let wordings = [format!("mean |difference| of radiance {mean}"), format!("mean |difference| {mean}"), mean];
    caption(width, &wordings.each_ref().map(String::as_str))
}

/// The wordings of the label of a material's differences.
fn mean_tags(error: &PanelError, material: &Material) -> Vec<String> {
    let (mean, alphas) = (short(error.mean_absolute), alphas(material));
    vec![format!("{alphas}: mean {mean}"), format!("{alphas}: {mean}"), format!("mean {mean}"), mean]
}

/// The title of a picture by a model.
fn model_title(model: LightModel, table: &ShaderTable, width: u32) -> String {
    if model.needs_table() {
        return table_title(table, width);
    }
    let short = short_title(model, table);
    fitting(&[&format!("{short}, no table"), &short], width).to_owned()
}

fn reference_title(table: &ShaderTable, width: u32) -> String {
    fitting(&[&format!("{} reference", table.brdf_title()), "reference"], width).to_owned()
}

fn short_title(model: LightModel, table: &ShaderTable) -> String {
    match model.lobe() {
        Some(_) if model.needs_table() => table.lobe_title(),
        Some(lobe) => lobe.name().to_uppercase(),
        None => model.to_string(),
    }
}

/// The title of a picture by the table.
fn table_title(table: &ShaderTable, width: u32) -> String {
    let lobe = table.lobe_title();
    let Some(label) = &table.label else { return lobe };
    fitting(&[&format!("{lobe}, table {label}"), &format!("{lobe} {label}"), &lobe], width).to_owned()
}

/// The picture of mode `lobe`: densities over directions, both on the scale of the reference, with the view direction
/// and its mirror direction marked.
pub(super) fn lobes(
    scene: &Scene,
    table: &ShaderTable,
    out_of_range: &[Material],
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
    let panels = [(table.brdf_title(), reference), (title.as_str(), ltc)].map(|(title, picture)| {
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
    if !out_of_range.is_empty() {
        let warning = "alpha is outside the table: its nearest entry is shown";
        lines.push([warning.to_owned(), "outside the table".to_owned()]);
    }
    let lines: Vec<[&str; 2]> = lines.iter().map(|line| line.each_ref().map(String::as_str)).collect();
    let lines: Vec<&[&str]> = lines.iter().map(<[&str; 2]>::as_slice).collect();
    headed(&lines, &panels)
}
