//! The list of crates that go into the program, as a `CycloneDX` document.
//!
//! Source: `CycloneDX` 1.5, <https://cyclonedx.org/docs/1.5/json/>. It has neither a time nor a number of its own, so that equal
//! programs have equal lists.

use std::{collections::BTreeMap, error::Error};

use cargo_metadata::{DependencyKind, Metadata, Node, Package, PackageId};
use rustsec::Lockfile;
use serde_json::{Value, json};

/// The program's crate.
const PROGRAM: &str = "ltcforge";

/// The document for the program; `lockfile` has the hashes of the crates' archives.
pub(crate) fn document(metadata: &Metadata, lockfile: &Lockfile) -> Result<Value, Box<dyn Error>> {
    let nodes = metadata.resolve.as_ref().map(|resolve| resolve.nodes.as_slice()).unwrap_or_default();
    let nodes: BTreeMap<&PackageId, &Node> = nodes.iter().map(|node| (&node.id, node)).collect();
    let packages: BTreeMap<&PackageId, &Package> =
        metadata.packages.iter().map(|package| (&package.id, package)).collect();
    let program = metadata.packages.iter().find(|package| *package.name == PROGRAM);
    let program = program.ok_or("there is no crate of the program's name")?;
    let (mut linked, mut next) = (BTreeMap::new(), vec![&program.id]);
    while let Some(id) = next.pop() {
        if !linked.contains_key(id) {
            let into = linked_into(nodes.get(id).copied());
            next.extend(&into);
            linked.insert(id, into);
        }
    }
    let package = |id: &PackageId| packages.get(id).copied().ok_or("a dependency has no package");
    let components = linked.keys().filter(|id| **id != &program.id);
    let components = components.map(|id| Ok(component(package(id)?, "library", lockfile)));
    let dependencies = linked.iter().map(|(id, into)| {
        let on: Result<Vec<String>, &str> = into.iter().map(|id| Ok(purl(package(id)?))).collect();
        Ok(json!({ "ref": purl(package(id)?), "dependsOn": on? }))
    });
    Ok(json!({
        "bomFormat": "CycloneDX",
        "specVersion": "1.5",
        "version": 1,
        "metadata": { "component": component(program, "application", lockfile) },
        "components": components.collect::<Result<Vec<Value>, &str>>()?,
        "dependencies": dependencies.collect::<Result<Vec<Value>, &str>>()?,
    }))
}

/// The crates that are linked with a crate; not those that only its build or its tests run.
fn linked_into(node: Option<&Node>) -> Vec<&PackageId> {
    let dependencies = node.into_iter().flat_map(|node| &node.deps);
    let is_linked = |kind: &cargo_metadata::DepKindInfo| kind.kind == DependencyKind::Normal;
    dependencies
        .filter(|dependency| dependency.dep_kinds.iter().any(is_linked))
        .map(|dependency| &dependency.pkg)
        .collect()
}

fn purl(package: &Package) -> String {
    format!("pkg:cargo/{}@{}", package.name, package.version.to_string().replace('+', "%2B"))
}

fn component(package: &Package, kind: &str, lockfile: &Lockfile) -> Value {
    let locked = lockfile
        .packages
        .iter()
        .find(|locked| locked.name.as_str() == *package.name && locked.version == package.version);
    let hash = locked.and_then(|locked| locked.checksum.as_ref()).map(ToString::to_string);
    let mut component = json!({
        "type": kind,
        "bom-ref": purl(package),
        "name": *package.name,
        "version": package.version.to_string(),
        "purl": purl(package),
    });
    if let Some(licence) = &package.license {
        component["licenses"] = json!([{ "expression": licence.replace('/', " OR ") }]);
    }
    if let Some(hash) = hash {
        component["hashes"] = json!([{ "alg": "SHA-256", "content": hash }]);
    }
    component
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_program_s_crates_are_listed_with_licences_and_hashes_and_no_others() {
        let metadata = crate::metadata(Some("x86_64-unknown-linux-gnu")).unwrap();
        let document = document(&metadata, &crate::lockfile().unwrap()).unwrap();
        assert_eq!(document["metadata"]["component"]["name"], PROGRAM);
        let components = document["components"].as_array().unwrap();
        let named = |name: &str| components.iter().find(|component| component["name"] == name);
        let tokio = named("tokio").expect("it is linked");
        assert_eq!(tokio["licenses"][0]["expression"], "MIT");
        assert_eq!(tokio["hashes"][0]["content"].as_str().map(str::len), Some(64));
        assert!(named("ltcforge-fit").is_some());
        for other in ["proptest", "windows-sys", "ltcforge-studies", "rustsec"] {
            assert!(named(other).is_none(), "{other} is not in the program");
        }
        let dependencies = document["dependencies"].as_array().unwrap();
        assert_eq!(dependencies.len(), components.len() + 1);
        let known = |purl: &Value| dependencies.iter().any(|dependency| dependency["ref"] == *purl);
        assert!(dependencies.iter().flat_map(|d| d["dependsOn"].as_array().unwrap()).all(known));
    }
}
