//! Checks that printed texts keep the names, the comments and the meaning of their source. `ltcforge-view` runs the
//! texts.

use std::collections::BTreeSet;

use proptest::prelude::*;

use super::*;
use crate::{tests::lit_by, wgsl::folded};
use ltcforge_fit::Layout;
use ltcforge_light::{LightModel, NormalsRule};
use ltcforge_shaders::{Additions, Filter, Lights, LitBy, Reading, SHADERS, functions};

const TEXTS: [Language; 5] = [Language::Glsl, Language::Glsl330, Language::GlslEs, Language::Hlsl, Language::Msl];

/// The printed functions that `main` calls.
fn translated(language: Language, source: &str) -> String {
    printed(language, source, "main", Form::Include).unwrap_or_else(|error| panic!("{error}\n{source}"))
}

/// Checks that the printed body of a function contains these lines, for each language.
#[track_caller]
fn assert_lines(source: &str, wanted: &[(Language, &str)]) {
    for (language, wanted) in wanted {
        let text = translated(*language, source);
        assert!(text.contains(wanted), "{}: no\n{wanted}\nin\n{text}", language.name());
    }
}

/// A function with this body, called by an entry point.
fn called(parameters: &str, body: &str) -> String {
    let head = format!("struct Pair {{ a: vec2<f32>, half: f32 }}\nfn f({parameters}) -> f32 {{\n");
    format!("{head}    {body}\n}}\n\n@fragment\nfn main() {{ f(); }}\n")
}

/// The words of code, without comments and numbers.
fn words(text: &str) -> BTreeSet<&str> {
    let code = text.lines().map(|line| line.split("//").next().unwrap_or_default());
    let is_part = |c: char| c.is_ascii_alphanumeric() || c == '_';
    let words = code.flat_map(|line| line.split(move |c| !is_part(c)));
    words.filter(|word| word.starts_with(|c: char| c.is_ascii_alphabetic())).collect()
}

/// The comments of a text, without the slashes.
fn comments(text: &str) -> BTreeSet<&str> {
    let comment = |line: &'_ str| line.find("//").map(|at| at + 2);
    text.lines().filter_map(|line| Some(line[comment(line)?..].trim_start_matches('/').trim())).collect()
}

/// WGSL words that other languages write differently.
const OF_WGSL: [&str; 35] = [
    "fn",
    "let",
    "var",
    "ptr",
    "function",
    "array",
    "select",
    "saturate",
    "inverseSqrt",
    "bitcast",
    "mix",
    "fract",
    "f32",
    "u32",
    "i32",
    "vec2",
    "vec3",
    "vec4",
    "mat2x3",
    "mat3x3",
    "mat4x3",
    "mat4x4",
    "textureLoad",
    "textureSampleLevel",
    "texture_3d",
    "texture_2d_array",
    "sampler",
    "uniform",
    "group",
    "binding",
    "ltc_sampler",
    "const",
    "bool",
    "struct",
    "u",
];

/// Every shader text in WGSL, with its entry point and with the filter constant replaced.
fn sources() -> Vec<(LitBy, String)> {
    let rules = NormalsRule::SHADED.map(|rule| lit_by(LightModel::Normals, None).by_rule(Some(rule)).expect("a rule"));
    let models = rules.into_iter().chain([
        lit_by(LightModel::LtcFormula, None),
        lit_by(LightModel::Asg, None),
        lit_by(LightModel::Asg, Some(Layout::Kt2022)),
    ]);
    let cut = Additions { cut: true, compensate: true, textured: None };
    let cut = LitBy::from(Layout::Reflected).with(cut).expect("a table of LTCs");
    let compensated = [
        (LightModel::LtcFormula, None),
        (LightModel::Normals, None),
        (LightModel::Sg, None),
        (LightModel::Sg, Some(Layout::Kt2022)),
    ];
    let compensated = compensated.map(|(model, layout)| {
        lit_by(model, layout).with(Additions { cut: false, compensate: true, textured: None }).expect("a model")
    });
    let layouts = Layout::ALL.iter().map(|layout| (*layout).into()).chain([cut]).chain(compensated);
    let mut sources = Vec::new();
    for lit_by in models.chain(layouts) {
        for (reading, lights) in
            Reading::ALL.into_iter().flat_map(|reading| Lights::ALL.iter().map(move |l| (reading, *l)))
        {
            let source = functions(lit_by, reading, lights) + &lit_by.caller(reading, lights);
            let filtered = folded(&source, "ltc_hardware_filter", reading.filter == Filter::Hardware);
            sources.push((lit_by, filtered.unwrap_or_else(|fault| panic!("{}", fault.message(&source)))));
        }
    }
    sources.dedup();
    sources
}

#[test]
fn every_name_and_comment_of_the_source_is_printed() {
    let mut compared = 0;
    for (lit_by, source) in sources() {
        let parsed = parse(&source).expect("a module");
        let order = Order::from(&parsed, "ltc_included").expect("an order");
        let entry = parsed.items.iter().position(|item| item.name == "ltc_included");
        let reached = order.printed(&parsed).into_iter().filter(|(number, _)| Some(*number) != entry);
        let reached: String = reached
            .map(|(number, lead)| lead.free + &lead.own + &source[parsed.items[number].span.clone()] + "\n")
            .collect();
        let (wanted_words, wanted_comments) = (words(&reached), comments(&reached));
        if lit_by.model() == LightModel::Normals {
            // The caller for this model calls every function.
            assert_eq!(wanted_comments, comments(&source));
        }
        for language in TEXTS {
            let text = printed(language, &source, "ltc_included", Form::Include).expect("a text");
            let (name, found) = (language.name(), words(&text));
            for word in &wanted_words {
                let is_there = found.contains(*word) || found.contains(format!("{word}_").as_str());
                assert!(is_there || OF_WGSL.contains(word), "{name}, {lit_by:?}: {word} is missing");
            }
            let missing: Vec<_> = wanted_comments.difference(&comments(&text)).copied().collect();
            assert_eq!(missing, [""; 0], "{name}, {lit_by:?}");
            let is_numbered = |word: &&str| word.strip_prefix("_e").is_some_and(|rest| rest.parse::<u32>().is_ok());
            assert!(!text.contains("__") && !found.iter().any(is_numbered), "{name}, {lit_by:?}");
            compared += wanted_comments.len();
        }
    }
    assert!(compared > 5000, "{compared}");
}

#[test]
fn differences_between_languages_are_translated() {
    use Language::{Glsl, Hlsl, Msl};
    assert_lines(
        &called("m: mat4x3<f32>, v: vec4<f32>, r: mat3x3<f32>", "let a = r * (m * v); // product\n    return a.x;"),
        &[
            (Glsl, "vec3 a = r * (m * v); // product"),
            (Hlsl, "float3 a = mul(mul(v, m), r); // product"),
            (Msl, "float f(float4x3 m, float4 v, float3x3 r) {\n    float3 a = r * (m * v); // product"),
        ],
    );
    assert_lines(
        &called(
            "v: vec2<f32>",
            "let a = select(v, vec2(1.0), v < vec2(0.0)) + select(1.0, 2.0, v.x > 0.0);\n    return a.x;",
        ),
        &[
            (Glsl, "vec2 a = mix(v, vec2(1.0), lessThan(v, vec2(0.0))) + (v.x > 0.0 ? 2.0 : 1.0);"),
            (Hlsl, "float2 a = (v < (float2)0.0 ? (float2)1.0 : v) + (v.x > 0.0 ? 2.0 : 1.0);"),
            (Msl, "float2 a = select(v, float2(1.0), v < float2(0.0)) + (v.x > 0.0 ? 2.0 : 1.0);"),
        ],
    );
    assert_lines(
        &called(
            "x: f32",
            "let bits = bitcast<i32>(x) - 0x7f;\n    return saturate(fract(x) % 2.0) * inverseSqrt(atan2(x, f32(bits)));",
        ),
        &[
            (Glsl, "int bits = floatBitsToInt(x) - 0x7f;"),
            (Glsl, "clamp((fract(x) - 2.0 * trunc(fract(x) / 2.0)), 0.0, 1.0) * inversesqrt(atan(x, float(bits)))"),
            (
                Hlsl,
                "int bits = asint(x) - 0x7f;\n    return saturate(fmod(frac(x), 2.0)) * rsqrt(atan2(x, float(bits)));",
            ),
            (
                Msl,
                "int bits = as_type<int>(x) - 0x7f;\n    return saturate(fmod(fract(x), 2.0)) * rsqrt(atan2(x, float(bits)));",
            ),
        ],
    );
    // Reserved words, also as a member; zeros; and a variable that hides another with the same name.
    assert_lines(
        &called(
            "half: f32",
            "var out: Pair;\n    let flat = out.half + half;\n    { let flat = flat * 2.0; }\n    return flat;",
        ),
        &[
            (
                Glsl,
                "float f(float half_) {\n    Pair out_ = Pair(vec2(0.0), 0.0);\n    float flat_ = out_.half_ + half_;",
            ),
            (Hlsl, "    Pair out_ = (Pair)0;\n    float flat = out_.half_ + half_;\n    { float flat_ = flat * 2.0; }"),
            (Msl, "    Pair out = Pair {};\n    float flat = out.half_ + half_;\n    { float flat_ = flat * 2.0; }"),
        ],
    );
    assert_lines(
        &called(
            "v: ptr<function, array<f32, 2>>, w: array<f32, 2>",
            "var copy = w;\n    (*v)[0] = copy[1];\n    let list = array<f32, 2>(1.0, 2.0);\n    return (*v)[0] + list[1];",
        ),
        &[
            (Glsl, "float f(inout float v[2], float w[2]) {\n    float copy[2] = w;\n    v[0] = copy[1];"),
            (Glsl, "float list[2] = float[2](1.0, 2.0);"),
            (Hlsl, "float list[2] = { 1.0, 2.0 };"),
            (
                Msl,
                "float f(thread float (&v)[2], thread const float (&w)[2]) {\n    thread const float (&copy)[2] = w;",
            ),
        ],
    );
}

/// A function writes to a pointer if it passes the pointer to a function that writes to it.
#[test]
fn a_pointer_passed_to_a_writing_function_is_written_to() {
    let source = "fn g(p: ptr<function, f32>) { *p = 1.0; }\nfn f(p: ptr<function, f32>) { g(p); }\n\
        fn h(p: ptr<function, f32>) -> f32 { return 2.0 * *p; }\n\
        @fragment\nfn main() { var x = 0.0; f(&x); h(&x); }\n";
    let text = translated(Language::Glsl, source);
    for wanted in ["void g(inout float p)", "void f(inout float p)", "float h(float p)"] {
        assert!(text.contains(wanted), "no {wanted} in\n{text}");
    }
    let text = translated(Language::Msl, source);
    for wanted in ["void g(thread float& p)", "void f(thread float& p)", "float h(thread const float& p)"] {
        assert!(text.contains(wanted), "no {wanted} in\n{text}");
    }
}

#[test]
fn a_variable_that_is_set_at_once_has_no_initial_zero() {
    let source = called("x: f32", "var y: f32;\n    y = x + 1.0;\n    var z: f32;\n    z += y;\n    return z;");
    let text = translated(Language::Glsl, &source);
    assert!(text.contains("    float y = x + 1.0;\n    float z = 0.0;\n    z += y;\n"), "{text}");
}

#[test]
fn errors_have_line_and_column() {
    for (body, wanted) in [
        ("return g(1.0);", "line 3, column 12: «g» is not known for these types"),
        ("return x;", "line 3, column 12: «x» is not declared"),
        ("let a = 1.0 +;\n    return a;", "line 3, column 18: expected a name, found «;»"),
        ("let /* why */ a = 1.0;\n    return a;", "line 3, column 9: a comment here would be lost in the output"),
        ("switch 1 { }", "line 3, column 12: expected an assignment or a call, found «1»"),
        ("return 1.0 # 2.0;", "line 3, column 16: unexpected character '#'"),
        ("return vec2(1.0).q;", "line 3, column 12: this value has no member «q»"),
    ] {
        for language in TEXTS {
            let error = printed(language, &called("", body), "main", Form::Include).expect_err(body);
            assert!(error.contains(wanted), "{body}: {error}");
        }
    }
    let own = "struct A { a: A }\nfn a() { var b: A; }\n@fragment\nfn main() { a(); }";
    let error = printed(Language::Glsl, own, "main", Form::Include).expect_err("a circle");
    assert!(error.contains("line 1") && error.contains("depends on itself"), "{error}");
    let circle = "fn a() { b(); }\nfn b() { a(); }\n@fragment\nfn main() { a(); }";
    let error = printed(Language::Glsl, circle, "main", Form::Include).expect_err("a circle");
    assert!(error.contains("line 1") && error.contains("depends on itself"), "{error}");
}

/// Expressions nested thousands deep.
#[test]
fn deep_nesting_is_rejected() {
    let deep = |open: &str, middle: &str, close: &str| open.repeat(9000) + middle + &close.repeat(9000);
    for expression in [
        deep("(", "1.0", ")"),
        deep("-", "1.0", ""),
        deep("", "1.0", " + 1.0"),
        deep("1.0 + (", "1.0", ")"),
        deep("f(", "1.0", ")"),
        deep("", "v", ".x"),
        deep("a[", "1", "]"),
    ] {
        let error = printed(Language::Glsl, &called("", &format!("return {expression};")), "main", Form::Include);
        assert!(error.expect_err("too deep").contains("line 3"));
    }
    for array in ["array<f32, 4000000000>", "array<array<f32, 2>, 2>"] {
        let error = printed(Language::Glsl, &called("", &format!("var a: {array};")), "main", Form::Include);
        assert!(error.expect_err("too long").contains("line 3"));
    }
    for body in
        [deep("{", "", "}"), deep("if (true) { } else ", "{}", ""), deep("let a: array<", "f32", ", 2>") + " = 1;"]
    {
        assert!(printed(Language::Glsl, &called("", &body), "main", Form::Include).is_err());
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 400, failure_persistence: None, ..ProptestConfig::default() })]

    /// Sources in which a part is removed, moved or doubled.
    #[test]
    fn damaged_sources_give_text_or_an_error_with_a_line(
        which in 0_usize..30, from in 0.0..1.0_f64, length in 0_usize..40, to in 0.0..1.0_f64, keeps in any::<bool>()
    ) {
        let source = &SHADERS[which % SHADERS.len()].source;
        let place = |part: f64| source.floor_char_boundary((part * source.len() as f64) as usize);
        let (start, end) = (place(from), source.floor_char_boundary((place(from) + length).min(source.len())));
        let part = &source[start..end.max(start)];
        let mut damaged = source.to_string();
        damaged.insert_str(place(to), part);
        if !keeps {
            damaged = damaged.replacen(part, "", 1);
        }
        damaged += "\n@fragment\nfn main() { normals_disk(); ltc_disk(); gaussians_disk(); ltc_lookup(); ltc_log(); }\n";
        for language in TEXTS {
            if let Err(error) = printed(language, &damaged, "main", Form::Include) {
                prop_assert!(error.starts_with("line "), "{error}");
            }
        }
        let _ = folded(&damaged, "ltc_hardware_filter", keeps);
    }
}
