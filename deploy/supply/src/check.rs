//! Which crates are not allowed, and which have a known hole.

use cargo_metadata::{Metadata, Package};
use rustsec::{
    Database, Lockfile,
    advisory::Informational,
    report::{Report, Settings},
};
use spdx::Expression;

use super::policy::Policy;

/// Crates of licences and places that `policy` does not allow, a sentence each.
pub(crate) fn licences_and_sources(metadata: &Metadata, policy: &Policy) -> Vec<String> {
    let faults = |package: &Package| [licence_fault(package, policy), source_fault(package, policy)];
    metadata.packages.iter().flat_map(faults).flatten().collect()
}

fn licence_fault(package: &Package, policy: &Policy) -> Option<String> {
    let who = format!("{} {}", package.name, package.version);
    let Some(text) = &package.license else {
        // Programs of this project that nobody else gets.
        let is_ours = package.source.is_none() && package.publish.as_ref().is_some_and(Vec::is_empty);
        return (!is_ours).then(|| format!("{who} names no licence"));
    };
    // Old crates have a slash for «or».
    let expression = match Expression::parse(&text.replace('/', " OR ")) {
        Ok(expression) => expression,
        Err(error) => return Some(format!("{who} has the licence «{text}», which cannot be read: {}", error.reason)),
    };
    let is_allowed = expression.evaluate(|asked| policy.licences.iter().any(|licence| licence.satisfies(asked)));
    (!is_allowed).then(|| format!("{who} has the licence «{text}», which deny.toml does not allow"))
}

fn source_fault(package: &Package, policy: &Policy) -> Option<String> {
    let source = &package.source.as_ref()?.repr;
    let is_allowed = source
        .strip_prefix("registry+")
        .is_some_and(|registry| policy.registries.iter().any(|allowed| allowed == registry));
    (!is_allowed)
        .then(|| format!("{} {} is from {source}, which deny.toml does not allow", package.name, package.version))
}

/// Crates of `lockfile` with an advisory, a sentence each.
pub(crate) fn advisories(database: &Database, lockfile: &Lockfile, policy: &Policy) -> Vec<String> {
    let settings = Settings {
        ignore: policy.ignored.clone(),
        informational_warnings: vec![Informational::Unmaintained, Informational::Unsound, Informational::Notice],
        ..Settings::default()
    };
    let report = Report::generate(database, lockfile, &settings);
    let holes = report.vulnerabilities.list.iter().map(|hole| (&hole.package, Some(&hole.advisory)));
    let warnings = report.warnings.values().flatten();
    let warnings = warnings.map(|warning| (&warning.package, warning.advisory.as_ref()));
    let told = holes.chain(warnings).map(|(package, advisory)| {
        let told = advisory.map(|advisory| format!("{}: {}", advisory.id, advisory.title));
        format!("{} {}: {}", package.name, package.version, told.unwrap_or_default())
    });
    told.collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const POLICY: &str = "
        [licenses]
        allow = ['MIT']
        [sources]
        allow-registry = ['https://github.com/rust-lang/crates.io-index']
        [advisories]
        ignore = []";

    #[test]
    fn licences_and_places_that_are_not_allowed_are_told() {
        let policy = POLICY.parse().unwrap();
        let mut metadata = crate::metadata(None).unwrap();
        metadata.packages.retain(|package| ["tokio", "png", "ring"].contains(&package.name.as_str()));
        metadata.packages.iter_mut().filter(|package| *package.name == "png").for_each(|package| {
            package.source = Some(cargo_metadata::Source { repr: "git+https://elsewhere.example".to_owned() });
        });
        let mut faults = licences_and_sources(&metadata, &policy);
        faults.sort();
        assert_eq!(faults.len(), 2, "{faults:#?}");
        assert!(faults[0].starts_with("png ") && faults[0].contains("elsewhere.example"), "{faults:#?}");
        assert!(faults[1].starts_with("ring ") && faults[1].contains("Apache-2.0 AND ISC"), "{faults:#?}");
    }

    #[test]
    fn a_crate_with_a_known_hole_is_told_unless_somebody_has_looked_at_it() {
        let database = Database::open(&crate::advisories()).unwrap();
        let lock = "version = 4\n[[package]]\nname = \"tokio\"\nversion = \"1.38.0\"\n\
            source = \"registry+https://github.com/rust-lang/crates.io-index\"\n";
        let lockfile = lock.parse().unwrap();
        let policy: Policy = POLICY.parse().unwrap();
        let faults = advisories(&database, &lockfile, &policy);
        assert!(matches!(&faults[..], [fault] if fault.starts_with("tokio 1.38.0: RUSTSEC-2025-0023")), "{faults:?}");
        let ignoring = POLICY.replace("ignore = []", "ignore = [{ id = 'RUSTSEC-2025-0023', reason = 'of a test' }]");
        assert!(advisories(&database, &lockfile, &ignoring.parse().unwrap()).is_empty());
        let without_reason = ignoring.replace(", reason = 'of a test'", "");
        assert!(without_reason.parse::<Policy>().unwrap_err().to_string().contains("reason"));
    }
}
