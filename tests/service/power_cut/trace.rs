//! Reads the output of `strace`: the changes of a process to files below a folder, and the bytes that it sends.

use std::{
    collections::HashMap,
    path::{Path, PathBuf},
};

/// The system calls that change files, and calls that are needed to follow them. The test fails if a call changes a
/// file in a way that [`Recorder`] does not know.
pub(super) const CALLS: &str = "open,openat,creat,close,dup,dup2,dup3,write,writev,pwrite64,pwritev,pwritev2,truncate,ftruncate,\
    fallocate,copy_file_range,sendfile,fsync,fdatasync,syncfs,rename,renameat,renameat2,link,linkat,symlink,symlinkat,unlink,\
    unlinkat,mkdir,mkdirat,rmdir,sendto,sendmsg,socket,accept,accept4,io_uring_setup";

/// A file or a folder.
pub(super) type Inode = usize;

/// The folder of relative paths in calls without an open folder.
const CWD: &str = "AT_FDCWD";

/// The traced folder.
pub(super) const ROOT: Inode = 0;

#[derive(Debug, Clone)]
pub(super) enum Change {
    /// Bytes are written at an offset of a file.
    Write { file: Inode, at: usize, bytes: Vec<u8> },
    /// The length of a file changes.
    Truncate { file: Inode, length: usize },
    /// A name is added to a folder. It replaces an existing entry with this name.
    Link { folder: Inode, name: String, to: Inode },
    /// A name is removed.
    Unlink { folder: Inode, name: String },
    /// A name is atomically replaced by another name in the same folder.
    Rename { folder: Inode, from: String, name: String, to: Inode },
    /// All changes of a file, or of the names in a folder, are written to the disk.
    Sync { of: Inode },
    /// Bytes are sent to a client.
    Sent { bytes: Vec<u8> },
}

/// A change, with the lines of the trace where its call starts and ends.
#[derive(Debug)]
pub(super) struct Event {
    pub(super) began: usize,
    pub(super) ended: usize,
    pub(super) change: Change,
}

/// All changes, and a flag for each inode that is a folder.
#[derive(Debug)]
pub(super) struct Trace {
    pub(super) events: Vec<Event>,
    pub(super) folders: Vec<bool>,
    pub(super) lines: usize,
}

#[derive(Debug, Clone, Copy)]
struct Opened {
    inode: Inode,
    appends: bool,
    position: usize,
}

struct Recorder<'a> {
    root: &'a Path,
    events: Vec<Event>,
    /// Whether each inode is a folder.
    folders: Vec<bool>,
    lengths: Vec<usize>,
    names: HashMap<PathBuf, Inode>,
    descriptors: HashMap<i64, Opened>,
}

/// A system call, with its arguments as in the trace and its return value.
struct Call<'a> {
    name: &'a str,
    arguments: Vec<&'a str>,
    returned: i64,
    span: (usize, usize),
}

/// Reads the trace of a process and all its threads.
pub(super) fn read(text: &str, root: &Path) -> Trace {
    let names = HashMap::from([(root.to_owned(), ROOT)]);
    let mut recorder =
        Recorder { root, events: vec![], folders: vec![true], lengths: vec![0], names, descriptors: HashMap::new() };
    let mut unfinished: HashMap<&str, (usize, &str)> = HashMap::new();
    for (at, line) in text.lines().enumerate() {
        let (thread, rest) = line.split_once(' ').expect("a thread");
        let rest = rest.trim_start();
        if rest.starts_with("+++") || rest.starts_with("---") {
            continue;
        }
        if let Some(begun) = rest.strip_suffix("<unfinished ...>") {
            unfinished.insert(thread, (at, begun));
            continue;
        }
        let resumed = rest.strip_prefix("<... ").and_then(|rest| rest.split_once(" resumed>"));
        let (began, whole) = match resumed {
            Some((_, end)) => {
                let (began, begun) = unfinished.remove(thread).expect("a call that began");
                (began, format!("{begun}{end}"))
            }
            None => (at, rest.to_owned()),
        };
        if let Some(call) = call(&whole, (began, at)) {
            recorder.record(&call);
        }
    }
    let Recorder { mut events, folders, .. } = recorder;
    events.sort_by_key(|event| event.began);
    Trace { events, folders, lines: text.lines().count() }
}

/// Parses a successful call.
fn call(text: &str, span: (usize, usize)) -> Option<Call<'_>> {
    let (name, rest) = text.split_once('(')?;
    // Texts are in hexadecimal, so arguments contain no parentheses and commas.
    let (arguments, returned) = rest.rsplit_once(") ")?;
    let returned = returned.trim_start().strip_prefix("= ")?.split_whitespace().next()?.parse().ok()?;
    let call = Call { name, arguments: arguments.split(", ").map(str::trim).collect(), returned, span };
    (0 <= returned).then_some(call)
}

/// The bytes of a text such as `"\x61\x62"` in an argument.
fn bytes(argument: &str) -> Vec<u8> {
    let quoted = argument.split('"').nth(1).unwrap_or_default();
    assert!(argument.matches("...").count() == 0, "a text was cut short: {argument}");
    let digits = quoted.split("\\x").skip(1);
    digits.map(|digits| u8::from_str_radix(digits, 16).expect("two hexadecimal digits")).collect()
}

impl Recorder<'_> {
    fn record(&mut self, call: &Call<'_>) {
        let Call { name, arguments, returned, .. } = call;
        let descriptor = || arguments[0].parse::<i64>().expect("a descriptor");
        match *name {
            "openat" => self.open(call),
            "close" => drop(self.descriptors.remove(&descriptor())),
            "socket" | "accept" | "accept4" => drop(self.descriptors.remove(returned)),
            "write" | "writev" | "pwrite64" | "pwritev" | "pwritev2" | "sendto" | "sendmsg" => {
                self.write(call, descriptor());
            }
            "ftruncate" => {
                if let Some(Opened { inode, .. }) = self.descriptors.get(&descriptor()).copied() {
                    let length = arguments[1].parse().expect("a length");
                    self.lengths[inode] = length;
                    self.add(call, Change::Truncate { file: inode, length });
                }
            }
            "fsync" | "fdatasync" => {
                if let Some(Opened { inode, .. }) = self.descriptors.get(&descriptor()).copied() {
                    self.add(call, Change::Sync { of: inode });
                }
            }
            "mkdir" => {
                if let Some((path, folder, name)) = self.place(CWD, arguments[0]) {
                    let to = self.new_inode(path, true);
                    self.add(call, Change::Link { folder, name, to });
                }
            }
            "rename" => self.rename(call, [CWD, arguments[0]], [CWD, arguments[1]]),
            "renameat" | "renameat2" => self.rename(call, [arguments[0], arguments[1]], [arguments[2], arguments[3]]),
            "unlink" | "rmdir" => self.unlink(call, CWD, arguments[0]),
            "unlinkat" => self.unlink(call, arguments[0], arguments[1]),
            _ => {
                let is_ours = |argument: &&str| {
                    self.place(CWD, argument).is_some()
                        || argument.parse().is_ok_and(|number: i64| self.descriptors.contains_key(&number))
                };
                assert!(
                    !arguments.iter().any(is_ours),
                    "the trace has a call that this test does not know: {name}{arguments:?}"
                );
            }
        }
    }

    fn add(&mut self, call: &Call<'_>, change: Change) {
        self.events.push(Event { began: call.span.0, ended: call.span.1, change });
    }

    /// If the path in an argument is below the root: the path, the inode of its folder, and its name.
    fn place(&self, open: &str, argument: &str) -> Option<(PathBuf, Inode, String)> {
        let path = self.path(open, argument)?;
        let (folder, name) = (self.names.get(path.parent()?)?, path.file_name()?.to_str()?.to_owned());
        path.starts_with(self.root).then_some((path.clone(), *folder, name))
    }

    /// The path of a call's argument. A relative path is in the open folder `open`.
    fn path(&self, open: &str, argument: &str) -> Option<PathBuf> {
        let path = PathBuf::from(String::from_utf8(bytes_of_path(argument)?).ok()?);
        if path.is_absolute() {
            return Some(path);
        }
        let folder = self.descriptors.get(&open.parse().ok()?)?.inode;
        let (folder, _) = self.names.iter().find(|(_, inode)| **inode == folder)?;
        Some(folder.join(path))
    }

    fn new_inode(&mut self, path: PathBuf, is_folder: bool) -> Inode {
        self.folders.push(is_folder);
        self.lengths.push(0);
        self.names.insert(path, self.folders.len() - 1);
        self.folders.len() - 1
    }

    fn open(&mut self, call: &Call<'_>) {
        let (open, path, flags) = (call.arguments[0], call.arguments[1], call.arguments[2]);
        self.descriptors.remove(&call.returned);
        let known = self.path(open, path).and_then(|path| self.names.get(&path).copied());
        let inode = match (known, self.place(open, path)) {
            (Some(inode), _) => inode,
            (None, Some((path, folder, name))) if flags.contains("O_CREAT") => {
                let to = self.new_inode(path, false);
                self.add(call, Change::Link { folder, name, to });
                to
            }
            _ => return,
        };
        if flags.contains("O_TRUNC") {
            self.lengths[inode] = 0;
            self.add(call, Change::Truncate { file: inode, length: 0 });
        }
        let appends = flags.contains("O_APPEND");
        self.descriptors.insert(call.returned, Opened { inode, appends, position: 0 });
    }

    fn write(&mut self, call: &Call<'_>, descriptor: i64) {
        let done = usize::try_from(call.returned).expect("a length");
        let texts = call.arguments.iter().filter(|argument| argument.contains('"'));
        let mut bytes: Vec<u8> = texts.flat_map(|argument| bytes(argument)).collect();
        bytes.truncate(done);
        let Some(opened) = self.descriptors.get_mut(&descriptor) else {
            return self.add(call, Change::Sent { bytes });
        };
        let (file, length) = (opened.inode, self.lengths[opened.inode]);
        let at = match call.name {
            "pwrite64" | "pwritev" | "pwritev2" => {
                let last = if call.name == "pwritev2" { call.arguments.len() - 2 } else { call.arguments.len() - 1 };
                call.arguments[last].parse().expect("an offset")
            }
            _ if opened.appends => length,
            _ => opened.position,
        };
        opened.position = at + done;
        self.lengths[file] = length.max(at + done);
        self.add(call, Change::Write { file, at, bytes });
    }

    fn rename(&mut self, call: &Call<'_>, from: [&str; 2], to: [&str; 2]) {
        let (Some((from_path, from_folder, from)), Some((path, folder, name))) =
            (self.place(from[0], from[1]), self.place(to[0], to[1]))
        else {
            return;
        };
        assert_eq!(from_folder, folder, "a file is renamed into another folder, which this test does not know");
        let inode = self.names.remove(&from_path).expect("a known file");
        self.names.insert(path, inode);
        self.add(call, Change::Rename { folder, from, name, to: inode });
    }

    fn unlink(&mut self, call: &Call<'_>, open: &str, path: &str) {
        if let Some((path, folder, name)) = self.place(open, path) {
            self.names.remove(&path);
            self.add(call, Change::Unlink { folder, name });
        }
    }
}

fn bytes_of_path(argument: &str) -> Option<Vec<u8>> {
    argument.starts_with('"').then(|| bytes(argument))
}
