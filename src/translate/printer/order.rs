//! The order of the printed declarations, and their comments.

use std::collections::{BTreeSet, HashMap};

use crate::wgsl::{Fault, ItemKind, Kind, Module, Token, Type};

/// Declarations, identified by their number in the module.
pub(super) struct Order {
    /// The printed declarations. Each follows its dependencies.
    numbers: Vec<usize>,
    /// The dependencies of each declaration of the module.
    needs: Vec<BTreeSet<usize>>,
}

/// The comments above a declaration.
#[derive(Debug, Default)]
pub(super) struct Lead {
    /// Whether a blank line comes before the declaration.
    pub(super) is_apart: bool,
    /// Comments that belong to no declaration, each followed by a blank line.
    pub(super) free: String,
    /// The comment of this declaration.
    pub(super) own: String,
}

impl Order {
    /// Finds the declarations that `entry` uses, and `entry` itself, which comes last.
    pub(super) fn from(module: &Module<'_>, entry: &str) -> Result<Self, Fault> {
        let numbers: HashMap<&str, usize> =
            module.items.iter().enumerate().map(|(number, item)| (item.name.as_str(), number)).collect();
        let needs: Vec<BTreeSet<usize>> =
            (0..module.items.len()).map(|number| needs_of(module, &numbers, number)).collect();
        for item in &module.items {
            if let ItemKind::Struct { members, .. } = &item.kind
                && members.iter().any(|member| holds(&member.ty, &item.name))
            {
                return Err(Fault::new(item.span.start, "this declaration depends on itself"));
            }
        }
        let entry = *numbers.get(entry).ok_or_else(|| Fault::new(0, format!("the function «{entry}» is missing")))?;
        let mut reached = BTreeSet::new();
        let mut waiting = vec![entry];
        while let Some(number) = waiting.pop() {
            if reached.insert(number) {
                waiting.extend(&needs[number]);
            }
        }
        let (mut printed, mut left) = (Vec::new(), reached);
        while let Some(first) = left.first() {
            let next = first_needed(*first, &left, &needs)
                .ok_or_else(|| Fault::new(module.items[*first].span.start, "this declaration depends on itself"))?;
            left.remove(&next);
            printed.push(next);
        }
        Ok(Self { numbers: printed, needs })
    }

    /// The declarations and the comments above each. A free comment, which belongs to no declaration, is printed above
    /// the next printed declaration. Comments of declarations that are not printed are omitted.
    pub(super) fn printed(&self, module: &Module<'_>) -> Vec<(usize, Lead)> {
        let mut leads = HashMap::new();
        let (mut waiting, mut end) = (String::new(), 0);
        for (number, item) in module.items.iter().enumerate() {
            let (free, own) = comments(&module.source[end..item.span.start]);
            waiting += &free;
            if self.numbers.contains(&number) {
                let is_apart = !free.is_empty() || module.source[end..item.span.start].contains("\n\n");
                leads.insert(number, Lead { is_apart, free: std::mem::take(&mut waiting), own });
            }
            end = item.span.end;
        }
        self.numbers.iter().map(|number| (*number, leads.remove(number).unwrap_or_default())).collect()
    }

    /// The resources that each printed function reads, directly or through calls. They have the order of the source.
    pub(super) fn read<'a>(&self, module: &'a Module<'_>) -> HashMap<&'a str, Vec<String>> {
        let mut found: HashMap<usize, BTreeSet<usize>> = HashMap::new();
        // Each declaration comes after its dependencies.
        for number in &self.numbers {
            let mut read = BTreeSet::new();
            for need in &self.needs[*number] {
                match module.items[*need].kind {
                    ItemKind::Global(_) => drop(read.insert(*need)),
                    _ => read.extend(found.get(need).into_iter().flatten()),
                }
            }
            found.insert(*number, read);
        }
        let names = |read: BTreeSet<usize>| read.iter().map(|number| module.items[*number].name.clone()).collect();
        found.into_iter().map(|(number, read)| (module.items[number].name.as_str(), names(read))).collect()
    }

    /// The names that are called with arguments. They include structures that are constructed from members.
    pub(super) fn made<'a>(&self, module: &'a Module<'_>) -> BTreeSet<&'a str> {
        let text = |token: &Token| &module.source[token.span.clone()];
        let tokens = self.numbers.iter().flat_map(|number| tokens_of(module, *number).windows(3));
        let calls = tokens.filter(|three| text(&three[1]) == "(" && text(&three[2]) != ")");
        calls.map(|three| text(&three[0])).collect()
    }
}

/// A declaration that depends on nothing in `left`: `first` or one of its dependencies. `None` if the dependencies form
/// a cycle.
fn first_needed(first: usize, left: &BTreeSet<usize>, needs: &[BTreeSet<usize>]) -> Option<usize> {
    let mut at = first;
    for _ in 0..=left.len() {
        match needs[at].iter().find(|need| left.contains(need)) {
            Some(need) => at = *need,
            None => return Some(at),
        }
    }
    None
}

/// Whether a type contains the structure `name`.
fn holds(ty: &Type, name: &str) -> bool {
    match ty {
        Type::Struct(of) => of == name,
        Type::Array(of, _) | Type::Pointer(of) => holds(of, name),
        _ => false,
    }
}

fn tokens_of<'a>(module: &'a Module<'_>, number: usize) -> &'a [Token] {
    let span = &module.items[number].span;
    let start = module.tokens.partition_point(|token| token.span.start < span.start);
    let end = module.tokens.partition_point(|token| token.span.end <= span.end);
    &module.tokens[start..end.max(start)]
}

/// The dependencies of a declaration: the declarations whose names it uses, except as names of members.
fn needs_of(module: &Module<'_>, numbers: &HashMap<&str, usize>, number: usize) -> BTreeSet<usize> {
    let text = |token: &Token| &module.source[token.span.clone()];
    let tokens = tokens_of(module, number);
    let is_member = |at: usize| at > 0 && text(&tokens[at - 1]) == ".";
    let words = tokens.iter().enumerate().filter(|(at, token)| token.kind == Kind::Word && !is_member(*at));
    words.filter_map(|(_, token)| numbers.get(text(token))).copied().filter(|need| *need != number).collect()
}

/// The comments above a declaration: free comments, each followed by a blank line, and the declaration's own comment.
fn comments(above: &str) -> (String, String) {
    let (mut free, mut own) = (String::new(), String::new());
    for line in above.lines().map(str::trim_end) {
        if line.trim_start().starts_with('/') {
            own.extend([line, "\n"]);
        } else if !own.is_empty() {
            free.extend([own.as_str(), "\n"]);
            own.clear();
        }
    }
    (free, own)
}
