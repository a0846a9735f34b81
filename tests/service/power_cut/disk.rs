//! The possible contents of a disk after a service has ended.
//!
//! After a kill, the disk has all changes of the service. After a power cut, it has all synchronised changes. Every
//! other write is there completely, partly or not at all, in any order. Of the changes to the names in a folder, only
//! the first ones are there, as in journalling file systems, independently for each folder. POSIX allows this, and
//! crash-consistency checkers assume it: Pillai et al., «All File Systems Are Not Created Equal», OSDI 2014.

use std::{collections::BTreeMap, fs, path::Path};

use super::trace::{Change, Event, Inode, ROOT, Trace};
use crate::common::soak::Random;

/// How the service ends.
pub(super) enum End<'a> {
    /// A kill: the system keeps running and keeps all changes.
    Kill,
    /// A power cut: the surviving changes are random.
    PowerCut(&'a mut Random),
}

impl End<'_> {
    /// The number of surviving changes, out of `changes` that are not synchronised.
    fn kept(&mut self, changes: usize) -> usize {
        match self {
            Self::Kill => changes,
            Self::PowerCut(random) => random.below(changes + 1),
        }
    }

    /// The number of surviving bytes of a write that is not synchronised.
    fn torn(&mut self, bytes: usize) -> usize {
        match self {
            Self::Kill => bytes,
            Self::PowerCut(random) => [bytes, bytes, 0, random.below(bytes + 1)][random.below(4)],
        }
    }
}

/// Writes possible contents of the disk to `to`. The service ends before line `cut` of the trace.
pub(super) fn after(mut end: End<'_>, trace: &Trace, cut: usize, to: &Path) {
    let begun: Vec<&Event> = trace.events.iter().filter(|event| event.began < cut).collect();
    let is_safe = |event: &Event, of: Inode| {
        let synced = |later: &&&Event| {
            matches!(later.change, Change::Sync { of: synced } if synced == of)
                && event.ended < later.began
                && later.ended < cut
        };
        begun.iter().any(|later| synced(&later))
    };
    let mut contents: BTreeMap<Inode, Vec<u8>> = BTreeMap::new();
    let mut names: BTreeMap<Inode, BTreeMap<&str, Inode>> = BTreeMap::new();
    // The number of surviving changes to the names in each folder.
    let mut kept: BTreeMap<Inode, usize> = BTreeMap::new();
    for folder in (0..trace.folders.len()).filter(|inode| trace.folders[*inode]) {
        let of_folder: Vec<&&Event> = begun.iter().filter(|event| folder_of(event) == Some(folder)).collect();
        let safe = of_folder.iter().rposition(|event| is_safe(event, folder)).map_or(0, |last| last + 1);
        kept.insert(folder, safe + end.kept(of_folder.len() - safe));
    }
    for event in &begun {
        match &event.change {
            Change::Write { file, at, bytes } => {
                let torn = if is_safe(event, *file) { bytes.len() } else { end.torn(bytes.len()) };
                if torn > 0 {
                    let content = contents.entry(*file).or_default();
                    content.resize(content.len().max(at + torn), 0);
                    content[*at..at + torn].copy_from_slice(&bytes[..torn]);
                }
            }
            Change::Truncate { file, length } => {
                if is_safe(event, *file) || end.kept(1) == 1 {
                    contents.entry(*file).or_default().resize(*length, 0);
                }
            }
            Change::Sync { .. } | Change::Sent { .. } => {}
            Change::Link { folder, .. } | Change::Unlink { folder, .. } | Change::Rename { folder, .. } => {
                let left = kept.get_mut(folder).expect("a folder");
                if *left > 0 {
                    *left -= 1;
                    rename(names.entry(*folder).or_default(), &event.change);
                }
            }
        }
    }
    write(ROOT, to, trace, &names, &contents);
}

fn folder_of(event: &Event) -> Option<Inode> {
    match event.change {
        Change::Link { folder, .. } | Change::Unlink { folder, .. } | Change::Rename { folder, .. } => Some(folder),
        _ => None,
    }
}

fn rename<'a>(names: &mut BTreeMap<&'a str, Inode>, change: &'a Change) {
    match change {
        Change::Link { name, to, .. } => drop(names.insert(name, *to)),
        Change::Unlink { name, .. } => drop(names.remove(name.as_str())),
        Change::Rename { from, name, to, .. } => {
            names.remove(from.as_str());
            names.insert(name, *to);
        }
        _ => {}
    }
}

fn write(
    folder: Inode,
    to: &Path,
    trace: &Trace,
    names: &BTreeMap<Inode, BTreeMap<&str, Inode>>,
    contents: &BTreeMap<Inode, Vec<u8>>,
) {
    fs::create_dir_all(to).expect("a folder");
    for (name, inode) in names.get(&folder).into_iter().flatten() {
        let path = to.join(name);
        if trace.folders[*inode] {
            write(*inode, &path, trace, names, contents);
        } else {
            fs::write(path, contents.get(inode).map(Vec::as_slice).unwrap_or_default()).expect("a file");
        }
    }
}
