//! Tests JPEGs without all of their pixels, and `OpenEXR` files with many channels.

use super::*;

/// JPEGs of 64 x 64 pixels: smooth and rough, in each way that the encoder has to store them. Bits of the index are
/// progressive, optimized, fewer colours, and restarts.
fn jpegs() -> Vec<Vec<u8>> {
    let smooth = vec![128; 3 * 64 * 64];
    let rough: Vec<u8> = (0..3 * 64 * 64_u32).map(|i| (i.wrapping_mul(2_654_435_761) >> 24) as u8).collect();
    let mut list = Vec::new();
    for pixels in [&smooth, &rough] {
        for way in 0..16 {
            let mut bytes = Vec::new();
            let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, 60);
            encoder.set_progressive(way & 1 != 0);
            encoder.set_optimized_huffman_tables(way & 2 != 0);
            let sampling = [jpeg_encoder::SamplingFactor::R_4_4_4, jpeg_encoder::SamplingFactor::R_4_2_0];
            encoder.set_sampling_factor(sampling[way >> 2 & 1]);
            if way & 8 != 0 {
                encoder.set_restart_interval(4);
            }
            encoder.encode(pixels, 64, 64, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
            list.push(bytes);
        }
    }
    list
}

#[test]
fn jpegs_with_too_few_pixels_are_refused() {
    let jpegs = jpegs();
    for (way, whole) in jpegs.iter().enumerate() {
        let found = LightPicture::decode(whole, None);
        // The encoder stores optimized colours in separate scans.
        if way & 0b11 == 0b10 {
            let said = found.expect_err("separate scans").to_string();
            assert!(said.contains("save it with one scan, or progressive"), "{said}");
            continue;
        }
        let picture = found.unwrap_or_else(|error| panic!("{way}: {error}"));
        assert!(picture == decoded(&jpegs[way & !0b1011]), "{way}");
        // Other images and metadata may follow the first image.
        assert!(decoded(&[&whole[..], whole, b"more"].concat()) == picture, "{way}");
        for tenths in 1..10 {
            let cut = &whole[..whole.len() * tenths / 10];
            assert!(LightPicture::decode(cut, None).is_err(), "{way}: {tenths} tenths");
            // Adding an end marker does not make the file valid. The last scans of an even progressive JPEG add nothing.
            let closed = LightPicture::decode(&[cut, &[0xff, 0xd9]].concat(), None);
            assert!(closed.is_err() || closed == Ok(picture.clone()), "{way}: {tenths} tenths with an end");
        }
        let at = whole.windows(2).position(|pair| matches!(pair, [0xff, 0xc0 | 0xc2])).expect("a header");
        for [width, height] in [[64, 80], [80, 64], [2048, 2048]] {
            let mut larger = whole.clone();
            larger[at + 5..at + 9].copy_from_slice(&[[0, height as u8], [0, width as u8]].concat());
            if width == 2048 {
                larger[at + 5..at + 9].copy_from_slice(&[8, 0, 8, 0]);
            }
            assert!(LightPicture::decode(&larger, None).is_err(), "{way}: {width} x {height}");
        }
    }
}

#[test]
fn channels_that_are_not_read_are_few() {
    let of = |count: usize| {
        let names: Vec<String> = (3..count).map(|i| format!("Z{i}")).collect();
        let names: Vec<&str> = ["R", "G", "B"].into_iter().chain(names.iter().map(String::as_str)).collect();
        LightPicture::decode(&exr(&names, vec![0.5; 2 * count]), None)
    };
    assert_eq!(of(16).expect("a picture").image.texels(), [[0.5; 3]; 2]);
    let said = of(17).expect_err("too many").to_string();
    assert!(said.contains("a part has 17 channels; at most 16 are allowed"), "{said}");
}
