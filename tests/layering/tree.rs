//! The modules of a crate, read from its files and parsed.

use std::{
    collections::{BTreeMap, BTreeSet},
    path::{Path, PathBuf},
};

use syn::{Attribute, ImplItem, Item, Meta, Type, UseTree};

use crate::uses::{Uses, uses};

/// A crate's modules; the first is its root.
pub(crate) struct Tree {
    pub(crate) modules: Vec<Module>,
}

/// A module: a file, or a part of one.
pub(crate) struct Module {
    /// Names from the root, which has none.
    pub(crate) path: Vec<String>,
    pub(crate) parent: Option<usize>,
    /// Relative to the root's folder.
    pub(crate) file: PathBuf,
    /// Whether it, or a module around it, is for tests only.
    pub(crate) is_test: bool,
    /// What its own code names; the modules below it have theirs.
    pub(crate) uses: Uses,
    /// The functions and constants of types that are written here: the type's path, and the name.
    pub(crate) members: Vec<(Vec<String>, String)>,
    /// Whether it has macros, which may define what nobody sees.
    pub(crate) has_macros: bool,
    /// What it defines or imports. A name may stand for a module and for a function at once.
    pub(crate) names: BTreeMap<String, Vec<Name>>,
    /// The paths of its `use path::*`.
    pub(crate) globs: Vec<Vec<String>>,
}

/// What a name stands for in a module.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Name {
    /// A child, by its index.
    Module(usize),
    /// A type, function, constant or macro that is defined here.
    Item,
    /// What the path of a `use` stands for.
    Use(Vec<String>),
}

/// A path that a `use` brings in, under a name; `*` is a name too.
pub(crate) struct Import {
    pub(crate) path: Vec<String>,
    pub(crate) name: String,
}

impl Tree {
    /// Reads the crate whose root is `root`; `read` gives a file's text, if there is such a file.
    pub(crate) fn read(root: &Path, read: &dyn Fn(&Path) -> Option<String>) -> Self {
        let mut tree = Self { modules: Vec::new() };
        let module = Module::new(Vec::new(), None, root.to_owned(), false, &parse(root, read));
        tree.add(module, parse(root, read), Path::new(""), read);
        tree
    }

    /// The files that belong to the crate.
    pub(crate) fn files(&self) -> BTreeSet<&Path> {
        self.modules.iter().map(|module| module.file.as_path()).collect()
    }

    /// Adds a module and those below it, whose files lie in `folder`.
    fn add(
        &mut self,
        module: Module,
        items: Vec<Item>,
        folder: &Path,
        read: &dyn Fn(&Path) -> Option<String>,
    ) -> usize {
        let (path, file, is_test) = (module.path.clone(), module.file.clone(), module.is_test);
        let index = self.modules.len();
        self.modules.push(module);
        for item in items {
            let Item::Mod(item) = item else { continue };
            assert!(!has_path(&item.attrs), "{}: the place of `mod {}` is its name", file.display(), item.ident);
            let name = item.ident.to_string();
            let below = folder.join(&name);
            let (file, items) = if let Some((_, items)) = item.content {
                (file.clone(), items)
            } else {
                let candidates = [below.with_extension("rs"), below.join("mod.rs")];
                let found = candidates.into_iter().find(|candidate| read(candidate).is_some());
                let found = found.unwrap_or_else(|| panic!("{}: no file for `mod {name}`", file.display()));
                let items = parse(&found, read);
                (found, items)
            };
            let path = path.iter().cloned().chain([name.clone()]).collect();
            let child = Module::new(path, Some(index), file, is_test || is_for_tests(&item.attrs), &items);
            let child = self.add(child, items, &below, read);
            self.modules[index].names.entry(name).or_default().push(Name::Module(child));
        }
        index
    }
}

impl Module {
    fn new(path: Vec<String>, parent: Option<usize>, file: PathBuf, is_test: bool, items: &[Item]) -> Self {
        let (names, globs) = (BTreeMap::new(), Vec::new());
        let mut module = Self {
            path,
            parent,
            file,
            is_test,
            uses: uses(items, is_test),
            members: Vec::new(),
            has_macros: false,
            names,
            globs,
        };
        for item in items {
            module.add(item);
        }
        module
    }

    fn add(&mut self, item: &Item) {
        let defined = match item {
            Item::Const(item) => &item.ident,
            Item::Enum(item) => &item.ident,
            Item::Fn(item) => &item.sig.ident,
            Item::Static(item) => &item.ident,
            Item::Struct(item) => &item.ident,
            Item::Trait(item) => &item.ident,
            Item::Type(item) => &item.ident,
            Item::Union(item) => &item.ident,
            Item::Use(item) => return imports(&item.tree).into_iter().for_each(|import| self.import(import)),
            Item::Macro(_) => {
                self.has_macros = true;
                return;
            }
            // Functions of a trait count as the type's own: many blocks have a function of one name.
            Item::Impl(block) if block.trait_.is_none() => {
                if let Type::Path(of) = &*block.self_ty {
                    let owner: Vec<String> = of.path.segments.iter().map(|segment| segment.ident.to_string()).collect();
                    let members = block.items.iter().filter_map(member);
                    self.members.extend(members.map(|member| (owner.clone(), member)));
                }
                return;
            }
            _ => return,
        };
        self.names.entry(defined.to_string()).or_default().push(Name::Item);
    }

    fn import(&mut self, Import { path, name }: Import) {
        if name == "*" {
            self.globs.push(path);
        } else {
            self.names.entry(name).or_default().push(Name::Use(path));
        }
    }
}

fn member(item: &ImplItem) -> Option<String> {
    match item {
        ImplItem::Fn(item) => Some(item.sig.ident.to_string()),
        ImplItem::Const(item) => Some(item.ident.to_string()),
        _ => None,
    }
}

fn parse(path: &Path, read: &dyn Fn(&Path) -> Option<String>) -> Vec<Item> {
    let text = read(path).unwrap_or_else(|| panic!("no file {}", path.display()));
    syn::parse_file(&text).unwrap_or_else(|error| panic!("{}: {error}", path.display())).items
}

/// What a `use` imports, groups spelled out.
pub(crate) fn imports(tree: &UseTree) -> Vec<Import> {
    let mut found = Vec::new();
    flatten(&mut Vec::new(), tree, &mut found);
    found
}

fn flatten(before: &mut Vec<String>, tree: &UseTree, found: &mut Vec<Import>) {
    // `a::{self}` imports `a`.
    let whole = |before: &[String], ident: &syn::Ident| {
        let own = (ident != "self" || before.is_empty()).then(|| ident.to_string());
        before.iter().cloned().chain(own).collect::<Vec<_>>()
    };
    match tree {
        UseTree::Path(path) => {
            before.push(path.ident.to_string());
            flatten(before, &path.tree, found);
            before.pop();
        }
        UseTree::Name(name) => {
            let path = whole(before, &name.ident);
            let name = path.last().expect("a path has a name").clone();
            found.push(Import { path, name });
        }
        UseTree::Rename(rename) => {
            found.push(Import { path: whole(before, &rename.ident), name: rename.rename.to_string() });
        }
        UseTree::Glob(_) => found.push(Import { path: before.clone(), name: "*".to_owned() }),
        UseTree::Group(group) => group.items.iter().for_each(|tree| flatten(before, tree, found)),
    }
}

/// Whether an item is compiled into tests only.
pub(crate) fn is_for_tests(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| match &attribute.meta {
        Meta::List(list) if list.path.is_ident("cfg") => list.tokens.to_string() == "test",
        _ => attribute.path().is_ident("test"),
    })
}

fn has_path(attributes: &[Attribute]) -> bool {
    attributes.iter().any(|attribute| attribute.path().is_ident("path"))
}
