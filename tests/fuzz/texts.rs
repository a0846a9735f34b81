//! Short texts: tokens, descriptions of materials, parameters of pictures, and documents from a service.

use ltcforge::{
    client::{JobDocument, ServerTokens},
    light::materials::AnisotropicRoughness,
    server::http::Tokens,
    view::{
        parameters::ParameterFault,
        plots::ErrorSlice,
        preview::{Choices, PARAMETERS},
    },
};

use super::target::Target;

/// A reader of bytes, made from a reader of text.
fn of_text(read: impl Fn(&str) -> String) -> impl Fn(&[u8]) -> String {
    move |bytes| std::str::from_utf8(bytes).map_or_else(|_| "not UTF-8".to_owned(), &read)
}

#[test]
fn token_files() {
    let hash = ltcforge::Digest::of(b"a");
    let seeds = vec![
        format!("# farm\nfarm submit sha256:{hash}\n\nboss admin sha256:{hash}\n").into_bytes(),
        format!("a read sha256:{hash}\nb submit sha256:{hash}").into_bytes(),
    ];
    let words = ["\n", " ", "#", "read", "submit", "admin", "sha256:", "team="];
    Target { name: "tokens", seeds, words: &words, inputs: 3000 }.survive(of_text(|text| {
        match Tokens::of(&[("tokens", text)]) {
            Ok(tokens) => format!("tokens: {}", !tokens.is_empty()),
            Err(faults) => faults,
        }
    }));
}

#[test]
fn tokens_of_clients() {
    let seeds = vec![
        b"https://farm.example ltcforge_0123".to_vec(),
        b"http://10.0.0.5:8317/x/ abc;http://[::1]:8317 d-._~+/=".to_vec(),
    ];
    let words = [";", " ", "http://", "https://", ":", "/", "@", "[", "]", "%", "?", "#"];
    Target { name: "server_tokens", seeds, words: &words, inputs: 3000 }.survive(of_text(|text| {
        match text.parse::<ServerTokens>() {
            Ok(_) => "tokens".to_owned(),
            // The URL is removed.
            Err(error) => error.to_string().rsplit(": ").next().unwrap_or_default().to_owned(),
        }
    }));
}

#[test]
fn materials() {
    let seeds = vec![
        b"openpbr:specular_roughness=0.3,specular_roughness_anisotropy=0.5".to_vec(),
        b"gltf: roughnessFactor = 0.2 , anisotropyStrength=1, anisotropyRotation=2".to_vec(),
        b"disney".to_vec(),
    ];
    let words = [":", ",", "=", "materialx", "hdrp", "disney", "roughness", "anisotropy", "specular_roughness"];
    Target { name: "material", seeds, words: &words, inputs: 3000 }.survive(of_text(|text| {
        match AnisotropicRoughness::parse(text) {
            Ok(roughness) => {
                let [x, y] = [roughness.alpha_x, roughness.alpha_y];
                assert!(x.is_finite() && y.is_finite() && roughness.rotation.is_finite());
                "a material".to_owned()
            }
            Err(faults) => faults.to_string(),
        }
    }));
}

#[test]
fn parameters_of_pictures() {
    let seeds = vec![
        b"size=64&spp=1&mode=ltc&alpha_x=0.5&alpha_y=0.1&light_centre=1,2,3".to_vec(),
        b"scene=wall&material=gltf:roughnessFactor=0.2&light=disk&two_sided=true&camera=0,0,1".to_vec(),
        b"ratio=0.5&phi=0.3".to_vec(),
    ];
    let words: Vec<&str> = ["&", "=", ",", "true"].into_iter().chain(parameters()).collect();
    Target { name: "parameters", seeds, words: &words, inputs: 3000 }.survive(of_text(|text| {
        let pairs: Vec<(&str, &str)> = text.split('&').map(|pair| pair.split_once('=').unwrap_or((pair, ""))).collect();
        let lines = |faults: Vec<ParameterFault>| {
            let name = |fault: &ParameterFault| parameters().find(|name| *name == fault.parameter).unwrap_or("unknown");
            faults.iter().map(|fault| format!("{} {}", name(fault), fault.detail)).collect::<Vec<_>>().join("\n")
        };
        let scene = Choices::read(pairs.iter().copied()).map_or_else(lines, |_| "a scene".to_owned());
        let slice = ErrorSlice::from_pairs(pairs).map_or_else(lines, |_| "a slice".to_owned());
        format!("{scene}\n{slice}")
    }));
}

fn parameters() -> impl Iterator<Item = &'static str> {
    PARAMETERS.iter().map(|parameter| parameter.name)
}

#[test]
fn documents_of_jobs() {
    let failed = br#"{"id": "5f70bf18a086007016e948b04aed3b82", "state": "failed", "attempts": 1, "table": null,
        "progress": {"entries_done": 1, "entries_total": 4, "seconds_left": 0.5},
        "error": {"type": "/problems/disk-full", "detail": "no room", "status": 507}}"#;
    let words = ["\"state\":", "\"done\"", "\"table\":", "\"progress\":", "null", "{", "}", "[", ","];
    Target { name: "job", seeds: vec![failed.to_vec()], words: &words, inputs: 3000 }.survive(|bytes| {
        match serde_json::from_slice(bytes).and_then(JobDocument::parse) {
            Ok(job) => format!("a job: {:?}", job.status.state),
            Err(error) => error.to_string(),
        }
    });
}
