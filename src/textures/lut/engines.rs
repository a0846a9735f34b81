//! The lookup tables of engines: parameters, channels, size, format, name.
//!
//! Sources: three.js 0.185 (npm), `@babylonjs/core` 9.35 (npm), and copies of the sources of Bevy 0.19, Godot, Filament,
//! HDRP, glTF-Sample-Renderer and Blender (2026). Godot and HDRP draw their tables when they start; their files
//! have the numbers of these textures.

use std::fmt::Write as _;

use ddsfile::{AlphaMode, D3D10ResourceDimension, Dds, DxgiFormat, NewDxgiParams};

use super::{
    super::{
        About, Bundle, TextureFileError,
        containers::{dx10, ktx2, numbers},
        texture::Texture,
    },
    LutExportError, file, fitted, flat, one, unrounded,
};
use half::f16;
use ltcforge_fit::{
    BrdfKind, Precision,
    albedo::{
        CosineAxis, DfgForm, Lut, LutAxes, LutKind, LutPrecision, LutRecipe, LutResolution, RoughnessAxis, Texels,
    },
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
    cos_theta: CosineAxis,
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
    cos_theta: CosineAxis::Cosine,
    texels: Texels::Centres,
    size: None,
    form: DfgForm::Karis,
    third: None,
    precision: LutPrecision::F16,
};
const SHEEN: Option<(LutKind, BrdfKind)> = Some((LutKind::Sheen, BrdfKind::CharlieNeubelt));

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
                cos_theta: CosineAxis::Root,
                texels: Texels::Corners,
                size: Some(64),
                form: DfgForm::Filament,
                third: Some((LutKind::Diffuse, BrdfKind::BurleyDiffuse)),
                // The format has 10 bits. Bounded texels suit it.
                precision: LutPrecision::Unorm16,
            },
            Self::GltfSampleViewer => Format { precision: LutPrecision::Rgba8, ..PLAIN },
            Self::Blender => Format {
                cos_theta: CosineAxis::Complement,
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
            axes: Some(LutAxes { roughness: RoughnessAxis::Perceptual, cos_theta, texels }),
            resolution: size.map_or(recipe.resolution, |n| LutResolution::new(recipe.table, |_| n)),
            precision,
            ..*recipe
        })
    }

    /// The engine's table for area lights.
    fn area_lights(self) -> String {
        match self {
            Self::Filament | Self::GltfSampleViewer => format!("{self} has no area lights, so it needs no LTC table."),
            Self::Blender => "Blender's table for area lights is the array ltc_mat_ggx in the same file: \
                              ltcforge export LTC_TABLE --layout ltc2017 --container c."
                .to_owned(),
            _ => format!("For the table of area lights of {self}: ltcforge export LTC_TABLE --for {self}."),
        }
    }

    /// The engine's files. `recipe` has the engine's parameters.
    pub(super) fn bundle(self, recipe: &LutRecipe, lut: Lut, about: &About) -> Result<Bundle, LutExportError> {
        let mut names = recipe.channels().to_vec();
        let mut texels = lut.texels;
        if let Some((table, brdf)) = self.format().third.filter(|_| recipe.table == LutKind::Dfg) {
            let third = fitted(&LutRecipe { table, brdf, form: None, ..*recipe }).texels;
            // HDRP stores Burley's diffuse reflection, from .5 to 1.5, minus .5.
            let offset = if self == Self::Hdrp { 0.5 } else { 0.0 };
            let both = texels.chunks(names.len()).zip(&third);
            texels = both.flat_map(|(texel, third)| texel.iter().copied().chain([third - offset])).collect();
            names.push(table.name());
        }
        let texture = Image { size: flat(recipe), names, texels };
        let (made, steps): (_, &[&str]) = match self {
            Self::Three => (
                three(&texture.transposed(), about)?,
                &["Replace src/renderers/shaders/DFGLUTData.js in three.js's sources (0.185), and build it."],
            ),
            Self::Bevy => {
                let texture = texture.texture("dfg")?;
                let stored = one(&texture, Precision::F16)?;
                (
                    file("dfg.ktx2", ktx2(&stored, true, about)?, &[&stored]),
                    &[
                        "Built in: replace crates/bevy_pbr/src/environment_map/dfg.ktx2 in Bevy's sources (feature dfg_lut).",
                        "At run time: insert the handle of dfg.ktx2 as DfgLut { texture } into the render world.",
                    ],
                )
            }
            Self::Babylon => {
                let rgbd: Vec<u8> = texture.texels.chunks(3).flat_map(rgbd).collect();
                let bytes = png(texture.size, png::ColorType::Rgba, png::BitDepth::Eight, &rgbd);
                (
                    unrounded("environmentBRDF.png", bytes),
                    &[
                        "Before the first PBR material: const t = new BABYLON.Texture(\"environmentBRDF.png\", scene, true, false); t.isRGBD = true; t.wrapU = t.wrapV = BABYLON.Texture.CLAMP_ADDRESSMODE; scene.environmentBRDFTexture = t;",
                        "Built in: replace the first PNG in packages/dev/core/src/Misc/brdfTextureTools.ts, in base64.",
                    ],
                )
            }
            Self::Godot => {
                let opaque = Image {
                    names: [texture.names.as_slice(), &["one"]].concat(),
                    texels: texture.texels.chunks(3).flat_map(|x| [x[0], x[1], x[2], 1.0]).collect(),
                    ..texture
                };
                // Rough surfaces come first.
                let texture = opaque.flipped().texture("dfg_lut")?;
                let stored = one(&texture, Precision::F16)?;
                (
                    file("dfg_lut.dds", dx10(&stored)?, &[&stored]),
                    &[
                        "Godot draws this texture when it starts: in scene_shader_forward_clustered.cpp, fill dfg_lut.texture from dfg_lut.dds instead of running integrate_dfg.glsl.",
                    ],
                )
            }
            Self::Filament => (
                unrounded("dfg.inc", include(&texture, about).into_bytes()),
                &[
                    "Filament's build runs cmgen --ibl-dfg=dfg.inc: replace the generated dfg.inc (generated/data) and build again.",
                    "Mobile builds use 64 x 64 texels: set DFG_LUT_SIZE=128.",
                ],
            ),
            Self::Hdrp => (
                unrounded("PreIntegratedFGD_GGXDisneyDiffuse.dds", ten_bits(&texture)?),
                &[
                    "HDRP draws this texture when it starts: in PreIntegratedFGD.RenderInit, copy these texels to m_PreIntegratedFGD[0] instead of calling DrawFullScreen.",
                ],
            ),
            Self::GltfSampleViewer => {
                let texel = |x: &[f32]| match *x {
                    [e] => [e, e, e, 1.0],
                    _ => [x[0], x[1], 0.0, 1.0],
                };
                let texels = texture.texels.chunks(texture.names.len()).flat_map(texel);
                let bytes: Vec<u8> = texels.map(|x| (x.clamp(0.0, 1.0) * 255.0).round() as u8).collect();
                let path = if recipe.table == LutKind::Sheen { "lut_sheen_E.png" } else { "lut_ggx.png" };
                (
                    unrounded(path, png(texture.size, png::ColorType::Rgba, png::BitDepth::Eight, &bytes)),
                    &[
                        "Put the file into assets/images and pass its path to ResourceLoader.loadEnvironment, as lut_ggx_file or lut_sheen_E_file.",
                        "The present viewer draws the GGX table itself: in ibl_sampler.js, load lut_ggx.png instead of calling sampleGGXLut.",
                    ],
                )
            }
            Self::Blender => (
                unrounded("brdf_ggx.inc", array(&texture.transposed(), about).into_bytes()),
                &[
                    "Replace the array brdf_ggx in source/blender/draw/engines/eevee/eevee_lut.cc, and build Blender.",
                    "Versions before the F82 tint have [64][64][2]: leave out each third number.",
                ],
            ),
        };
        let steps = steps.iter().map(|&step| step.to_owned()).chain([self.area_lights()]);
        Ok(Bundle { files: vec![made], steps: steps.collect() })
    }
}

/// Texels, x fastest. The cosine is along x and roughness along y.
struct Image {
    size: [u32; 2],
    names: Vec<&'static str>,
    texels: Vec<f32>,
}

impl Image {
    /// Roughness along x.
    fn transposed(self) -> Self {
        let ([width, height], n) = (self.size.map(|n| n as usize), self.names.len());
        let order = (0..width).flat_map(|x| (0..height).map(move |y| (y * width + x) * n));
        let texels = order.flat_map(|at| self.texels[at..at + n].iter().copied()).collect();
        Self { size: [self.size[1], self.size[0]], texels, ..self }
    }

    /// The last row first.
    fn flipped(self) -> Self {
        let rows = self.texels.chunks(self.size[0] as usize * self.names.len());
        Self { texels: rows.rev().flatten().copied().collect(), ..self }
    }

    fn texture(self, name: &str) -> Result<Texture, TextureFileError> {
        Ok(Texture::flat(name, self.size, &self.names, self.texels)?)
    }
}

/// `getDFGLUT` of three.js.
fn three(image: &Image, about: &About) -> Result<super::super::TextureFile, LutExportError> {
    let texture =
        Image { size: image.size, names: image.names.clone(), texels: image.texels.clone() }.texture("dfg")?;
    let stored = one(&texture, Precision::F16)?;
    let [width, height] = image.size;
    let mut text = about.comment();
    // Writing to a String cannot fail.
    let _ = write!(
        text,
        "\nimport {{ DataTexture }} from '../../textures/DataTexture.js';\n\
         import {{ RGFormat, HalfFloatType, LinearFilter, ClampToEdgeWrapping }} from '../../constants.js';\n\n\
         const DATA = new Uint16Array( [\n{}] );\n\n\
         let lut = null;\n\n\
         export function getDFGLUT() {{\n\n\
         \tif ( lut !== null ) return lut;\n\n\
         \tlut = new DataTexture( DATA, {width}, {height}, RGFormat, HalfFloatType, undefined, ClampToEdgeWrapping, \
         ClampToEdgeWrapping, LinearFilter, LinearFilter );\n\
         \tlut.name = 'DFG_LUT';\n\tlut.generateMipmaps = false;\n\tlut.needsUpdate = true;\n\treturn lut;\n\n}}\n",
        numbers(&stored, |x| x.to_string())
    );
    Ok(file("DFGLUTData.js", text.into_bytes(), &[&stored]))
}

/// A texel of RGBD: the colour is `(r, g, b)^2.2 / d`.
fn rgbd(texel: &[f32]) -> [u8; 4] {
    let most = texel.iter().fold(1.0 / 255.0, |most: f32, x| most.max(*x));
    // The divisor that uses the range of the other three best.
    let divisor = (255.0 / most.max(1.0)).floor() / 255.0;
    let byte = |x: f32| (pow(f64::from(x.max(0.0) * divisor), 1.0 / 2.2).min(1.0) * 255.0).round() as u8;
    [byte(texel[0]), byte(texel[1]), byte(texel[2]), (divisor * 255.0).round() as u8]
}

/// The halves as Filament's `cmgen` writes them.
fn include(image: &Image, about: &About) -> String {
    let mut text = about.comment();
    for texels in image.texels.chunks(4 * image.names.len()) {
        let bits: Vec<String> = texels.iter().map(|x| format!("0x{:04x}", f16::from_f32_const(*x).to_bits())).collect();
        let _ = writeln!(text, "    {},", bits.join(", "));
    }
    text
}

/// The array `brdf_ggx` of EEVEE.
fn array(image: &Image, about: &About) -> String {
    let ([width, height], n) = (image.size, image.names.len());
    let mut text = format!("{}const float brdf_ggx[{height}][{width}][{n}] = {{\n", about.comment());
    for row in image.texels.chunks(width as usize * n) {
        let texels: Vec<String> = row
            .chunks(n)
            .map(|texel| format!("{{{}}}", texel.iter().map(|x| format!("{x:?}f")).collect::<Vec<_>>().join(", ")))
            .collect();
        let _ = writeln!(text, "    {{{}}},", texels.join(", "));
    }
    text + "};\n"
}

/// A texture `R10G10B10A2_UNORM`.
fn ten_bits(image: &Image) -> Result<Vec<u8>, TextureFileError> {
    let [width, height] = image.size;
    let fault = |error: ddsfile::Error| TextureFileError::Refused { container: "DDS", reason: error.to_string() };
    let mut dds = Dds::new_dxgi(NewDxgiParams {
        height,
        width,
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
    let texels = image.texels.chunks(3).map(|x| bits(x[0]) | bits(x[1]) << 10 | bits(x[2]) << 20 | 3 << 30);
    dds.data = texels.flat_map(u32::to_le_bytes).collect();
    let mut bytes = vec![];
    dds.write(&mut bytes).map_err(fault)?;
    Ok(bytes)
}

/// A PNG without a colour space. Domain: bytes for all pixels.
pub(super) fn png([width, height]: [u32; 2], colour: png::ColorType, depth: png::BitDepth, bytes: &[u8]) -> Vec<u8> {
    let mut out = vec![];
    let mut encoder = png::Encoder::new(&mut out, width, height);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    // Writing to memory cannot fail, and the number of bytes is right.
    let written = encoder.write_header().and_then(|mut writer| writer.write_image_data(bytes));
    debug_assert!(written.is_ok(), "{written:?}");
    out
}
