//! Tests the files of a pyramid, which are read back.

use super::*;

fn pyramid() -> LightPyramid {
    let texels = (0_u8..15).map(|i| [f32::from(i) / 3.0, 1.0, 0.01 * f32::from(i * i)]).collect();
    LightPyramid::new(&LightImage::new(5, 3, texels).expect("an image"))
}

/// The levels of a KTX2 file. Checks that the fields of the file describe them.
fn ktx2_levels(file: &[u8], texels: LightTexels, zstd: bool) -> Vec<Vec<u8>> {
    let reader = ktx2::Reader::new(file).expect("KTX2");
    let header = reader.header();
    let (format, texel_bytes, samples) = match texels {
        LightTexels::Rgba16f => (ktx2::Format::R16G16B16A16_SFLOAT, 8, 4),
        LightTexels::Rgba32f => (ktx2::Format::R32G32B32A32_SFLOAT, 16, 4),
        LightTexels::Rgb9e5 => (ktx2::Format::E5B9G9R9_UFLOAT_PACK32, 4, 6),
    };
    assert_eq!(header.format, Some(format));
    assert_eq!([header.pixel_width, header.pixel_height, header.pixel_depth, header.layer_count], [5, 3, 0, 0]);
    assert_eq!([header.face_count, header.level_count], [1, 3]);
    let descriptor = reader.basic_dfd().expect("a descriptor");
    assert_eq!((descriptor.bytes_planes[0], descriptor.sample_information.len()), (texel_bytes, samples));
    let keys: Vec<(String, Vec<u8>)> =
        reader.key_value_data().map(|(key, value)| (key.to_owned(), value.to_vec())).collect();
    assert_eq!(
        keys.iter().map(|(key, _)| key.as_str()).collect::<Vec<_>>(),
        ["KTXorientation", "KTXwriter", "ltcforge"]
    );
    assert_eq!(keys[0].1, b"rd\0");
    let places: Vec<usize> =
        reader.levels().map(|level| level.data.as_ptr() as usize - file.as_ptr() as usize).collect();
    assert!(places.is_sorted_by(|a, b| a > b), "the smallest level comes first: {places:?}");
    assert!(zstd || places.iter().all(|place| place % usize::from(texel_bytes) == 0), "{places:?}");
    let data = |level: ktx2::Level<'_>| {
        let mut data = Vec::new();
        if zstd {
            let mut decoder = ruzstd::decoding::StreamingDecoder::new(level.data).expect("a zstd frame");
            decoder.read_to_end(&mut data).expect("all of it");
        } else {
            data.extend(level.data);
        }
        assert_eq!(level.uncompressed_byte_length, data.len() as u64);
        data
    };
    reader.levels().map(data).collect()
}

/// Checks the file sizes in docs/textured.md.
#[test]
fn files_are_four_thirds_of_the_texels() {
    let image = LightImage::new(1024, 1024, vec![[0.5; 3]; 1 << 20]).expect("an image");
    let pyramid = LightPyramid::new(&image);
    for (texels, bytes) in [(LightTexels::Rgba16f, 11_185_344), (LightTexels::Rgb9e5, 5_593_000)] {
        let made = light_texture_files("light", &pyramid, TextureContainer::Ktx2, texels, &About::new(["a light"]));
        let length = made.expect("a file").files[0].bytes.len();
        println!("{texels}: {length} bytes");
        assert!(length.abs_diff(bytes) < 1000, "{texels}: {length}");
    }
}

#[test]
fn ktx2_stores_all_levels() {
    let (pyramid, about) = (pyramid(), About::new(["a light"]));
    for (texels, most) in
        [(LightTexels::Rgba16f, 2e-4..5e-4), (LightTexels::Rgb9e5, 5e-4..2e-3), (LightTexels::Rgba32f, 0.0..1e-9)]
    {
        for container in [TextureContainer::Ktx2, TextureContainer::Ktx2Zstd] {
            let made = light_texture_files("screen", &pyramid, container, texels, &about).expect("a file");
            assert_eq!((made.files.len(), made.files[0].name.as_str(), made.clamped), (1, "screen.ktx2", 0));
            assert!(most.contains(&made.error), "{texels:?}: {}", made.error);
            let levels = ktx2_levels(&made.files[0].bytes, texels, container == TextureContainer::Ktx2Zstd);
            for (level, data) in pyramid.levels().iter().zip(levels) {
                let found: Vec<[f32; 3]> = match texels {
                    LightTexels::Rgba16f => data
                        .as_chunks::<2>()
                        .0
                        .as_chunks::<4>()
                        .0
                        .iter()
                        .map(|texel| {
                            assert_eq!(f16::from_le_bytes(texel[3]), f16::ONE);
                            [0, 1, 2].map(|c| f16::from_le_bytes(texel[c]).to_f32_const())
                        })
                        .collect(),
                    LightTexels::Rgba32f => data
                        .as_chunks::<4>()
                        .0
                        .as_chunks::<4>()
                        .0
                        .iter()
                        .map(|texel| [0, 1, 2].map(|c| f32::from_le_bytes(texel[c])))
                        .collect(),
                    LightTexels::Rgb9e5 => {
                        data.as_chunks::<4>().0.iter().map(|x| unpack(u32::from_le_bytes(*x))).collect()
                    }
                };
                assert_eq!(found.len(), level.texels().len());
                for (a, b) in level.texels().iter().zip(found) {
                    let largest = a[0].max(a[1]).max(a[2]);
                    assert!((0..3).all(|c| f64::from((a[c] - b[c]).abs() / largest) <= made.error), "{a:?} {b:?}");
                }
            }
        }
    }
}

#[test]
fn other_containers_store_a_texture_for_each_level() {
    let (pyramid, about) = (pyramid(), About::new(["a light"]));
    let files = |container, texels| light_texture_files("screen", &pyramid, container, texels, &about);
    let made = files(TextureContainer::Exr, LightTexels::Rgba32f).expect("files");
    let names: Vec<&str> = made.files.iter().map(|file| file.name.as_str()).collect();
    assert_eq!(names, ["screen_0.exr", "screen_1.exr", "screen_2.exr"]);
    for (file, level) in made.files.iter().zip(pyramid.levels()) {
        assert_eq!(&decoded(&file.bytes).image, level);
    }
    let refused = files(TextureContainer::Exr, LightTexels::Rgb9e5).expect_err("no such texels").to_string();
    assert_eq!(refused, "«screen»: texels is rgb9e5; exr allows rgba16f, rgba32f");
    let refused = files(TextureContainer::Dds, LightTexels::Rgba16f).expect_err("no such texels").to_string();
    assert_eq!(refused, "«screen»: texels is rgba16f; dds allows rgba32f");
}

#[test]
fn numbers_above_the_largest_are_counted() {
    let image = LightImage::new(2, 1, vec![[1e6, 1.0, 1.0], [70_000.0, 70_000.0, 1.0]]).expect("an image");
    let made = |texels| {
        let container = TextureContainer::Ktx2;
        light_texture_files("sun", &LightPyramid::new(&image), container, texels, &About::default()).expect("a file")
    };
    // The last level is the mean: 535000, 35000.5, 1.
    assert_eq!(made(LightTexels::Rgba32f).clamped, 0);
    assert!(made(LightTexels::Rgba16f).clamped >= 3 && made(LightTexels::Rgb9e5).clamped >= 3);
}
