//! Files that use each other in a circle.

use std::{
    collections::{BTreeMap, BTreeSet, VecDeque},
    fmt::Write as _,
    path::PathBuf,
};

use crate::{resolve::Target, tree::Tree, uses::Named};

/// A file that uses another.
pub(crate) type Edge = (PathBuf, PathBuf);

/// Which items each file uses of which other.
#[derive(Debug, Default)]
pub(crate) struct Graph(pub(crate) BTreeMap<PathBuf, BTreeMap<PathBuf, BTreeSet<String>>>);

impl Graph {
    /// What the code of `tree` uses, without its tests: an edge goes to the file that defines the item, and an item
    /// that is only handed on is not used.
    pub(crate) fn of(tree: &Tree) -> Self {
        let members = tree.members();
        let mut graph = Self::default();
        for (index, module) in tree.modules.iter().enumerate() {
            let used = module.uses.paths.iter().filter(|named| !named.is_test && !named.is_handed_on);
            for Named { path, .. } in used {
                for target in tree.resolve(index, path) {
                    let Target::Item { module: owner, name, rest } = target else { continue };
                    let member = rest.first().and_then(|member| {
                        let file = members.get(&(owner, name.clone(), member.clone()))?;
                        Some((file.clone(), format!("{name}::{member}")))
                    });
                    let defined = (tree.file(owner).to_owned(), name.clone());
                    for (file, item) in [defined].into_iter().chain(member) {
                        if file != module.file {
                            let edges = graph.0.entry(module.file.clone()).or_default();
                            edges.entry(file).or_default().insert(item);
                        }
                    }
                }
            }
        }
        graph
    }

    pub(crate) fn edges(&self) -> usize {
        self.0.values().map(BTreeMap::len).sum()
    }

    /// The edges that lie on a circle, each with the shortest circle that it is part of.
    pub(crate) fn circles(&self) -> BTreeMap<Edge, Vec<PathBuf>> {
        let edges = self.0.iter().flat_map(|(from, to)| to.keys().map(move |to| (from, to)));
        edges.filter_map(|(from, to)| Some(((from.clone(), to.clone()), self.path(to, from)?))).collect()
    }

    /// A shortest way from one file to another.
    fn path(&self, from: &PathBuf, to: &PathBuf) -> Option<Vec<PathBuf>> {
        let mut before: BTreeMap<&PathBuf, &PathBuf> = BTreeMap::new();
        let mut queue = VecDeque::from([from]);
        while let Some(file) = queue.pop_front() {
            if file == to {
                let back = std::iter::successors(Some(file), |file| before.get(*file).copied());
                let mut path: Vec<PathBuf> = back.cloned().collect();
                path.reverse();
                return Some(path);
            }
            for next in self.0.get(file).into_iter().flat_map(BTreeMap::keys) {
                if next != from && !before.contains_key(next) {
                    before.insert(next, file);
                    queue.push_back(next);
                }
            }
        }
        None
    }

    /// A circle with the items that make it, the same wherever on it one begins.
    pub(crate) fn told(&self, circle: &[PathBuf]) -> String {
        let mut out = String::new();
        let mut circle = circle.to_vec();
        let least = circle.iter().enumerate().min_by_key(|(_, file)| *file).map_or(0, |(index, _)| index);
        circle.rotate_left(least);
        for (index, from) in circle.iter().enumerate() {
            let to = &circle[(index + 1) % circle.len()];
            let items = self.0.get(from).and_then(|edges| edges.get(to));
            let items: Vec<&str> = items.into_iter().flatten().map(String::as_str).collect();
            // Writing to a String cannot fail.
            let _ = writeln!(out, "  {} uses {} of {}", from.display(), items.join(", "), to.display());
        }
        out
    }
}
