use std::{collections::HashMap, fs, path::PathBuf};

use proptest::prelude::*;

use super::*;
use crate::recipe_document::{DEFAULT_ENTRY_LIMIT, RecipeError, canonical_json, digest, parse_stored, parse_with};
use ltcforge_fit::{BrdfKind, Recipe};

fn planted(alpha: &[f64]) -> Vec<u8> {
    let brdf = TabulatedBrdf::tabulate(BrdfKind::OrenNayar, TabulatedAxes::spread(alpha.to_vec(), 48, 24));
    encode(&brdf.expect("a BRDF")).expect("a file")
}

/// GGX with few nodes, with ratios 0.5 and 1, or without `ratio`.
fn planted_anisotropic(ratio: &[f64]) -> Vec<u8> {
    let axes = TabulatedAxes::spread(vec![0.6, 1.0], 12, 7).with_azimuths(ratio.to_vec(), 3);
    encode(&TabulatedBrdf::tabulate(BrdfKind::Ggx, axes).expect("a BRDF")).expect("a file")
}

/// Tensors of f32 by name, shape and value.
fn file(tensors: &[(&str, Vec<usize>, f32)]) -> Vec<u8> {
    let tensors: HashMap<String, Tensor> = tensors
        .iter()
        .map(|(name, shape, x)| {
            let count = shape.iter().product();
            let bytes = (0..count).flat_map(|i| (x * i as f32).to_le_bytes()).collect();
            ((*name).to_owned(), Tensor { dtype: Dtype::F32, shape: shape.clone(), bytes })
        })
        .collect();
    serialize(tensors, None).expect("a container")
}

#[test]
fn a_file_reads_back_as_itself() {
    for alpha in [vec![], vec![0.25, 0.5]] {
        let bytes = planted(&alpha);
        let file = decode(&bytes).expect("a BRDF");
        assert_eq!(file.to_string(), Digest::of(&bytes).to_string());
        let data = file.data().expect("its numbers");
        assert_eq!(data.axes().alpha, alpha);
        assert_eq!(encode(data).expect("a file"), bytes);
    }
}

#[test]
fn an_anisotropic_file_reads_back_as_itself() {
    for (ratio, axes) in [(vec![0.5, 1.0], 6), (vec![], 5)] {
        let bytes = planted_anisotropic(&ratio);
        let file = decode(&bytes).expect("a BRDF");
        let data = file.data().expect("its numbers");
        assert_eq!((&data.axes().ratio, data.axes().phi_o.len()), (&ratio, 3));
        assert_eq!(data.axes().named().iter().filter(|(_, nodes)| !nodes.is_empty()).count(), axes);
        assert_eq!(encode(data).expect("a file"), bytes);
        assert!(is_tabulated(&bytes[..8 + u64::from_le_bytes(*bytes.first_chunk().expect("a header")) as usize]));
    }
}

/// Readers differ in which of two equal names they use.
#[test]
fn a_header_that_repeats_a_name_is_refused() {
    let bytes = planted(&[0.5]);
    let end = 8 + u64::from_le_bytes(*bytes.first_chunk().expect("a header")) as usize;
    let header: serde_json::Value = serde_json::from_slice(&bytes[8..end]).expect("JSON");
    let header = header.as_object().expect("tensors");
    for name in header.keys() {
        // The last tensor of a name is valid, the first differs from it.
        for first in [r#"{"dtype":"F64","shape":[0],"data_offsets":[0,0]}"#, &header[name].to_string()] {
            let header = serde_json::to_string(header).expect("JSON");
            let header = format!("{{\"{name}\":{first},{}", &header[1..]);
            let repeated = [&(header.len() as u64).to_le_bytes(), header.as_bytes(), &bytes[end..]].concat();
            let refused = decode(&repeated).expect_err("two tensors").to_string();
            assert!(refused.contains(&format!("the field «{name}» is repeated")), "{refused}");
        }
    }
}

#[test]
fn a_file_is_known_by_a_short_header() {
    let bytes = planted(&[0.5]);
    let header = 8 + u64::from_le_bytes(*bytes.first_chunk().expect("a header")) as usize;
    assert!(is_tabulated(&bytes[..header]));
    assert!(!is_tabulated(&bytes[..header - 1]) && !is_tabulated(b"") && !is_tabulated(&[0xff; 64]));
    assert!(!is_tabulated(&file(&[("value", vec![1], 1.0), ("matrix", vec![1], 1.0)])));

    // Tensors without numbers: a valid file may have a million of them.
    let many: Vec<String> =
        (0..2000).map(|i| format!(r#""{i}":{{"dtype":"F32","shape":[0],"data_offsets":[0,0]}}"#)).collect();
    let header = format!("{{{}}}", many.join(","));
    let bytes = [&(header.len() as u64).to_le_bytes(), header.as_bytes()].concat();
    let reported = decode(&bytes).expect_err("a long header").0;
    assert_eq!(reported, [format!("a header of {} bytes; allowed: at most 65536", header.len())]);
}

#[test]
fn every_fault_of_a_container_is_reported_at_once() {
    let reported = |bytes: &[u8]| decode(bytes).expect_err("faults").0;
    assert!(reported(b"PK")[0].starts_with("not a safetensors file: "));
    let wrong = file(&[
        ("theta_o", vec![2, 1], 1.5),
        ("phi", vec![2], 1.0),
        ("value", vec![2, 3], -1.0),
        ("roughness", vec![1], 1.0),
    ]);
    let reported = reported(&wrong);
    let wanted = [
        "tensor «roughness»: unknown; allowed: alpha, ratio, theta_o, phi_o, theta_i, phi, value",
        "tensor «theta_i»: missing",
        "tensor «theta_o»: shape [2, 1]; allowed: one axis",
        "tensor «value»: shape [2, 3]; the axes have [2, 0, 2]",
        "tensor «theta_i»: 0 nodes; allowed: 2 or more",
        "tensor «phi»: nodes go from 0 to 1; they must go from 0 to 3.141592653589793",
        "tensor «value»: 5 of 6 numbers are negative; the first is -1, at element 1",
    ];
    assert_eq!(reported, wanted);
}

/// Azimuths cover a whole turn if the view has azimuths, and an axis that is present has nodes.
#[test]
fn every_fault_of_azimuths_is_reported_at_once() {
    let reported = decode(&file(&[
        ("alpha", vec![0], 1.0),
        ("ratio", vec![0], 1.0),
        ("theta_o", vec![2], 1.0),
        ("phi_o", vec![2], 1.0),
        ("theta_i", vec![2], std::f32::consts::FRAC_PI_2),
        ("phi", vec![3], std::f32::consts::FRAC_PI_2),
        ("value", vec![2, 2, 2, 3], 0.0),
    ]));
    let wanted = [
        "tensor «alpha»: no roughness; leave the tensor out for a surface without alpha",
        "tensor «ratio»: no nodes; leave the tensor out for a surface without ratio",
        "tensor «value»: shape [2, 2, 2, 3]; the axes have [0, 0, 2, 2, 2, 3]",
        "tensor «phi_o»: nodes go from 0 to 1; they must go from 0 to 1.5707963267948966",
        "tensor «phi»: nodes go from 0 to 3.1415927410125732; they must go from 0 to 6.283185307179586",
    ];
    assert_eq!(reported.expect_err("faults").0, wanted);
}

fn recipe(document: &str, bytes: &[u8]) -> Result<Recipe, RecipeError> {
    parse_with(document.as_bytes(), DEFAULT_ENTRY_LIMIT, &|name| match name {
        "gold" => decode(bytes).map_err(|error| error.0),
        _ => Err(vec!["no such file".to_owned()]),
    })
}

fn faults(document: &str) -> Vec<(String, String)> {
    match recipe(document, &planted(&[0.25, 0.5])) {
        Err(RecipeError::Faults(faults)) => faults.into_iter().map(|fault| (fault.pointer, fault.detail)).collect(),
        other => panic!("{document} gave {other:?}"),
    }
}

#[test]
fn a_recipe_has_the_ranges_of_its_file_and_names_its_digest() {
    let bytes = planted(&[0.25, 0.5]);
    let document = r#"{"brdf": "tabulated", "tabulated": "gold"}"#;
    let with_alpha = recipe(document, &bytes).expect("a recipe");
    assert_eq!((with_alpha.range().alpha, with_alpha.range().theta[0]), ([0.25, 0.5], 0.0));
    let text = canonical_json(&with_alpha);
    assert!(
        text.starts_with(r#"{"brdf":"tabulated","fit":"#) && text.contains(&Digest::of(&bytes).to_string()),
        "{text}"
    );
    let stored = parse_stored(text.as_bytes()).expect("the same");
    assert_eq!((digest(&stored), &stored), (digest(&with_alpha), &with_alpha));
    assert!(with_alpha.model().is_complete() && !stored.model().is_complete());
    // One surface without roughness gives one row of the table.
    let without = recipe(document, &planted(&[])).expect("a recipe");
    assert_eq!((without.range().alpha, without.resolution().alpha), ([1.0, 1.0], 1));
}

#[test]
fn a_recipe_that_does_not_fit_its_file_says_what_to_change() {
    let cases = [
        (
            r#"{"tabulated": "gold"}"#,
            "/tabulated",
            r#"brdf "ggx" needs no file: choose brdf "tabulated", or leave this field out"#,
        ),
        (
            r#"{"brdf": "tabulated"}"#,
            "/tabulated",
            r#"missing: brdf "tabulated" needs its file, a path or sha256:<64 hex digits>"#,
        ),
        (
            r#"{"brdf": "tabulated", "tabulated": 1}"#,
            "/tabulated",
            "1 is neither a path nor a digest sha256:<64 hex digits>",
        ),
        (r#"{"brdf": "tabulated", "tabulated": "lead"}"#, "/tabulated", "no such file"),
        (
            r#"{"brdf": "tabulated", "tabulated": "gold", "range": {"alpha": [0.2, 0.5]}}"#,
            "/range/alpha",
            "[0.2, 0.5] exceeds the data: the file of the tabulated BRDF has alpha [0.25, 0.5]",
        ),
    ];
    for (document, pointer, detail) in cases {
        assert_eq!(faults(document), [(pointer.to_owned(), detail.to_owned())], "{document}");
    }
    let engine = faults(r#"{"brdf": "tabulated", "tabulated": "gold", "layout": "ltc2017"}"#);
    let said = r#"layout "ltc2017" has the fixed range [0, 1] of alpha, but the file of the tabulated BRDF has alpha [0.25, 0.5]"#;
    assert_eq!(engine[0], ("/layout".to_owned(), said.to_owned()));
    assert!(engine.len() == 2 && engine[1].1.contains("has theta_o [0, 1.468"), "{engine:?}");
    let both =
        faults(r#"{"brdf": "tabulated", "tabulated": "gold", "layout": "reflected", "range": {"ratio": [0, 1]}}"#);
    assert_eq!(both.iter().map(|(pointer, _)| &**pointer).collect::<Vec<_>>(), ["/layout", "/range/ratio"]);
}

/// A file with azimuths gives the table its azimuths, and ratios if it has them. A file that was not read gives the
/// values of the stored recipe.
#[test]
fn a_recipe_is_as_anisotropic_as_its_file() {
    let document = r#"{"brdf": "tabulated", "tabulated": "gold"}"#;
    let quarter = [0.0, std::f64::consts::FRAC_PI_2];
    for (ratio, wanted, ratios) in [(&[0.5, 1.0][..], [0.5, 1.0], 8), (&[], [1.0, 1.0], 1)] {
        let whole = recipe(document, &planted_anisotropic(ratio)).expect("a recipe");
        assert_eq!((whole.range().alpha, whole.range().ratio, whole.range().phi), ([0.6, 1.0], wanted, quarter));
        assert_eq!((whole.resolution().ratio, whole.resolution().phi), (ratios, 8));
        assert!(!whole.model().is_isotropic() && whole.model().has_azimuths());
        let stored = parse_stored(canonical_json(&whole).as_bytes()).expect("the same");
        assert_eq!((digest(&stored), &stored), (digest(&whole), &whole));
    }
    let reported = |fields: &str, ratio: &[f64]| {
        let document = format!(r#"{{"brdf": "tabulated", "tabulated": "gold", {fields}}}"#);
        match recipe(&document, &planted_anisotropic(ratio)) {
            Err(RecipeError::Faults(faults)) => {
                faults.into_iter().map(|fault| format!("{}: {}", fault.pointer, fault.detail)).collect::<Vec<_>>()
            }
            other => panic!("{document} gave {other:?}"),
        }
    };
    let wanted = [
        "/layout: layout \"ltc2017\" is for isotropic surfaces, but the file of the tabulated BRDF has azimuths of the view, phi_o; \
         layouts for this file: \"kt2022\"",
        "/range/ratio: [0.4, 1] exceeds the data: the file of the tabulated BRDF has ratio [0.5, 1]",
        "/fit/solver: solver \"nelder_mead\" fits isotropic surfaces only, but the file of the tabulated BRDF has azimuths of the \
         view, phi_o: choose \"bfgs\", \"sgd\"",
    ];
    let fields = r#""layout": "ltc2017", "range": {"ratio": [0.4, 1]}, "fit": {"solver": "nelder_mead"}"#;
    assert_eq!(reported(fields, &[0.5, 1.0]), wanted);
    let wanted = "/range/phi: a table with ratio 1 and the single value 0 is read as isotropic, but the file of the tabulated BRDF has \
                  azimuths of the view, phi_o: give phi a range";
    assert_eq!(reported(r#""range": {"phi": [0, 0]}"#, &[]), [wanted]);
}

#[test]
fn a_digest_is_found_where_tables_are() {
    let folder = tempfile::tempdir().expect("a folder");
    let folders = [PathBuf::from("/none"), folder.path().to_owned()];
    let bytes = planted(&[]);
    let digest = Digest::of(&bytes);
    let short = locate(&folders, "sha256:00").err().expect("no digest");
    assert_eq!(short, [r#""sha256:00" is not a digest, sha256:<64 hex digits>"#]);
    let missing = locate(&folders, &digest.to_string()).err().expect("no file");
    assert!(missing[0].contains(".brdf.safetensors is missing in /none/ and "), "{missing:?}");
    let path = folder.path().join(kept_name(digest.as_bytes()));
    fs::write(&path, &bytes).expect("a file");
    let found = locate(&folders, &digest.to_string()).expect("the file");
    assert_eq!((found.file.digest(), found.bytes), (digest.as_bytes(), bytes));
    fs::write(&path, planted(&[0.5])).expect("another file");
    let other = locate(&folders, &digest.to_string()).err().expect("another");
    assert!(other[0].contains("the file is damaged or another file"), "{other:?}");
    assert!(locate(&[folder.path().to_owned()], path.to_str().expect("UTF-8")).is_ok());
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 200, ..ProptestConfig::default() })]

    /// Flipped bytes and cut files give an error or a BRDF that can be sampled, never a panic.
    #[test]
    fn hostile_bytes_are_refused_or_work(
        changes in prop::collection::vec((any::<prop::sample::Index>(), any::<u8>()), 0..6),
        keep in 0.0..1.2_f64,
        is_anisotropic: bool,
    ) {
        let mut bytes = if is_anisotropic { planted_anisotropic(&[0.5, 1.0]) } else { planted(&[0.5, 0.75]) };
        for (at, byte) in changes {
            let at = at.index(bytes.len());
            bytes[at] = byte;
        }
        bytes.truncate((bytes.len() as f64 * keep) as usize);
        if let Ok(file) = decode(&bytes) {
            let model = ltcforge_fit::BrdfModel::tabulated(file);
            let sample = model.surface([0.6; 2]).sample(glam::DVec3::new(0.6, 0.0, 0.8), [0.3, 0.7]);
            prop_assert!(sample.wi.is_finite() && sample.weight.is_finite());
        }
    }

    #[test]
    fn arbitrary_bytes_never_panic(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        prop_assert!(decode(&bytes).is_err());
    }
}
