//! The source, and the names that are visible at a position in it, with their types.

use std::collections::{BTreeSet, HashMap};

use super::{
    builtins::{has_word, is_builtin},
    dialect::{Dialect, Members, Slotted},
};
use crate::wgsl::{Expr, ExprKind, Fault, Function, ItemKind, Kind, Module, Resource, Span, Type};

/// A variable of a function.
#[derive(Debug, Clone)]
pub(super) struct Local {
    pub(super) name: String,
    pub(super) ty: Type,
}

pub(super) struct Context<'a> {
    pub(super) module: &'a Module<'a>,
    pub(super) dialect: &'a dyn Dialect,
    pub(super) functions: HashMap<&'a str, &'a Function>,
    structs: HashMap<&'a str, Members>,
    /// The types of constants.
    pub(super) constants: HashMap<String, Type>,
    /// The resources.
    pub(super) bound: HashMap<&'a str, Slotted>,
    /// The resources that a function reads, directly or through calls.
    pub(super) read: HashMap<&'a str, Vec<String>>,
    scopes: Vec<HashMap<String, Local>>,
    words: BTreeSet<&'a str>,
}

impl<'a> Context<'a> {
    pub(super) fn new(module: &'a Module<'a>, dialect: &'a dyn Dialect) -> Self {
        let words = module.tokens.iter().filter(|token| token.kind == Kind::Word);
        let words = words.map(|token| &module.source[token.span.clone()]).collect();
        let (mut functions, mut structs, mut bound) = (HashMap::new(), HashMap::new(), HashMap::new());
        for item in &module.items {
            match &item.kind {
                ItemKind::Function(function) => drop(functions.insert(item.name.as_str(), function)),
                ItemKind::Struct { members, .. } => {
                    let members = members.iter().map(|member| (member.name.clone(), member.ty.clone())).collect();
                    structs.insert(item.name.as_str(), members);
                }
                ItemKind::Global(global) => {
                    let slotted = Slotted { bound: global.clone(), slot: slot(module, global) };
                    bound.insert(item.name.as_str(), slotted);
                }
                // The type of a constant is only known after it is printed.
                ItemKind::Constant { .. } | ItemKind::Override => {}
            }
        }
        let (constants, read) = (HashMap::new(), HashMap::new());
        Self { module, dialect, functions, structs, constants, bound, read, scopes: Vec::new(), words }
    }

    pub(super) fn source(&self, span: Span) -> &'a str {
        &self.module.source[span]
    }

    /// The source of `span`, with some pieces replaced. The pieces are in the order of the source.
    pub(super) fn woven(&self, span: &Span, pieces: &[(Span, String)]) -> String {
        let (mut out, mut at) = (String::new(), span.start);
        for (place, text) in pieces {
            out += self.source(at..place.start.max(at));
            out += text;
            at = place.end.max(at);
        }
        out + self.source(at..span.end.max(at))
    }

    /// Rejects comments in source that is not copied to the output, because they would be lost.
    pub(super) fn without_comment(&self, span: Span) -> Result<(), Fault> {
        match self.source(span.clone()).find("//").or_else(|| self.source(span.clone()).find("/*")) {
            Some(at) => Err(Fault::new(span.start + at, "a comment here would be lost in the output")),
            None => Ok(()),
        }
    }

    /// Whether the span uses the name itself, not a member with this name.
    pub(super) fn mentions(&self, span: &Span, name: &str) -> bool {
        self.before(span, name).any(|sign| sign != Some("."))
    }

    /// Whether the span uses a pointer other than as `*name`. The pointer is then passed to a function that may write
    /// to it.
    pub(super) fn passes_on(&self, span: &Span, name: &str) -> bool {
        self.before(span, name).any(|sign| !matches!(sign, Some("." | "*")))
    }

    /// The token before each occurrence of the word in the span.
    fn before<'b>(&'b self, span: &'b Span, word: &'b str) -> impl Iterator<Item = Option<&'a str>> + 'b {
        let tokens = &self.module.tokens;
        let first = tokens.partition_point(|token| token.span.start < span.start);
        let within = tokens.iter().enumerate().skip(first).take_while(|(_, token)| token.span.end <= span.end);
        let places =
            within.filter(move |(_, token)| token.kind == Kind::Word && self.source(token.span.clone()) == word);
        places.map(|(at, _)| at.checked_sub(1).map(|before| self.source(tokens[before].span.clone())))
    }

    /// The members of a structure, with their names in the target language.
    pub(super) fn members(&self, name: &str) -> Option<Members> {
        let members = self.structs.get(name)?;
        Some(members.iter().map(|(name, ty)| (self.member(name), ty.clone())).collect())
    }

    /// The name of a structure's member.
    pub(super) fn member(&self, name: &str) -> String {
        if has_word(self.dialect.reserved(), name) { self.fresh(name) } else { name.to_owned() }
    }

    /// The type of a structure's member.
    pub(super) fn member_type(&self, of: &str, name: &str) -> Option<Type> {
        self.structs.get(of)?.iter().find(|(member, _)| member == name).map(|(_, ty)| ty.clone())
    }

    pub(super) fn zero(&self, ty: &Type) -> String {
        self.dialect.zero(ty, &|name| self.members(name).unwrap_or_default())
    }

    /// A similar name that the source does not use.
    fn fresh(&self, name: &str) -> String {
        let plain = format!("{}_", name.trim_end_matches('_'));
        let numbered = (2..).map(|number| format!("{plain}{number}"));
        std::iter::once(plain.clone()).chain(numbered).find(|name| !self.words.contains(name.as_str())).unwrap_or(plain)
    }

    pub(super) fn enter(&mut self) {
        self.scopes.push(HashMap::new());
    }

    pub(super) fn leave(&mut self) {
        self.scopes.pop();
    }

    /// Declares a variable. It gets another name if the target language reserves the name, or if its own value
    /// (`beside`) uses a variable with this name.
    pub(super) fn declare(&mut self, name: &str, ty: Type, beside: Option<&Span>) -> String {
        let is_taken = has_word(self.dialect.reserved(), name)
            || has_word(self.dialect.functions(), name)
            || is_builtin(name)
            || beside.is_some_and(|value| self.local(name).is_some() && self.mentions(value, name));
        let named = if is_taken { self.fresh(name) } else { name.to_owned() };
        if let Some(scope) = self.scopes.last_mut() {
            scope.insert(name.to_owned(), Local { name: named.clone(), ty });
        }
        named
    }

    pub(super) fn local(&self, name: &str) -> Option<&Local> {
        self.scopes.iter().rev().find_map(|scope| scope.get(name))
    }
}

/// The number of resources of the same kind (buffer, texture or sampler) before this resource.
fn slot(module: &Module<'_>, of: &Resource) -> usize {
    let kind = |bound: &Resource| match bound.ty {
        Type::Texture(_) => 0,
        Type::Sampler => 1,
        _ => 2,
    };
    let all = module.items.iter().filter_map(|item| match &item.kind {
        ItemKind::Global(bound) => Some(bound),
        _ => None,
    });
    all.filter(|other| kind(other) == kind(of) && (other.group, other.binding) < (of.group, of.binding)).count()
}

/// The variable on the left side of an assignment.
pub(super) fn root(target: &Expr) -> Option<&str> {
    match &target.kind {
        ExprKind::Name(name) => Some(name),
        ExprKind::Paren(of) | ExprKind::Unary(_, of) | ExprKind::Index(of, _) | ExprKind::Field(of, _) => root(of),
        _ => None,
    }
}
