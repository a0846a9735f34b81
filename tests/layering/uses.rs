//! The paths that a module names: in `use` items, in code, in macros and in attributes.

use std::collections::{BTreeMap, BTreeSet};

use proc_macro2::{TokenStream, TokenTree};
use syn::{
    Arm, Attribute, Block, Expr, ExprPath, Field, FieldValue, FnArg, ImplItem, Item, ItemUse, Local, Macro, Meta,
    PatIdent, Path, Stmt, TraitItem, Visibility,
    visit::{self, Visit},
};

use crate::tree::{Import, imports, is_for_tests};

/// A path that a module names.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Named {
    /// As written, but for the names that a block imports: those are spelled out.
    pub(crate) path: Vec<String>,
    /// Whether only tests name it.
    pub(crate) is_test: bool,
    /// Whether it stands in a `pub use`: handed on, but not used.
    pub(crate) is_handed_on: bool,
}

/// What a module names.
#[derive(Default)]
pub(crate) struct Uses {
    pub(crate) paths: Vec<Named>,
    /// Every word in its code.
    pub(crate) words: BTreeSet<String>,
}

/// What the items of a module name, those of the modules among them left out.
pub(crate) fn uses(items: &[Item], is_test: bool) -> Uses {
    let mut collector =
        Collector { found: Uses::default(), tests: u32::from(is_test), blocks: Vec::new(), bound: BTreeSet::new() };
    for item in items.iter().filter(|item| !matches!(item, Item::Mod(_))) {
        let mut bound = Bound::default();
        bound.visit_item(item);
        collector.bound = bound.0;
        collector.visit_item(item);
    }
    collector.found
}

/// The names that patterns bind: a variable may be called as a function is.
#[derive(Default)]
struct Bound(BTreeSet<String>);

impl<'ast> Visit<'ast> for Bound {
    fn visit_pat_ident(&mut self, pattern: &'ast PatIdent) {
        self.0.insert(pattern.ident.to_string());
        visit::visit_pat_ident(self, pattern);
    }
}

struct Collector {
    found: Uses,
    /// How many of the things around are for tests only.
    tests: u32,
    /// What the blocks around import, the innermost last.
    blocks: Vec<BTreeMap<String, Vec<String>>>,
    /// The variables of the item that is looked at.
    bound: BTreeSet<String>,
}

impl Collector {
    fn add(&mut self, path: Vec<String>, is_handed_on: bool) {
        let import = self.blocks.iter().rev().find_map(|block| block.get(&path[0]));
        let path = match import {
            Some(import) => import.iter().chain(&path[1..]).cloned().collect(),
            None => path,
        };
        self.found.words.extend(path.iter().cloned());
        self.found.paths.push(Named { path, is_test: self.tests > 0, is_handed_on });
    }

    /// Visits what has these attributes.
    fn within(&mut self, attributes: &[Attribute], visit: impl FnOnce(&mut Self)) {
        let is_test = u32::from(is_for_tests(attributes));
        self.tests += is_test;
        visit(self);
        self.tests -= is_test;
    }

    /// The paths in tokens: runs of names with `::` between them. Names alone may be anything.
    fn add_tokens(&mut self, tokens: TokenStream) {
        let mut path: Vec<String> = Vec::new();
        let mut colons = 0;
        for token in tokens {
            match token {
                TokenTree::Punct(punct) if punct.as_char() == ':' => {
                    colons += 1;
                    continue;
                }
                TokenTree::Ident(ident) => {
                    let word = ident.to_string();
                    self.found.words.insert(word.clone());
                    if colons != 2 {
                        self.end(&mut path);
                    }
                    path.push(word);
                }
                TokenTree::Group(group) => {
                    self.end(&mut path);
                    self.add_tokens(group.stream());
                }
                _ => self.end(&mut path),
            }
            colons = 0;
        }
        self.end(&mut path);
    }

    fn end(&mut self, path: &mut Vec<String>) {
        let path = std::mem::take(path);
        if path.len() > 1 {
            self.add(path, false);
        }
    }
}

impl<'ast> Visit<'ast> for Collector {
    fn visit_path(&mut self, path: &'ast Path) {
        let names: Vec<String> = path.segments.iter().map(|segment| segment.ident.to_string()).collect();
        if path.leading_colon.is_none() {
            self.add(names, false);
        }
        visit::visit_path(self, path);
    }

    fn visit_expr_path(&mut self, path: &'ast ExprPath) {
        if path.path.get_ident().is_none_or(|ident| !self.bound.contains(&ident.to_string())) {
            visit::visit_expr_path(self, path);
        }
    }

    fn visit_ident(&mut self, ident: &'ast proc_macro2::Ident) {
        self.found.words.insert(ident.to_string());
    }

    fn visit_item_use(&mut self, item: &'ast ItemUse) {
        let is_handed_on = !matches!(item.vis, Visibility::Inherited);
        let found = imports(&item.tree);
        self.within(&item.attrs, |this| found.into_iter().for_each(|import| this.add(import.path, is_handed_on)));
    }

    fn visit_visibility(&mut self, _: &'ast Visibility) {}

    fn visit_macro(&mut self, makro: &'ast Macro) {
        self.visit_path(&makro.path);
        self.add_tokens(makro.tokens.clone());
    }

    fn visit_attribute(&mut self, attribute: &'ast Attribute) {
        if let Meta::List(list) = &attribute.meta {
            self.add_tokens(list.tokens.clone());
        }
    }

    fn visit_block(&mut self, block: &'ast Block) {
        let mut names = BTreeMap::new();
        for statement in &block.stmts {
            let Stmt::Item(Item::Use(item)) = statement else { continue };
            // A block may import what lies in its own scope; the path is then that of the module.
            names.extend(imports(&item.tree).into_iter().map(|Import { path, name }| (name, path)));
        }
        for statement in &block.stmts {
            if let Stmt::Item(item @ Item::Use(_)) = statement {
                self.visit_item(item);
            }
        }
        self.blocks.push(names);
        for statement in block.stmts.iter().filter(|statement| !matches!(statement, Stmt::Item(Item::Use(_)))) {
            self.visit_stmt(statement);
        }
        self.blocks.pop();
    }

    fn visit_item(&mut self, item: &'ast Item) {
        self.within(attributes(item), |this| visit::visit_item(this, item));
    }

    fn visit_impl_item(&mut self, item: &'ast ImplItem) {
        let attributes: &[Attribute] = match item {
            ImplItem::Const(item) => &item.attrs,
            ImplItem::Fn(item) => &item.attrs,
            ImplItem::Type(item) => &item.attrs,
            _ => &[],
        };
        self.within(attributes, |this| visit::visit_impl_item(this, item));
    }

    fn visit_trait_item(&mut self, item: &'ast TraitItem) {
        let attributes: &[Attribute] = if let TraitItem::Fn(item) = item { &item.attrs } else { &[] };
        self.within(attributes, |this| visit::visit_trait_item(this, item));
    }

    fn visit_field(&mut self, field: &'ast Field) {
        self.within(&field.attrs, |this| visit::visit_field(this, field));
    }

    fn visit_field_value(&mut self, field: &'ast FieldValue) {
        self.within(&field.attrs, |this| visit::visit_field_value(this, field));
    }

    fn visit_fn_arg(&mut self, argument: &'ast FnArg) {
        let attributes = match argument {
            FnArg::Receiver(receiver) => &receiver.attrs,
            FnArg::Typed(typed) => &typed.attrs,
        };
        self.within(attributes, |this| visit::visit_fn_arg(this, argument));
    }

    fn visit_arm(&mut self, arm: &'ast Arm) {
        self.within(&arm.attrs, |this| visit::visit_arm(this, arm));
    }

    fn visit_local(&mut self, local: &'ast Local) {
        self.within(&local.attrs, |this| visit::visit_local(this, local));
    }

    fn visit_expr(&mut self, expression: &'ast Expr) {
        let attributes: &[Attribute] = match expression {
            Expr::Block(block) => &block.attrs,
            Expr::Call(call) => &call.attrs,
            Expr::If(branch) => &branch.attrs,
            Expr::MethodCall(call) => &call.attrs,
            _ => &[],
        };
        self.within(attributes, |this| visit::visit_expr(this, expression));
    }
}

fn attributes(item: &Item) -> &[Attribute] {
    match item {
        Item::Const(item) => &item.attrs,
        Item::Enum(item) => &item.attrs,
        Item::Fn(item) => &item.attrs,
        Item::Impl(item) => &item.attrs,
        Item::Macro(item) => &item.attrs,
        Item::Static(item) => &item.attrs,
        Item::Struct(item) => &item.attrs,
        Item::Trait(item) => &item.attrs,
        Item::Type(item) => &item.attrs,
        // `use` items look at their own.
        _ => &[],
    }
}
