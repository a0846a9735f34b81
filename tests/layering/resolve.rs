//! What a path stands for: the item that it names, whatever re-exports lie between.

use std::{
    collections::BTreeMap,
    path::{Path, PathBuf},
};

use crate::tree::{Name, Tree};

/// What a path stands for.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub(crate) enum Target {
    /// A module of the crate.
    Module(usize),
    /// An item of a module, and the names after it, such as a type's function.
    Item { module: usize, name: String, rest: Vec<String> },
    /// Something of another crate, a variable, or a parameter of a type.
    Outside(Vec<String>),
}

/// A `use` may stand for another `use`, but not for ever.
const MOST_STEPS: u32 = 32;

impl Tree {
    /// The crate's path that a path means where `from` names it: `crate`, `super`, `self`, children and imported names
    /// are spelled out; re-exports elsewhere are not followed. `Err` is a path of another crate.
    pub(crate) fn spelled_out(&self, from: usize, path: &[String]) -> Result<Vec<String>, Vec<String>> {
        self.spell_out(from, path, MOST_STEPS)
    }

    fn spell_out(&self, from: usize, path: &[String], steps: u32) -> Result<Vec<String>, Vec<String>> {
        let outside = || Err(path.to_vec());
        let below = |module: usize, rest: &[String]| {
            Ok(self.modules[module].path.iter().chain(rest).cloned().collect::<Vec<_>>())
        };
        if let Some((module, rest)) = self.anchored(from, path) {
            return below(module, rest);
        }
        let (Some(steps), Some((first, rest))) = (steps.checked_sub(1), path.split_first()) else { return outside() };
        if let Some(names) = self.modules[from].names.get(first) {
            return match names.iter().find(|name| !matches!(name, Name::Item)) {
                Some(Name::Module(child)) => below(*child, rest),
                Some(Name::Use(import)) if import != path => {
                    let whole: Vec<String> = import.iter().chain(rest).cloned().collect();
                    self.spell_out(from, &whole, steps)
                }
                Some(_) => outside(),
                None => below(from, path),
            };
        }
        for glob in self.own_globs(from) {
            for target in self.resolve_in(from, glob, steps) {
                let Target::Module(module) = target else { continue };
                if let Ok(found) = self.spell_out(module, path, steps) {
                    return Ok(found);
                }
            }
        }
        outside()
    }

    /// What a path stands for where `from` names it. Empty when the crate has no such thing.
    pub(crate) fn resolve(&self, from: usize, path: &[String]) -> Vec<Target> {
        self.resolve_in(from, path, MOST_STEPS)
    }

    fn resolve_in(&self, from: usize, path: &[String], steps: u32) -> Vec<Target> {
        let Some(steps) = steps.checked_sub(1) else { return Vec::new() };
        if let Some((module, rest)) = self.anchored(from, path) {
            return self.walk(module, rest, steps);
        }
        if self.modules[from].names.contains_key(&path[0]) {
            return self.walk(from, path, steps);
        }
        let found = self.walk_globs(from, path, steps);
        if found.is_empty() { vec![Target::Outside(path.to_vec())] } else { found }
    }

    /// What `path` stands for below a module.
    fn walk(&self, module: usize, path: &[String], steps: u32) -> Vec<Target> {
        let Some((first, rest)) = path.split_first() else { return vec![Target::Module(module)] };
        let (mut modules, mut items) = (Vec::new(), Vec::new());
        for name in self.modules[module].names.get(first).into_iter().flatten() {
            match name {
                Name::Module(child) => modules.extend(self.walk(*child, rest, steps)),
                Name::Item => items.push(Target::Item { module, name: first.clone(), rest: rest.to_vec() }),
                // `use thing;` of another crate's `thing` stands for no name of this module.
                Name::Use(import) if import.as_slice() == [first.clone()] => {
                    items.push(Target::Outside(path.to_vec()));
                }
                Name::Use(import) => {
                    let whole: Vec<String> = import.iter().chain(rest).cloned().collect();
                    items.extend(self.resolve_in(module, &whole, steps));
                }
            }
        }
        // In the middle of a path stands a module where there is one, at its end the item of the same name.
        let found = if rest.is_empty() {
            if items.is_empty() { modules } else { items }
        } else if modules.is_empty() {
            items
        } else {
            modules
        };
        if !found.is_empty() {
            return found;
        }
        let found = self.walk_globs(module, path, steps);
        if found.is_empty() && self.modules[module].has_macros {
            return vec![Target::Item { module, name: first.clone(), rest: rest.to_vec() }];
        }
        found
    }

    fn walk_globs(&self, module: usize, path: &[String], steps: u32) -> Vec<Target> {
        let mut others = Vec::new();
        for glob in self.own_globs(module) {
            let targets = self.resolve_in(module, glob, steps);
            others.extend(targets.into_iter().filter_map(|target| match target {
                Target::Module(other) if other != module => Some(other),
                _ => None,
            }));
        }
        let known = |other: &usize| self.modules[*other].names.contains_key(&path[0]);
        others.into_iter().filter(known).flat_map(|other| self.walk(other, path, steps)).collect()
    }

    /// The globs of a module that begin in the crate. One of another crate's names would be looked for in all globs, and so
    /// in itself: with two of them, that takes a time that doubles with each step.
    fn own_globs(&self, module: usize) -> impl Iterator<Item = &Vec<String>> {
        let begins_here = move |glob: &&Vec<String>| {
            let is_known = glob.first().is_some_and(|first| self.modules[module].names.contains_key(first));
            is_known || self.anchored(module, glob).is_some()
        };
        self.modules[module].globs.iter().filter(begins_here)
    }

    /// The module where a path with `crate`, `self` or `super` begins, and what follows.
    fn anchored<'p>(&self, from: usize, path: &'p [String]) -> Option<(usize, &'p [String])> {
        let (mut module, mut rest) = match path.first()?.as_str() {
            "crate" => (0, &path[1..]),
            "self" => (from, &path[1..]),
            "super" => (from, path),
            _ => return None,
        };
        while rest.first().is_some_and(|name| name == "super") {
            module = self.modules[module].parent?;
            rest = &rest[1..];
        }
        Some((module, rest))
    }

    /// Where the functions and constants of each type are written: its `impl` blocks may lie in other files.
    pub(crate) fn members(&self) -> BTreeMap<(usize, String, String), PathBuf> {
        let mut members = BTreeMap::new();
        for (index, module) in self.modules.iter().enumerate().filter(|(_, module)| !module.is_test) {
            for (owner, member) in &module.members {
                for target in self.resolve(index, owner) {
                    if let Target::Item { module: owner, name, .. } = target {
                        members.insert((owner, name, member.clone()), module.file.clone());
                    }
                }
            }
        }
        members
    }

    /// The file of a module.
    pub(crate) fn file(&self, module: usize) -> &Path {
        &self.modules[module].file
    }
}
