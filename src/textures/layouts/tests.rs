use super::*;
use ltcforge_files::recipe_document;
use ltcforge_fit::{Recipe, Terms};

/// A table in which each number identifies its position: number `k` of entry `i` is `16 i + k`. 9 and 10 are the terms.
fn planted(document: &str) -> Table {
    let recipe: Recipe = recipe_document::parse(document.as_bytes(), u64::MAX).expect("a recipe");
    let entries = recipe.entries() as usize;
    let matrix = (0..entries).map(|i| std::array::from_fn(|k| (i * 16 + k) as f32)).collect();
    let term = |place: usize| (0..entries).map(|i| (i * 16 + place) as f32).collect();
    Table {
        brdf: recipe.brdf.clone(),
        lobe: recipe.lobe,
        layout: recipe.layout,
        axes: recipe.nodes(),
        matrix,
        terms: Some(Terms { amplitude: term(9), fresnel: term(10), edge: None }),
        second: None,
        node_error: vec![0.0; entries],
    }
}

const SMALL: &str = r#"{"layout": "kt2022", "resolution": {"alpha": 2, "ratio": 3, "theta": 4, "phi": 5}}"#;

fn owned(names: &[&str]) -> Vec<String> {
    names.iter().map(|name| (*name).to_owned()).collect()
}

/// A channel of a texel, found by its name.
fn at(texture: &Texture, channel: &str, [x, y, z]: [usize; 3]) -> f32 {
    let [width, height] = [texture.width, texture.height].map(|n| n as usize);
    let place = texture.channels.iter().position(|own| own == channel).expect(channel);
    texture.texels[((z * height + y) * width + x) * texture.channels.len() + place]
}

#[test]
fn every_description_matches_the_textures() {
    for layout in TextureLayout::ALL {
        let sampling = layout.sampling();
        let table = planted(sampling.recipe);
        assert_eq!(table.layout, sampling.table, "{layout}");
        let textures = layout.textures(&table).expect("a table with these textures");
        assert_eq!(textures.len(), sampling.textures.len(), "{layout}");
        for (texture, of) in textures.iter().zip(sampling.textures) {
            assert_eq!((texture.name.as_str(), texture.channels.as_slice()), (of.name, owned(of.channels).as_slice()));
            assert!(texture.check().is_ok(), "{layout}");
        }
        let lines = sampling_of(&table, *layout).join("\n");
        assert!(sampling.axes.iter().all(|axis| lines.contains(axis.coordinate)), "{lines}");
    }
}

/// In each part, the layers of the second lobes follow those of the first lobes, in volumes and in an array.
#[test]
fn second_lobes_have_their_own_layers_and_no_place_in_2d_textures() {
    let table = planted(&SMALL.replacen('{', r#"{"fresnel": "two_lobes", "#, 1));
    let second = table.matrix.iter().map(|m| m.map(|x| -x)).collect();
    let table = Table { second: Some(second), ..table };
    let volumes = textures_of(&table, "kt2022").expect("textures");
    let array = textures_of(&table, "kt2022-array").expect("textures");
    assert_eq!([volumes[0].depth, array[0].layers], [4, 12]);
    for (y, alpha) in (0..12).flat_map(|y| (0..2).map(move |alpha| (y, alpha))) {
        for (part, channels) in [["m00", "m10"], ["m11", "m21"], ["m22", "m22"]].iter().enumerate() {
            for (channel, of_array) in channels.iter().zip(["x", if part == 2 { "x" } else { "w" }]) {
                let own = at(&volumes[part], channel, [3, y, alpha]);
                assert_eq!(at(&volumes[part], channel, [3, y, alpha + 2]), -own, "{channel}");
                assert_eq!(at(&array[0], of_array, [3, y, 4 * part + alpha]), own, "{channel}");
                assert_eq!(at(&array[0], of_array, [3, y, 4 * part + 2 + alpha]), -own, "{channel}");
            }
        }
        let amplitude = |alpha: usize| at(&volumes[2], "amplitude", [3, y, alpha]);
        assert_eq!(amplitude(alpha), amplitude(alpha + 2));
    }
    let isotropic = planted(r#"{"layout": "ltc2017", "fresnel": "two_lobes", "resolution": {"alpha": 5, "theta": 3}}"#);
    let isotropic = Table { second: Some(isotropic.matrix.clone()), ..isotropic };
    let refused = textures_of(&isotropic, "ltc2017").expect_err("no place for them").to_string();
    assert!(refused.contains("one lobe per entry") && !refused.contains("two_lobes"), "{refused}");
    assert_eq!(textures_of(&isotropic, "ltc2017-3d").expect("textures")[0].depth, 10);
}

#[test]
fn isotropic_textures_have_roughness_along_x_and_the_view_along_y() {
    // For a channel of the matrix, the index row * 3 + column in the stored matrix.
    let of_matrix = |channel: &str| -> Option<f32> {
        let place = channel.strip_prefix("minv").or(channel.strip_prefix('m'))?;
        let (row, column) = (place[..1].parse::<u8>().ok()?, place[1..].parse::<u8>().ok()?);
        Some(f32::from(3 * row + column))
    };
    for name in ["ltc2017", "ltc2016", "godot", "hdrp"] {
        let document = format!(r#"{{"layout": "{name}", "resolution": {{"alpha": 5, "theta": 3}}}}"#);
        let textures = textures_of(&planted(&document), name).expect("textures");
        let mut seen = 0;
        for texture in &textures {
            assert_eq!([texture.width, texture.height, texture.depth, texture.layers], [5, 3, 1, 1], "{name}");
            for (channel, (x, y)) in
                texture.channels.iter().flat_map(|c| (0..5).flat_map(move |x| (0..3).map(move |y| (c, (x, y)))))
            {
                let known = of_matrix(channel).or(match channel.as_str() {
                    "amplitude" => Some(9.0),
                    "fresnel" => Some(10.0),
                    _ => None,
                });
                if let Some(number) = known {
                    assert_eq!(at(texture, channel, [x, y, 0]), (16 * (x * 3 + y)) as f32 + number, "{name} {channel}");
                    seen += 1;
                }
            }
        }
        assert_eq!(
            seen,
            15 * if name == "ltc2017" {
                6
            } else if name == "hdrp" {
                4
            } else if name == "godot" {
                7
            } else {
                6
            }
        );
    }
}

#[test]
fn the_sphere_is_indexed_by_elevation_and_length() {
    let table = planted(r#"{"layout": "ltc2017", "resolution": {"alpha": 5, "theta": 3}}"#);
    let second = &textures_of(&table, "ltc2017").expect("textures")[1];
    // x is the cosine from -1 to 1, and y is the length from 0 to 1. The result is a cosine at length 0, and the result
    // for a hemisphere, (1 + c) / 2, at length 1.
    for (x, cos) in [-1.0_f32, -0.5, 0.0, 0.5, 1.0].into_iter().enumerate() {
        assert_eq!(at(second, "sphere", [x, 0, 0]), cos.max(0.0));
        assert!((at(second, "sphere", [x, 2, 0]) - 0.5 * (1.0 + cos)).abs() < 1e-6);
    }
}

#[test]
fn volumes_and_arrays_have_entries_in_the_order_of_the_file() {
    let table = planted(SMALL);
    let textures = textures_of(&table, "kt2022").expect("textures");
    for (part, texture) in textures.iter().enumerate() {
        assert_eq!([texture.width, texture.height, texture.depth, texture.layers], [5, 12, 2, 1]);
        for (entry, texel) in texture.texels.chunks(4).enumerate() {
            let expected: [f32; 4] = std::array::from_fn(|j| (entry * 16 + 4 * part + j) as f32);
            let known = if part == 2 { 3 } else { 4 };
            assert_eq!(texel[..known], expected[..known], "{} {entry}", texture.name);
        }
    }
    let array = textures_of(&table, "kt2022-array").expect("an array");
    assert_eq!([array[0].width, array[0].height, array[0].depth, array[0].layers], [5, 12, 1, 6]);
    let together: Vec<f32> = textures.iter().flat_map(|texture| texture.texels.clone()).collect();
    assert_eq!(array[0].texels, together);
}

#[test]
fn the_published_volume_has_rows_over_alpha_and_ratio() {
    let table = planted(r#"{"layout": "kt2022"}"#);
    let volume = &textures_of(&table, "kt2022-volume").expect("a volume")[0];
    assert_eq!([volume.width, volume.height, volume.depth, volume.layers], [8, 8, 192, 1]);
    for (a, r, t, p, row) in [(0, 0, 0, 0, 0), (1, 2, 3, 4, 0), (7, 6, 5, 0, 1), (3, 0, 7, 7, 2)] {
        let entry = ((a * 8 + r) * 8 + t) * 8 + p;
        for column in 0..3 {
            let channel = format!("column_{column}");
            let found = at(volume, &channel, [p, t, row * 64 + a * 8 + r]);
            assert_eq!(found, (16 * entry + 3 * row + column) as f32, "{a} {r} {t} {p} {row} {column}");
        }
    }
}

#[test]
fn errors_name_a_recipe_with_these_textures() {
    let refused = |table: &Table, layout: &str| textures_of(table, layout).expect_err(layout).to_string();
    let small = planted(SMALL);
    assert!(refused(&small, "reflected").contains(r#"{"layout": "reflected"}"#));
    let ltc2017 = refused(&small, "ltc2017");
    assert!(ltc2017.contains("kt2022") && ltc2017.contains(r#"{"layout": "ltc2017"}"#), "{ltc2017}");
    let volume = refused(&small, "kt2022-volume");
    assert!(volume.contains("2 x 3 x 4 x 5") && volume.contains(r#"{"layout": "kt2022"}"#), "{volume}");
    assert!(refused(&small, "square").contains("layouts with textures: reflected, kt2022"));
    let sheen = refused(&planted(r#"{"brdf": "charlie", "layout": "ltc2017"}"#), "hdrp");
    assert!(sheen.ends_with(r#"{"brdf": "charlie", "layout": "hdrp"}"#), "{sheen}");
    // The lobes of sheen are not near a reflection.
    let reflected = refused(&planted(r#"{"brdf": "charlie", "layout": "ltc2017"}"#), "reflected");
    assert!(reflected.ends_with(r#"{"layout": "reflected"}"#), "{reflected}");
    let mut without = planted(r#"{"layout": "ltc2017"}"#);
    without.terms = None;
    assert!(refused(&without, "ltc2017").contains("amplitude"));
    let mut part = planted(r#"{"layout": "kt2022", "range": {"alpha": [0.5, 1]}}"#);
    assert!(refused(&part, "kt2022-volume").contains("whole domain"));
    part.terms = None;
    let textures = textures_of(&part, "kt2022").expect("terms are not needed");
    assert!(textures[2].texels.chunks(4).all(|texel| texel[1..] == [1.0, 0.0, 0.0]));
}
