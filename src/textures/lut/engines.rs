//! The lookup tables of engines: parameters, channels, size, format, name.
//!
//! Sources: three.js 0.187 (npm), `@babylonjs/core` 9.35 (npm), and copies of the sources of Bevy 0.19, Godot, Filament,
//! HDRP, glTF-Sample-Renderer and Blender (2026). Godot and HDRP compute their tables at startup; their files
//! have the numbers of these textures.

use std::{fmt::Write as _, iter::repeat, slice};

use ddsfile::{AlphaMode, D3D10ResourceDimension, Dds, DxgiFormat, NewDxgiParams};

use super::{
    super::{
        About, Bundle, TextureFileError,
        containers::{Stored, dx10, ktx2, numbers, stored},
        texture::Texture,
    },
    LutExportError, byte, fitted, png, texture, unrounded,
};
use half::f16;
use ltcforge_fit::{
    BrdfKind, Precision,
    albedo::{AxisParameter, DfgForm, Lut, LutAxes, LutKind, LutPrecision, LutRecipe, LutResolution, Texels},
    math::pow,
    named_list,
};

named_list! {
    /// A renderer with lookup tables.
    pub enum LutEngine {
        /// three.js.
        Three = "three",
        /// Babylon.js.
        Babylon = "babylon",
        /// Bevy.
        Bevy = "bevy",
        /// Godot.
        Godot = "godot",
        /// Filament.
        Filament = "filament",
        /// Unity's High Definition Render Pipeline.
        Hdrp = "hdrp",
        /// Khronos' glTF Sample Viewer.
        GltfSampleViewer = "gltf-sample-viewer",
        /// EEVEE of Blender.
        Blender = "blender",
    }
}

/// The parameters of an engine's table.
struct Format {
    cos_theta: AxisParameter,
    texels: Texels,
    /// The width and height. `None` for engines that take any size.
    size: Option<u32>,
    form: DfgForm,
    /// The values of the third channel.
    third: Option<(LutKind, BrdfKind)>,
    precision: LutPrecision,
}

/// The axes of most engines.
const PLAIN: Format = Format {
    cos_theta: AxisParameter::Cosine,
    texels: Texels::Centres,
    size: None,
    form: DfgForm::Karis,
    third: None,
    precision: LutPrecision::F16,
};
const SHEEN: Option<(LutKind, BrdfKind)> = Some((LutKind::Sheen, BrdfKind::CharlieNeubelt));

/// The normalisation of HDRP's `DisneyDiffuseNoPI`, in `BSDF.hlsl` of its Core RP library.
const DISNEY_NORMALISATION: f32 = 1.035_71;

/// The largest number of rows of the table for a third channel.
const ROWS: u32 = 64;

impl LutEngine {
    /// Whether the engine has a file for this kind of table.
    #[must_use]
    pub fn loads(self, table: LutKind) -> bool {
        table == LutKind::Dfg || (table == LutKind::Sheen && self == Self::GltfSampleViewer)
    }

    fn format(self) -> Format {
        match self {
            Self::Three | Self::Bevy => PLAIN,
            Self::Babylon => {
                Format { size: Some(256), form: DfgForm::Filament, third: SHEEN, precision: LutPrecision::F32, ..PLAIN }
            }
            Self::Godot | Self::Filament => Format { size: Some(128), form: DfgForm::Filament, third: SHEEN, ..PLAIN },
            Self::Hdrp => Format {
                cos_theta: AxisParameter::Root,
                texels: Texels::Corners,
                size: Some(64),
                form: DfgForm::Filament,
                third: Some((LutKind::Diffuse, BrdfKind::BurleyDiffuse)),
                // The format has 10 bits. Bounded texels suit it.
                precision: LutPrecision::Unorm16,
            },
            Self::GltfSampleViewer => Format { precision: LutPrecision::Rgba8, ..PLAIN },
            Self::Blender => Format {
                cos_theta: AxisParameter::Complement,
                texels: Texels::Corners,
                size: Some(64),
                form: DfgForm::F82,
                precision: LutPrecision::F32,
                ..PLAIN
            },
        }
    }

    /// The recipe of the engine's table with the values of `recipe`. `None` if the engine has no such table.
    pub(super) fn recipe(self, recipe: &LutRecipe) -> Option<LutRecipe> {
        let Format { cos_theta, texels, size, form, precision, .. } = self.format();
        self.loads(recipe.table).then(|| LutRecipe {
            form: recipe.form.map(|_| form),
            axes: Some(LutAxes { roughness: AxisParameter::Perceptual, cos_theta, texels }),
            resolution: size.map_or(recipe.resolution, |n| LutResolution::new(recipe.table, |_| n)),
            precision,
            ..*recipe
        })
    }

    /// The engine's table for area lights.
    fn area_lights(self) -> String {
        match self {
            Self::Filament | Self::GltfSampleViewer => format!("{self} has no area lights, so it needs no LTC table."),
            Self::Blender => "Area lights use the array ltc_mat_ggx in the same file: \
                              ltcforge export TABLE --layout ltc2017 --container c -o DIR"
                .to_owned(),
            _ => format!("Table for area lights: ltcforge export TABLE --for {self} -o DIR"),
        }
    }

    /// The engine's file and its steps. `recipe` has the engine's parameters.
    pub(super) fn bundle(self, recipe: &LutRecipe, lut: Lut, about: &About) -> Result<Bundle, LutExportError> {
        // The cosine is along x and roughness along y.
        let mut texture = texture("dfg", recipe, lut.texels)?;
        if let Some((table, brdf)) = self.format().third.filter(|_| recipe.table == LutKind::Dfg) {
            // Albedos above 1 must not be clamped before the offset is subtracted.
            let precision = if self == Self::Hdrp { LutPrecision::F32 } else { recipe.precision };
            let third = third(&LutRecipe { table, brdf, form: None, precision, ..*recipe });
            let number = |x: &f32| match self {
                Self::Hdrp => x / DISNEY_NORMALISATION - 0.5,
                // RGBD has one divisor for all channels. Large numbers make the others coarse.
                Self::Babylon => x.min(1.0),
                _ => *x,
            };
            texture = with_channel(texture, table.name(), third.iter().map(number));
        }
        let (path, bytes, steps): (_, _, &[&str]) = match self {
            Self::Three => (
                "DFGLUTData.js",
                three(&transposed(texture), about)?.into_bytes(),
                &[
                    "Replace src/renderers/shaders/DFGLUTData.js in three.js's sources (checked with 0.187), and build it.",
                    "WebGPURenderer has a table of its own, src/nodes/functions/BSDF/DFGLUT.js: copy DATA and the sizes into it.",
                ],
            ),
            Self::Bevy => (
                "dfg.ktx2",
                ktx2(&half(&texture)?, true, about)?,
                &[
                    "Built in: replace crates/bevy_pbr/src/environment_map/dfg.ktx2 in Bevy's sources (feature dfg_lut).",
                    "At run time: insert the handle of dfg.ktx2 as DfgLut { texture } into the render world.",
                ],
            ),
            Self::Babylon => (
                "environmentBRDF.png",
                picture(&texture, rgbd),
                &[
                    "Before the first PBR material: const t = new BABYLON.Texture(\"environmentBRDF.png\", scene, true, false, BABYLON.Texture.BILINEAR_SAMPLINGMODE); t.isRGBD = true; t.wrapU = t.wrapV = BABYLON.Texture.CLAMP_ADDRESSMODE; scene.environmentBRDFTexture = t; BABYLON.RGBDTextureTools.ExpandRGBDTexture(t);",
                    "ExpandRGBDTexture decodes the picture after loading. Without it, the GPU filters encoded bytes.",
                    "Built in: replace the first PNG in packages/dev/core/src/Misc/brdfTextureTools.ts, in base64.",
                ],
            ),
            Self::Godot => (
                "dfg_lut.dds",
                // Rough surfaces come first.
                dx10(&half(&flipped(with_channel(texture, "one", repeat(1.0))))?)?,
                &[
                    "Godot computes this texture at startup: in scene_shader_forward_clustered.cpp, fill dfg_lut.texture from dfg_lut.dds instead of running integrate_dfg.glsl.",
                ],
            ),
            Self::Filament => (
                "dfg.inc",
                include(&texture, about).into_bytes(),
                &[
                    "Filament's build runs cmgen --ibl-dfg=dfg.inc: replace the generated dfg.inc (generated/data) and build again.",
                    "Mobile builds use 64 x 64 texels: set DFG_LUT_SIZE=128.",
                ],
            ),
            Self::Hdrp => (
                "PreIntegratedFGD_GGXDisneyDiffuse.dds",
                ten_bits(&texture)?,
                &[
                    "HDRP computes this texture at startup: in PreIntegratedFGD.RenderInit, copy these texels to m_PreIntegratedFGD[0] instead of calling DrawFullScreen.",
                ],
            ),
            Self::GltfSampleViewer => (
                if recipe.table == LutKind::Sheen { "lut_sheen_E.png" } else { "lut_ggx.png" },
                picture(&texture, |texel| match *texel {
                    [e] => [byte(e), byte(e), byte(e), 255],
                    _ => [byte(texel[0]), byte(texel[1]), 0, 255],
                }),
                &[
                    "Put the file into assets/images and pass its path to ResourceLoader.loadEnvironment, as lut_ggx_file or lut_sheen_E_file.",
                    "The current viewer computes the GGX table at startup: in ibl_sampler.js, load lut_ggx.png instead of calling sampleGGXLut.",
                ],
            ),
            Self::Blender => (
                "brdf_ggx.inc",
                array(&transposed(texture), about).into_bytes(),
                &[
                    "Replace the array brdf_ggx in source/blender/draw/engines/eevee/eevee_lut.cc, and build Blender.",
                    "Versions before the F82 tint have [64][64][2]: leave out each third number.",
                ],
            ),
        };
        let steps = steps.iter().map(|&step| step.to_owned()).chain([self.area_lights()]);
        Ok(Bundle { files: vec![unrounded(path, bytes)], steps: steps.collect() })
    }
}

/// The texels of a third channel. They are from a table with at most [`ROWS`] rows, because values take long and change
/// slowly with roughness.
fn third(recipe: &LutRecipe) -> Vec<f32> {
    let [rows, columns] = [0, 1].map(|axis| recipe.resolution.texels()[axis]);
    let few = rows.min(ROWS);
    let resolution = LutResolution::new(recipe.table, |axis| if axis == "roughness" { few } else { columns });
    let texels = fitted(&LutRecipe { resolution, ..*recipe }).texels;
    if few == rows {
        return texels;
    }
    let row = |i: usize| texels.chunks(columns as usize).nth(i).unwrap_or_default();
    let blended = |y: u32| {
        let (below, next) = recipe.texels().filter(recipe.texels().parameter(y as usize, rows as usize), few as usize);
        row(below).iter().zip(row(below + 1)).map(move |(a, b)| a + (b - a) * next as f32)
    };
    (0..rows).flat_map(blended).collect()
}

/// The texture with one more channel.
fn with_channel(mut texture: Texture, name: &str, numbers: impl IntoIterator<Item = f32>) -> Texture {
    let texels = texture.texels.chunks(texture.channels.len()).zip(numbers);
    texture.texels = texels.flat_map(|(texel, number)| texel.iter().copied().chain([number])).collect();
    texture.channels.push(name.to_owned());
    texture
}

/// The texture with roughness along x.
fn transposed(texture: Texture) -> Texture {
    let (width, n) = (texture.width as usize, texture.channels.len());
    let columns = (0..width).flat_map(|x| texture.texels.chunks(n).skip(x).step_by(width));
    let texels = columns.flatten().copied().collect();
    Texture { width: texture.height, height: texture.width, texels, ..texture }
}

/// The texture with its last row first.
fn flipped(texture: Texture) -> Texture {
    let rows = texture.texels.chunks(texture.width as usize * texture.channels.len());
    Texture { texels: rows.rev().flatten().copied().collect(), ..texture }
}

/// A texture of halves.
fn half(texture: &Texture) -> Result<Stored<'_>, TextureFileError> {
    stored(slice::from_ref(texture), Precision::F16)?.pop().ok_or(TextureFileError::Empty)
}

/// `getDFGLUT` of three.js.
fn three(texture: &Texture, about: &About) -> Result<String, TextureFileError> {
    let numbers = numbers(&half(texture)?, |x| x.to_string());
    Ok(format!(
        "{}\nimport {{ DataTexture }} from '../../textures/DataTexture.js';\n\
         import {{ RGFormat, HalfFloatType, LinearFilter, ClampToEdgeWrapping }} from '../../constants.js';\n\n\
         const DATA = new Uint16Array( [\n{numbers}] );\n\n\
         let lut = null;\n\n\
         export function getDFGLUT() {{\n\n\
         \tif ( lut !== null ) return lut;\n\n\
         \tlut = new DataTexture( DATA, {}, {}, RGFormat, HalfFloatType, undefined, ClampToEdgeWrapping, \
         ClampToEdgeWrapping, LinearFilter, LinearFilter );\n\
         \tlut.name = 'DFG_LUT';\n\tlut.generateMipmaps = false;\n\tlut.needsUpdate = true;\n\treturn lut;\n\n}}\n",
        about.comment(),
        texture.width,
        texture.height
    ))
}

/// A texel of RGBD: the colour is `(r, g, b)^2.2 / d`.
fn rgbd(texel: &[f32]) -> [u8; 4] {
    let most = texel.iter().fold(1.0 / 255.0, |most: f32, x| most.max(*x));
    // The divisor that uses the range of the other three best.
    let divisor = (255.0 / most.max(1.0)).floor() / 255.0;
    let byte = |x: f32| (pow(f64::from(x.max(0.0) * divisor), 1.0 / 2.2).min(1.0) * 255.0).round() as u8;
    [byte(texel[0]), byte(texel[1]), byte(texel[2]), (divisor * 255.0).round() as u8]
}

/// A picture of 8 bits from all channels of each texel.
fn picture(texture: &Texture, of: impl Fn(&[f32]) -> [u8; 4]) -> Vec<u8> {
    let pixels: Vec<u8> = texture.texels.chunks(texture.channels.len()).flat_map(of).collect();
    png([texture.width, texture.height], png::ColorType::Rgba, png::BitDepth::Eight, &pixels)
}

/// The halves as Filament's `cmgen` writes them.
fn include(texture: &Texture, about: &About) -> String {
    let mut text = about.comment();
    for texels in texture.texels.chunks(4 * texture.channels.len()) {
        let bits: Vec<String> = texels.iter().map(|x| format!("0x{:04x}", f16::from_f32_const(*x).to_bits())).collect();
        let _ = writeln!(text, "    {},", bits.join(", "));
    }
    text
}

/// The array `brdf_ggx` of EEVEE.
fn array(texture: &Texture, about: &About) -> String {
    let Texture { width, height, channels, .. } = texture;
    let listed = |items: Vec<String>| format!("{{{}}}", items.join(", "));
    let texel = |texel: &[f32]| listed(texel.iter().map(|x| format!("{x:?}f")).collect());
    let mut text = format!("{}const float brdf_ggx[{height}][{width}][{}] = {{\n", about.comment(), channels.len());
    for row in texture.texels.chunks(*width as usize * channels.len()) {
        let _ = writeln!(text, "    {},", listed(row.chunks(channels.len()).map(texel).collect()));
    }
    text + "};\n"
}

/// A texture `R10G10B10A2_UNORM`.
fn ten_bits(texture: &Texture) -> Result<Vec<u8>, TextureFileError> {
    let fault = |error: ddsfile::Error| TextureFileError::Refused { container: "DDS", reason: error.to_string() };
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height: texture.height,
        width: texture.width,
        depth: None,
        format: DxgiFormat::R10G10B10A2_UNorm,
        mipmap_levels: None,
        array_layers: None,
        caps2: None,
        is_cubemap: false,
        resource_dimension: D3D10ResourceDimension::Texture2D,
        alpha_mode: AlphaMode::Opaque,
    })
    .map_err(fault)?;
    let bits = |x: f32| (x.clamp(0.0, 1.0) * 1023.0).round() as u32;
    let texels = texture.texels.chunks(3).map(|x| bits(x[0]) | bits(x[1]) << 10 | bits(x[2]) << 20 | 3 << 30);
    dds.data = texels.flat_map(u32::to_le_bytes).collect();
    let mut bytes = vec![];
    dds.write(&mut bytes).map_err(fault)?;
    Ok(bytes)
}
