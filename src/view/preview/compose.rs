//! Pictures of differences, strips and lobes, with labels.

use super::{
    Material, Mode, PanelError, Scene, ShaderTable, cpu,
    frame::Frame,
    radiances::{BELOW, BESIDE, Radiances},
    shadows, tone,
};
use crate::picture::{
    Panel, Picture, bar, beside, caption, colour, cross, fitting, grid, headed, number, ring, signed_colour, tag,
    tag_fits,
};
use ltcforge_light::LightModel;

/// Colours outside the sphere of directions, and on the part of the sphere below the horizon, where the lobe is zero.
const BESIDE_COLOUR: [u8; 3] = [48, 48, 48];
const BELOW_COLOUR: [u8; 3] = [30, 34, 44];
/// The side of a panel is this many times the radius of a mark.
const MARK: f32 = 64.0;

/// The fitted scale of a difference exceeds this part of the pixels.
const MOST: f64 = 0.95;
/// The least fitted scale.
const LEAST_SCALE: f64 = 1e-6;

/// Differences of radiance, averaged over the channels. `None` where the surface covers no part of a pixel.
type Differences = Vec<Option<f32>>;

fn differences(frame: &Frame, lit: &Radiances, reference: &Radiances) -> Differences {
    let pixels = lit.pixels.iter().zip(&reference.pixels).zip(0..);
    let differences = pixels.map(|((a, b), index): (_, u32)| {
        let difference = (a[0] - b[0] + a[1] - b[1] + a[2] - b[2]) / 3.0;
        cpu::covering(frame, [index % frame.size, index / frame.size]).map(|_| difference)
    });
    differences.collect()
}

/// 1, 2 or 5 times a power of ten: the least such number that [`MOST`] of the differences do not exceed.
fn fitted_scale<'a>(panels: impl Iterator<Item = &'a Differences>) -> f32 {
    let mut amounts: Vec<f32> = panels.flatten().flatten().map(|difference| difference.abs()).collect();
    amounts.sort_by(f32::total_cmp);
    let at = (MOST * amounts.len().saturating_sub(1) as f64) as usize;
    let wanted = f64::from(amounts.get(at).copied().unwrap_or_default()).max(LEAST_SCALE);
    let power = libm::exp10(libm::floor(libm::log10(wanted)));
    let steps = [1.0, 2.0, 5.0].map(|step| step * power);
    steps.into_iter().find(|step| *step >= wanted).unwrap_or(10.0 * power) as f32
}

/// Linear values in false colours. The scale is from zero to `scale`.
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

/// Differences in signed colours: blue where the model is too dark, red where it is too bright.
fn signed_colours(width: u32, differences: &Differences, scale: f32) -> Picture {
    let colour = |difference: &Option<f32>| difference.map_or(BESIDE_COLOUR, |x| signed_colour(x / scale));
    let rgb: Vec<[u8; 3]> = differences.iter().map(colour).collect();
    Picture { width, height: rgb.len() as u32 / width, rgb }
}

/// A number from 0 to 1, without the zero before its decimal point.
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

/// Wordings of the label of a material that the table covers. There are as many as in [`warnings`].
fn names(material: &Material) -> Vec<String> {
    let alphas = alphas(material);
    vec![alphas.clone(), alphas.clone(), alphas, bare_alphas(material)]
}

/// Wordings of the label of a material that the table does not cover, the longest first.
fn warnings(material: &Material) -> Vec<String> {
    let alphas = alphas(material);
    vec![
        format!("{alphas}: outside the table"),
        format!("{alphas}: outside"),
        "outside the table".to_owned(),
        "outside".to_owned(),
    ]
}

/// Composes pictures from a scene, a table, and the materials that the table does not cover.
pub(super) struct Composer<'a> {
    pub(super) scene: &'a Scene,
    pub(super) table: &'a ShaderTable,
    pub(super) out_of_range: &'a [Material],
}

/// A panel that owns its title.
struct Titled {
    title: String,
    picture: Picture,
    foot: Picture,
}

fn grid_of(panels: Vec<Titled>, columns: u32) -> Picture {
    let (titles, parts): (Vec<String>, Vec<_>) =
        panels.into_iter().map(|Titled { title, picture, foot }| (title, (picture, foot))).unzip();
    let panels = titles.iter().zip(parts).map(|(title, (picture, foot))| Panel { title, picture, foot });
    grid(&panels.collect::<Vec<_>>(), columns)
}

impl Composer<'_> {
    /// The picture of mode `ltc`. Materials that the table does not cover have a label.
    pub(super) fn warned(&self, mut picture: Picture) -> Picture {
        self.tag_cells(&mut picture, |_, m| if self.out_of_range.contains(m) { warnings(m) } else { Vec::new() });
        picture
    }

    /// The picture of mode `difference` or `strip`.
    pub(super) fn compared(
        &self,
        frame: &Frame,
        lit: &Radiances,
        reference: &Radiances,
        errors: &[PanelError],
    ) -> Picture {
        let model = self.scene.model;
        let off = differences(frame, lit, reference);
        let apart = self.apart(model, reference.width, &off, self.scale([&off]), errors);
        if self.scene.mode == Mode::Difference {
            return grid_of(vec![apart], 1);
        }
        grid_of(vec![self.truth(reference), self.lit(model, lit, errors), apart], 3)
    }

    /// The picture of mode `models`: the reference, and for each model its light above the difference from the
    /// reference. All differences have the same scale.
    pub(super) fn models(
        &self,
        frame: &Frame,
        lit: &[(LightModel, Radiances)],
        reference: &Radiances,
        errors: &[PanelError],
    ) -> Picture {
        let mut columns = vec![grid_of(vec![self.truth(reference)], 1)];
        let off: Vec<_> = lit.iter().map(|(_, radiances)| differences(frame, radiances, reference)).collect();
        let scale = self.scale(&off);
        for ((model, radiances), off) in lit.iter().zip(&off) {
            let own: Vec<PanelError> = errors.iter().filter(|error| error.model == *model).copied().collect();
            let shown = self.lit(*model, radiances, &own);
            columns.push(grid_of(vec![shown, self.apart(*model, reference.width, off, scale, &own)], 1));
        }
        beside(&columns)
    }

    /// The picture of mode `shadows`: each panel with its error.
    pub(super) fn shadows(&self, panels: &[Radiances; 4]) -> Picture {
        let titled = |(index, [title, short]): (usize, [&str; 2])| {
            let panel = &panels[index];
            let width = panel.width;
            let [error, mean] = shadows::error(panel, &panels[0]);
            let foot = if index == 0 {
                caption(width, &[&format!("{} samples, mean {}", self.scene.spp, number(mean)), ""])
            } else {
                caption(width, &[&format!("mean error {} of {}", number(error), number(mean)), &number(error)])
            };
            let title = fitting(&[title, short], width).to_owned();
            Titled { title, picture: tone::displayed(self.scene.exposure as f32, panel), foot }
        };
        grid_of(shadows::TITLES.into_iter().enumerate().map(titled).collect(), 4)
    }

    fn truth(&self, reference: &Radiances) -> Titled {
        let width = reference.width;
        let mut picture = tone::displayed(self.scene.exposure as f32, reference);
        self.tag_cells(&mut picture, |_, material| names(material));
        let title = format!("{} reference", self.table.brdf_title());
        Titled {
            title: fitting(&[&title, "reference"], width).to_owned(),
            picture,
            foot: caption(width, &[&format!("{} samples a pixel", self.scene.spp), &format!("{} spp", self.scene.spp)]),
        }
    }

    fn lit(&self, model: LightModel, radiances: &Radiances, errors: &[PanelError]) -> Titled {
        let mut picture = tone::displayed(self.scene.exposure as f32, radiances);
        let warns = |material: &Material| model.needs_table() && self.out_of_range.contains(material);
        self.tag_cells(&mut picture, |_, m| if warns(m) { warnings(m) } else { names(m) });
        let title = model_title(model, self.table, radiances.width);
        Titled { title, picture, foot: mean_error(errors, radiances.width) }
    }

    /// The scale of the scene, or the scale that fits the panels.
    fn scale<'a>(&self, panels: impl IntoIterator<Item = &'a Differences>) -> f32 {
        let given = self.scene.difference_scale;
        if given > 0.0 { given as f32 } else { fitted_scale(panels.into_iter()) }
    }

    /// The difference of a model from the reference. The title of a single panel names the table.
    fn apart(&self, model: LightModel, width: u32, off: &Differences, scale: f32, errors: &[PanelError]) -> Titled {
        let mut picture = signed_colours(width, off, scale);
        self.tag_cells(&mut picture, |index, material| mean_tags(&errors[index], material));
        let short = short_title(model, self.table);
        let is_alone = self.scene.mode == Mode::Difference;
        let long = if is_alone { model_title(model, self.table, width / 2) } else { short.clone() };
        let titles = [format!("{long} - reference"), format!("{short} - reference"), "difference".to_owned()];
        let title = fitting(&titles.each_ref().map(String::as_str), width).to_owned();
        let ends = [format!("-{}", number(scale)), format!("+{}", number(scale))];
        let both = |place: f32| signed_colour(2.0 * place - 1.0);
        let foot = bar(width, both, ends.each_ref().map(String::as_str), &["difference of radiance", "radiance"]);
        Titled { title, picture, foot }
    }

    /// Labels each material in the corner of its cell. All cells use the wording with the same index, the first that
    /// fits in every cell, so the labels are comparable. A cell without wordings gets no label.
    fn tag_cells(&self, picture: &mut Picture, wordings: impl Fn(usize, &Material) -> Vec<String>) {
        let materials = &self.scene.materials;
        let cells = if materials.len() == 1 { 1 } else { 2 };
        let side = picture.width / cells;
        let tags: Vec<Vec<String>> = materials.iter().enumerate().map(|(i, material)| wordings(i, material)).collect();
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

    /// The picture of mode `lobe`: densities over directions, both on the scale of the reference. Marks show the view
    /// direction and its mirror direction.
    pub(super) fn lobes(&self, frame: &Frame, ltc: &Radiances, reference: &Radiances) -> Picture {
        let peak = reference.pixels.iter().map(|pixel| pixel[0]).fold(1e-9_f32, f32::max);
        let wo = frame.lobe_wo;
        let mirror = glam::Vec3::new(-wo.x, -wo.y, wo.z);
        let panel = |title: String, lobe: &Radiances| {
            let mut picture = false_colours(lobe.width, lobe.pixels.iter().map(|pixel| pixel[0]), peak);
            let radius = (picture.width as f32 / MARK).max(3.0);
            if let Some(at) = cpu::place_of_direction(frame, mirror) {
                cross(&mut picture, at, radius);
            }
            if let Some(at) = cpu::place_of_direction(frame, wo) {
                ring(&mut picture, at, radius);
            }
            let foot = bar(picture.width, colour, ["0", &number(peak)], &["per steradian"]);
            Titled { title, picture, foot }
        };
        let title = self.table.brdf_title().to_owned();
        let panels = vec![panel(title, reference), panel(table_title(self.table, ltc.width), ltc)];
        let panels = grid_of(panels, 2);
        let (Material { alpha_x, alpha_y, .. }, view) = (self.scene.materials[0], self.scene.lobe);
        let [alpha_x, alpha_y, theta, phi] = [alpha_x, alpha_y, view.theta, view.phi].map(|x| number(x as f32));
        let (alphas, angles) = (format!("alpha {alpha_x}, {alpha_y}"), format!("theta {theta}, phi {phi}"));
        let (long, short) = (format!("{alphas}; view direction: {angles} rad"), format!("{alphas}; {angles}"));
        let configuration = [long.as_str(), &short];
        let apart = [[alphas.as_str()], [angles.as_str()]];
        let mut lines: Vec<&[&str]> = if fitting(&configuration, panels.width).is_empty() {
            apart.iter().map(<[&str; 1]>::as_slice).collect()
        } else {
            vec![&configuration]
        };
        lines.push(&["ring: view direction; cross: its mirror direction", "ring: view; cross: mirror"]);
        if !self.out_of_range.is_empty() {
            lines.push(&["alpha is outside the table: its nearest entry is shown", "outside the table"]);
        }
        headed(&lines, &panels)
    }
}

/// The foot of a panel: the mean error over all materials.
fn mean_error(errors: &[PanelError], width: u32) -> Picture {
    let mean = errors.iter().map(|error| error.mean_absolute).sum::<f64>() / errors.len() as f64;
    let mean = number(mean as f32);
    let wordings = [format!("mean error of radiance {mean}"), format!("mean error {mean}"), mean];
    caption(width, &wordings.each_ref().map(String::as_str))
}

/// Wordings of the label of a material's difference.
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
