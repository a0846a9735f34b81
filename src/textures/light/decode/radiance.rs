//! Radiance HDR: three bytes of colour and one byte for the exponent [Ward 1991]. EXPOSURE and COLORCORR are ignored.
//! Without PRIMARIES, primaries are those of BT.709, as most programs write.
//!
//! A scanline has run-length encoding per component, or the older encoding of whole pixels. Scanlines run from left to
//! right and from top to bottom, and other orders are errors. Other header lines are ignored.

use super::{Chromaticities, Curve, Decoded, LightFileError, PictureFormat, Wanted, from_floats, primaries};

/// Red, green, blue and the exponent.
type Pixel = [u8; 4];

pub(super) fn decode(bytes: &[u8], wanted: Wanted) -> Result<Decoded, LightFileError> {
    let broken = |reason| LightFileError::broken(PictureFormat::Radiance, reason);
    let mut rest = bytes;
    let ([width, height], stated) = header(&mut rest).map_err(broken)?;
    let size = wanted.bounded(width.into(), height.into())?;
    let primaries = primaries(stated)?;
    let mut line = vec![[0; 4]; size[0]];
    let mut texels = Vec::with_capacity(size[0] * size[1]);
    for _ in 0..size[1] {
        scanline(&mut rest, &mut line).ok_or_else(|| broken("a scanline ends too soon or too late"))?;
        texels.extend(line.iter().copied().map(radiance));
    }
    let curve = wanted.curve(Curve::Linear);
    from_floats(&mut texels, &curve);
    Ok(Decoded { size, curve, primaries, texels, orientation: 1 })
}

/// Reads width and height, and the primaries if they are stated. The bytes after the header remain in `bytes`.
fn header<'a>(bytes: &mut &'a [u8]) -> Result<([u32; 2], Option<Chromaticities>), &'static str> {
    let mut stated = None;
    let mut line = || -> Result<&'a [u8], &'static str> {
        let (line, rest) = bytes.split_at(bytes.iter().position(|byte| *byte == b'\n').ok_or("the header has no end")?);
        *bytes = &rest[1..];
        Ok(line)
    };
    loop {
        let line = line()?;
        if line.is_empty() {
            break;
        }
        if line.strip_prefix(b"FORMAT=").is_some_and(|format| format.trim_ascii() != b"32-bit_rle_rgbe") {
            return Err("its FORMAT is not 32-bit_rle_rgbe");
        }
        if let Some(numbers) = line.strip_prefix(b"PRIMARIES=") {
            let numbers = str::from_utf8(numbers).ok().map(|text| text.split_ascii_whitespace().map(str::parse));
            let numbers = numbers.and_then(|numbers| numbers.collect::<Result<Vec<f64>, _>>().ok());
            let numbers: Option<[f64; 8]> = numbers.and_then(|numbers| numbers.try_into().ok());
            let pairs = numbers.map(|n| [[n[0], n[1]], [n[2], n[3]], [n[4], n[5]], [n[6], n[7]]]);
            stated = Some(pairs.ok_or("its PRIMARIES are not the x and y of red, green, blue and white")?);
        }
    }
    let order = "its size line must be -Y, height, +X, width";
    let words: Vec<&str> = str::from_utf8(line()?).map_err(|_| order)?.split_ascii_whitespace().take(5).collect();
    let ["-Y", height, "+X", width, ..] = words[..] else { return Err(order) };
    Ok(([width.parse().map_err(|_| order)?, height.parse().map_err(|_| order)?], stated))
}

/// Fills a scanline of at least one pixel. `None` if the bytes end too early, or a run exceeds the line.
fn scanline(bytes: &mut &[u8], line: &mut [Pixel]) -> Option<()> {
    let first: Pixel = take(bytes)?;
    if let [2, 2, 0..128, _] = first { components(bytes, line) } else { pixels(bytes, first, line) }
}

/// Reads each component. A run is a length of up to 128 and that many bytes, or 128 plus a length and the byte to
/// repeat.
fn components(bytes: &mut &[u8], line: &mut [Pixel]) -> Option<()> {
    for component in 0..4 {
        let mut at = 0;
        while at < line.len() {
            let [length] = take(bytes)?;
            let is_run = length > 128;
            let end = at + usize::from(if is_run { length - 128 } else { length });
            let mut value = if is_run { take(bytes)? } else { [0] };
            for pixel in line.get_mut(at..end)? {
                if !is_run {
                    value = take(bytes)?;
                }
                [pixel[component]] = value;
            }
            at = end;
        }
    }
    Some(())
}

/// Reads whole pixels. A pixel of colour 1, 1, 1 repeats the previous pixel, and its exponent is the number of repeats.
/// Several such pixels in a row are the digits of one number in base 256, the lowest digit first.
fn pixels(bytes: &mut &[u8], first: Pixel, line: &mut [Pixel]) -> Option<()> {
    let (mut last, mut at, mut unit) = (first, 1, 1_usize);
    let is_run = |pixel: &Pixel| pixel.starts_with(&[1; 3]);
    line[0] = Some(first).filter(|pixel| !is_run(pixel))?;
    while at < line.len() {
        let pixel = take(bytes)?;
        let length = if is_run(&pixel) { usize::from(pixel[3]).checked_mul(unit)? } else { 1 };
        (last, unit) = if is_run(&pixel) { (last, unit.checked_mul(256)?) } else { (pixel, 1) };
        let end = at.checked_add(length)?;
        line.get_mut(at..end)?.fill(last);
        at = end;
    }
    Some(())
}

/// Takes the next bytes.
fn take<const N: usize>(bytes: &mut &[u8]) -> Option<[u8; N]> {
    let (next, rest) = bytes.split_first_chunk()?;
    *bytes = rest;
    Some(*next)
}

/// The colour c 2^(e - 136), which is exact in f32. It is zero for e = 0.
fn radiance([red, green, blue, exponent]: Pixel) -> [f32; 3] {
    // 1023 is the exponent bias of f64.
    let scale = if exponent == 0 { 0.0 } else { f64::from_bits((u64::from(exponent) + 1023 - 136) << 52) };
    [red, green, blue].map(|byte| (f64::from(byte) * scale) as f32)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(size: &str, data: &[u8]) -> Option<Vec<[f32; 3]>> {
        let bytes = [format!("#?RADIANCE\nEXPOSURE=2\n\n{size}\n").as_bytes(), data].concat();
        Some(decode(&bytes, Wanted { transfer: None, most: 100 }).ok()?.texels)
    }

    #[test]
    fn a_byte_is_a_multiple_of_the_step_of_its_exponent() {
        let least = 2.0_f32.powi(-126) / 512.0;
        for (pixel, expected) in [
            ([128, 64, 0, 129], [1.0, 0.5, 0.0]),
            ([255, 1, 2, 1], [255.0 * least, least, 2.0 * least]),
            ([255, 255, 1, 0], [0.0; 3]),
            ([1, 0, 255, 255], [2.0_f32.powi(119), 0.0, 255.0 * 2.0_f32.powi(119)]),
        ] {
            assert_eq!(radiance(pixel), expected, "{pixel:?}");
        }
    }

    #[test]
    fn runs_of_both_kinds_are_read() {
        let [one, two] = [[128, 64, 32, 129], [64, 64, 64, 130]];
        let texels = |pixels: &[Pixel]| Some(pixels.iter().copied().map(radiance).collect::<Vec<_>>());
        let line = [one, two, two, two];
        let old = [&one[..], &two, &[1, 1, 1, 2]].concat();
        assert_eq!(read("-Y 1 +X 4", &old), texels(&line));
        let new = [2, 2, 0, 4, 1, 128, 131, 64, 132, 64, 1, 32, 131, 64, 1, 129, 131, 130];
        assert_eq!(read("-Y 1 +X 4", &new), texels(&line));
        assert_eq!(read("-Y 2 +X 4", &[&old[..], &new].concat()), texels(&[line, line].concat()));
        for broken in [&old[..8], &[&one[..], &[1, 1, 1, 4]].concat(), &new[..17], &[1; 16], &[2, 2, 0, 4, 133, 1]] {
            assert_eq!(read("-Y 1 +X 4", broken), None, "{broken:?}");
        }
        for size in ["+Y 1 +X 4", "-Y 1", "+X 4 -Y 1", "-Y 1 +X four"] {
            assert_eq!(read(size, &old), None, "{size}");
        }
    }

    #[test]
    fn another_format_is_rejected() {
        let bytes = b"#?RADIANCE\nFORMAT=32-bit_rle_xyze\n\n-Y 1 +X 1\n\x01\x02\x03\x04";
        let error = decode(bytes, Wanted { transfer: None, most: 100 }).err().expect("a fault").to_string();
        assert!(error.contains("FORMAT is not 32-bit_rle_rgbe"), "{error}");
    }
}
