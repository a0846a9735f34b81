//! Tests primaries, ICC profiles and their curves.

use super::*;

/// An ICC profile from this space to XYZ.
fn icc(space: &[u8], tags: &[(&[u8; 4], Vec<u8>)]) -> Vec<u8> {
    let mut bytes = vec![0; 128];
    bytes[16..20].copy_from_slice(space);
    bytes[20..24].copy_from_slice(b"XYZ ");
    bytes.extend((tags.len() as u32).to_be_bytes());
    let mut at = 132 + 12 * tags.len();
    for (name, data) in tags {
        bytes.extend([&name[..], &(at as u32).to_be_bytes(), &(data.len() as u32).to_be_bytes()].concat());
        at += data.len();
    }
    for (_, data) in tags {
        bytes.extend(data);
    }
    bytes
}

/// A tag's data: its kind, four zeros, these bytes, and numbers with 16 bits after the point.
fn tag(kind: &[u8], bytes: &[u8], numbers: &[f64]) -> Vec<u8> {
    let numbers = numbers.iter().flat_map(|x| ((x * 65_536.0).round() as i32).to_be_bytes());
    [kind, &[0; 4], bytes].concat().into_iter().chain(numbers).collect()
}

/// The sRGB curve as a formula.
fn srgb_formula() -> Vec<u8> {
    tag(b"para", &[0, 3, 0, 0], &[2.4, 1.0 / 1.055, 0.055 / 1.055, 1.0 / 12.92, 0.04045])
}

/// An ICC profile with the same curve for each channel.
fn rgb_icc(curve: &[u8], columns: [[f64; 3]; 3]) -> Vec<u8> {
    let [red, green, blue] = columns.map(|xyz| tag(b"XYZ ", &[], &xyz));
    let curves = [b"rTRC", b"gTRC", b"bTRC"].map(|name| (name, curve.to_vec()));
    let matrix = [(b"rXYZ", red), (b"gXYZ", green), (b"bXYZ", blue)];
    icc(b"RGB ", &[&curves[..], &matrix[..]].concat())
}

/// The columns of widespread profiles for sRGB and Display P3.
const SRGB: [[f64; 3]; 3] = [[0.43607, 0.22249, 0.01392], [0.38515, 0.71687, 0.09708], [0.14307, 0.06061, 0.7141]];
const P3: [[f64; 3]; 3] = [[0.51512, 0.2412, -0.00105], [0.29198, 0.69225, 0.04189], [0.1571, 0.06657, 0.78407]];

/// Red, green and white, with a profile.
fn png_with_icc(icc: &[u8]) -> Vec<u8> {
    let mut info = ::png::Info::with_size(3, 1);
    (info.color_type, info.icc_profile) = (::png::ColorType::Rgb, Some(icc.into()));
    let mut bytes = Vec::new();
    let mut writer = ::png::Encoder::with_info(&mut bytes, info).expect("a header").write_header().expect("a header");
    writer.write_image_data(&[255, 0, 0, 0, 255, 0, 255, 255, 255]).expect("pixels");
    writer.finish().expect("an end");
    bytes
}

/// A JPEG of one colour.
fn jpeg_of(colour: [u8; 3], change: impl FnOnce(&mut jpeg_encoder::Encoder<&mut Vec<u8>>)) -> Vec<u8> {
    let mut bytes = Vec::new();
    let mut encoder = jpeg_encoder::Encoder::new(&mut bytes, 100);
    change(&mut encoder);
    encoder.encode(&colour.repeat(64), 8, 8, jpeg_encoder::ColorType::Rgb).expect("a JPEG");
    bytes
}

/// Red, green and white with the primaries of Display P3 and BT.2020, as their known matrices to BT.709 convert them.
/// Negative parts are zero.
#[test]
fn stated_primaries_become_bt709() {
    const WIDE: [[[f32; 3]; 2]; 2] =
        [[[1.2249, 0.0, 0.0], [0.0, 1.042, 0.0]], [[1.6605, 0.0, 0.0], [0.0, 1.1329, 0.0]]];
    let check = |what: &str, bytes: &[u8], [red, green]: [[f32; 3]; 2]| {
        let picture = decoded(bytes);
        for (found, wanted) in picture.image.texels().iter().zip([red, green, [1.0; 3]]) {
            assert!((0..3).all(|c| (found[c] - wanted[c]).abs() < 1e-3), "{what}: {found:?} {wanted:?}");
        }
        picture.primaries.to_string()
    };
    let pixels = [255, 0, 0, 0, 255, 0, 255, 255, 255];
    let with = |kind: &[u8; 4], data: &[u8]| {
        png([3, 1], ::png::ColorType::Rgb, ::png::BitDepth::Eight, Some((*kind, data)), &pixels)
    };
    let [p3, bt2020] = [
        [0.3127, 0.329, 0.68, 0.32, 0.265, 0.69, 0.15, 0.06],
        [0.3127, 0.329, 0.708, 0.292, 0.17, 0.797, 0.131, 0.046],
    ];
    for (numbers, code, name, wanted) in [(p3, 12, "Display P3", WIDE[0]), (bt2020, 9, "BT.2020", WIDE[1])] {
        let chrm: Vec<u8> = numbers.iter().flat_map(|x: &f64| ((x * 1e5).round() as u32).to_be_bytes()).collect();
        assert_eq!(check("cHRM", &with(b"cHRM", &chrm), wanted), name);
        assert_eq!(check("cICP", &with(b"cICP", &[code, 13, 0, 1]), wanted), name);

        let [wx, wy, rx, ry, gx, gy, bx, by] = numbers;
        let line = format!("PRIMARIES= {rx} {ry} {gx} {gy} {bx} {by} {wx} {wy}\n");
        let pixels = [[128, 0, 0, 129], [0, 128, 0, 129], [128, 128, 128, 129]];
        let hdr = [b"#?RADIANCE\n", line.as_bytes(), b"\n-Y 1 +X 3\n", pixels.as_flattened()].concat();
        assert_eq!(check("PRIMARIES", &hdr, wanted), name);
        let seven = String::from_utf8_lossy(&hdr).replacen("PRIMARIES= 0", "PRIMARIES= x", 1);
        assert!(LightPicture::decode(seven.as_bytes(), None).is_err());

        let colour = |at: Vec2<usize>| [(1.0_f32, 0.0_f32, 0.0_f32), (0.0, 1.0, 0.0), (1.0, 1.0, 1.0)][at.0];
        let channels = SpecificChannels::rgb(colour);
        let layer = Layer::new((3, 1), LayerAttributes::named("picture"), Encoding::default(), channels);
        let mut image = Image::from_layer(layer);
        let xy = |x: f64, y: f64| Vec2(x as f32, y as f32);
        image.attributes.chromaticities = Some(exr::meta::attribute::Chromaticities {
            red: xy(rx, ry),
            green: xy(gx, gy),
            blue: xy(bx, by),
            white: xy(wx, wy),
        });
        let mut file = Cursor::new(Vec::new());
        image.write().non_parallel().to_buffered(&mut file).expect("EXR");
        assert_eq!(check("chromaticities", &file.into_inner(), wanted), name);
    }
    let profile = rgb_icc(&srgb_formula(), P3);
    assert_eq!(check("iCCP", &png_with_icc(&profile), WIDE[0]), "of an ICC profile");
    let red = jpeg_of([254, 0, 0], |encoder| encoder.add_icc_profile(&profile).expect("a profile"));
    let found = decoded(&red).image.texels()[0];
    assert!(found[0] > 1.21 && found[1] == 0.0 && found[2] == 0.0, "{found:?}");
    // The chunk sRGB has priority over cHRM, and cICP over iCCP.
    let mut info = with(b"cHRM", &[0; 32]);
    assert!(LightPicture::decode(&info, None).expect_err("black primaries").to_string().contains("do not enclose"));
    let at = 33;
    info.splice(at..at, *b"\0\0\0\x01sRGB\0\xae\xce\x1c\xe9");
    assert_eq!(decoded(&info).primaries.to_string(), "BT.709");
    let mut info = png_with_icc(&profile);
    let mut chunk = b"cICP\x01\x0d\0\x01".to_vec();
    let mut crc = flate2_crc(&chunk);
    crc.reverse();
    chunk.splice(0..0, 4_u32.to_be_bytes());
    chunk.extend(crc);
    info.splice(at..at, chunk);
    assert_eq!(decoded(&info).primaries.to_string(), "BT.709");
    assert!(LightPicture::decode(&with(b"cICP", &[10, 13, 0, 1]), None).is_err());
}

#[test]
fn profiles_are_read_exactly_or_refused() {
    let curves = |curve: &[u8]| decoded(&png_with_icc(&rgb_icc(curve, SRGB)));
    let exact = decoded(&png(
        [3, 1],
        ::png::ColorType::Rgb,
        ::png::BitDepth::Eight,
        None,
        &[255, 0, 0, 0, 255, 0, 255, 255, 255],
    ));
    // sRGB as a formula and as samples, which the most common profile has.
    let linear = |i: u32| Curve::Srgb.linear(0, f64::from(i) / 1023.0);
    let samples: Vec<u8> = (0..1024).flat_map(|i| ((linear(i) * 65_535.0).round() as u16).to_be_bytes()).collect();
    let sampled = tag(b"curv", &[&1024_u32.to_be_bytes(), &samples[..]].concat(), &[]);
    for curve in [&srgb_formula(), &sampled] {
        assert_eq!(curves(curve), exact);
    }
    assert_eq!(curves(&tag(b"curv", &[0; 4], &[])).curve, Curve::Linear);
    let at = |curve: &[u8], x: u8| {
        let profile = icc(b"GRAY", &[(b"kTRC", curve.to_vec())]);
        let mut info = ::png::Info::with_size(1, 1);
        info.icc_profile = Some(profile.into());
        let mut bytes = Vec::new();
        let mut writer =
            ::png::Encoder::with_info(&mut bytes, info).expect("a header").write_header().expect("a header");
        writer.write_image_data(&[x]).expect("pixels");
        writer.finish().expect("an end");
        decoded(&bytes).image.texels()[0]
    };
    let x = 100.0 / 255.0_f64;
    for (curve, wanted) in [
        (tag(b"curv", &[0, 0, 0, 1, 2, 0x80], &[]), x.powf(2.5)),
        (tag(b"para", &[0; 4], &[3.0]), x.powi(3)),
        (tag(b"para", &[0, 1, 0, 0], &[2.0, 2.0, -0.5]), (2.0 * x - 0.5).powi(2)),
        (tag(b"para", &[0, 1, 0, 0], &[2.0, 1.0, -0.5]), 0.0),
        (tag(b"para", &[0, 2, 0, 0], &[2.0, 2.0, -0.5, 0.125]), (2.0 * x - 0.5).powi(2) + 0.125),
        (tag(b"para", &[0, 2, 0, 0], &[2.0, 1.0, -0.5, 0.125]), 0.125),
        (tag(b"para", &[0, 3, 0, 0], &[2.0, 1.0, 0.0, 0.5, 0.75]), 0.5 * x),
        (tag(b"para", &[0, 4, 0, 0], &[2.0, 1.0, 0.0, 0.5, 0.25, 0.125, 0.0]), x * x + 0.125),
        (tag(b"para", &[0, 4, 0, 0], &[2.0, 1.0, 0.0, 0.5, 0.75, 0.125, 0.25]), 0.5 * x + 0.25),
    ] {
        let [r, g, b] = at(&curve, 100);
        assert!((f64::from(r) - wanted).abs() < 1e-5 && r == g && g == b, "{r} {g} {b} {wanted}");
    }
    let said = |profile: &[u8]| {
        let jpeg = jpeg_of([9; 3], |encoder| encoder.add_icc_profile(profile).expect("a profile"));
        let [jpeg, png] =
            [jpeg, png_with_icc(profile)].map(|bytes| LightPicture::decode(&bytes, None).expect_err("refused"));
        assert_eq!(jpeg, png);
        jpeg.to_string()
    };
    let cmyk = said(&icc(b"CMYK", &[]));
    assert!(cmyk.contains("«CMYK» to «XYZ »") && cmyk.contains("-profile sRGB.icc"), "{cmyk}");
    let tables = [(b"A2B0", vec![0; 32]), (b"kTRC", srgb_formula())];
    let profiles = [icc(b"GRAY", &tables), rgb_icc(&tag(b"para", &[0, 5, 0, 0], &[2.0, 2.0, -0.5]), SRGB)];
    for profile in [b"RGB ", b"GRAY"].map(|space| icc(space, &[])).into_iter().chain(profiles) {
        assert!(said(&profile).contains("only a matrix with curves is"));
    }
}
