//! Pictures with eighteen channels: dots, checkers, stripes, ramps, noise, windows and letters.

use ltcforge::light::textured::{LightImage, LightPyramid, TexturedReflection};
use rand_core::{Rng, SeedableRng};
use rand_xoshiro::Xoshiro256PlusPlus;

/// The number of channels.
pub(super) const CHANNELS: usize = 18;

/// Six pictures with three channels each, all of one size, and their pyramids.
#[derive(Debug)]
pub(super) struct Pictures {
    /// The pictures.
    pub(super) images: Vec<LightImage>,
    /// The prefiltered pictures.
    pub(super) pyramids: Vec<LightPyramid>,
}

impl Pictures {
    /// Pictures of this width and height, with square texels.
    pub(super) fn new(size: [usize; 2]) -> Self {
        let texels = texels(size);
        let image = |i: usize| {
            let channels = texels.iter().map(|texel| [texel[3 * i], texel[3 * i + 1], texel[3 * i + 2]]).collect();
            LightImage::new(size[0], size[1], channels).expect("an image")
        };
        let images: Vec<LightImage> = (0..CHANNELS / 3).map(image).collect();
        let pyramids = images.iter().map(LightPyramid::new).collect();
        Self { images, pyramids }
    }

    /// The reflected light of all channels, for a Fresnel factor of one.
    pub(super) fn channels(&self, of: impl Fn(&LightPyramid) -> TexturedReflection) -> Vec<f64> {
        self.pyramids.iter().flat_map(|pyramid| of(pyramid).energy).collect()
    }
}

fn uniform(random: &mut Xoshiro256PlusPlus) -> f64 {
    (random.next_u64() >> 11) as f64 / (1_u64 << 53) as f64
}

/// Noise from octaves of a lattice. Each octave is half as strong as the previous, which gives about 1/f.
fn noise(seed: u64) -> impl Fn(f64, f64) -> f64 {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let octaves: Vec<Vec<f64>> = (0..7)
        .map(|o| {
            let n = (2_usize << o) + 1;
            (0..n * n).map(|_| uniform(&mut random) - 0.5).collect()
        })
        .collect();
    move |u, v| {
        let mut sum = 0.5;
        for (o, lattice) in octaves.iter().enumerate() {
            let n = 2_usize << o;
            let (x, y) = (u * n as f64, v * n as f64);
            let (i, j) = ((x as usize).min(n - 1), (y as usize).min(n - 1));
            let (fx, fy) = (x - i as f64, y - j as f64);
            let at = |i: usize, j: usize| lattice[j * (n + 1) + i];
            let top = at(i, j) * (1.0 - fx) + at(i + 1, j) * fx;
            let low = at(i, j + 1) * (1.0 - fx) + at(i + 1, j + 1) * fx;
            sum += (top * (1.0 - fy) + low * fy) / f64::from(1 << o) * 1.2;
        }
        sum.clamp(0.0, 1.0)
    }
}

/// Cells of random values.
fn mosaic(seed: u64, n: usize) -> impl Fn(f64, f64) -> f64 {
    let mut random = Xoshiro256PlusPlus::seed_from_u64(seed);
    let cells: Vec<f64> = (0..n * n).map(|_| uniform(&mut random)).collect();
    move |u, v| cells[((v * n as f64) as usize).min(n - 1) * n + ((u * n as f64) as usize).min(n - 1)]
}

/// The texels of a picture with this size.
fn texels(size: [usize; 2]) -> Vec<[f32; CHANNELS]> {
    let fields = [11, 12, 13].map(noise);
    let [tiles, letters] = [mosaic(21, 16), mosaic(22, 48)];
    let long = size[0].max(size[1]) as f64;
    let bit = |is: bool| f64::from(u8::from(is));
    (0..size[0] * size[1])
        .map(|i| {
            let (x, y) = ((i % size[0]) as f64 + 0.5, (i / size[0]) as f64 + 0.5);
            let (u, v) = (x / size[0] as f64, y / size[1] as f64);
            let (a, b) = (x / long, y / long);
            let middle = [0.5 * size[0] as f64 / long, 0.5 * size[1] as f64 / long];
            let short = 2.0 * middle[0].min(middle[1]);
            let dot = |cu: f64, cv: f64, radius: f64| {
                bit((a - cu * 2.0 * middle[0]).hypot(b - cv * 2.0 * middle[1]) < radius * short)
            };
            let checker = |n: f64| bit(((u * n) as i64 + (v * n) as i64) % 2 == 0);
            let pane = |n: f64, m: f64| {
                let (p, q) = ((u * n).fract(), (v * m).fract());
                bit(p > 0.1 && p < 0.9 && q > 0.1 && q < 0.9)
            };
            [
                dot(0.5, 0.5, 0.08),
                dot(0.3, 0.65, 0.03),
                checker(2.0),
                checker(8.0),
                checker(32.0),
                bit((u * 8.0) as i64 % 2 == 0),
                bit((v * 24.0) as i64 % 2 == 0),
                bit(((a + b) * 24.0) as i64 % 2 == 0),
                u,
                (1.0 - 1.4 * (u - 0.5).hypot(v - 0.5)).max(0.0),
                fields[0](u, v),
                fields[1](u, v),
                fields[2](u, v),
                pane(2.0, 3.0),
                pane(4.0, 4.0),
                tiles(u, v),
                bit(letters(u, v) > 0.6 && (v * 24.0) as i64 % 2 == 0),
                bit([u, v].iter().any(|x| !(0.08..=0.92).contains(x))),
            ]
            .map(|x: f64| x as f32)
        })
        .collect()
}
