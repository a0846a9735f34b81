//! Replaces pipeline constants by their values.

use super::{
    lexer::{Fault, Span},
    parser::parse,
    syntax::{Block, Expr, ExprKind, ItemKind, Statement, StatementKind},
};

/// The source without the pipeline constant `name`. Each `if` with only this constant as its condition is replaced by
/// the branch that it takes.
pub(crate) fn folded(source: &str, name: &str, value: bool) -> Result<String, Fault> {
    let module = parse(source)?;
    let mut edits = Vec::new();
    for item in &module.items {
        match &item.kind {
            ItemKind::Override if item.name == name => edits.push((documented(source, &item.span), String::new())),
            ItemKind::Function(function) => in_block(source, &function.body, name, value, &mut edits),
            _ => {}
        }
    }
    let mut out = source.to_owned();
    for (span, text) in edits.into_iter().rev() {
        out.replace_range(span, &text);
    }
    Ok(out)
}

/// The span of an item, with the comment above it and the blank line below it.
fn documented(source: &str, span: &Span) -> Span {
    let mut start = source[..span.start].rfind('\n').map_or(0, |end| end + 1);
    while let Some(above) = source[..start].strip_suffix('\n') {
        let line = above.rfind('\n').map_or(0, |end| end + 1);
        if !above[line..].starts_with("//") {
            break;
        }
        start = line;
    }
    let rest = &source[span.end..];
    start..span.end + (rest.len() - rest.trim_start_matches('\n').len())
}

fn in_block(source: &str, block: &Block, name: &str, value: bool, edits: &mut Vec<(Span, String)>) {
    for statement in &block.statements {
        in_statement(source, statement, name, value, edits);
    }
}

fn in_statement(source: &str, statement: &Statement, name: &str, value: bool, edits: &mut Vec<(Span, String)>) {
    match &statement.kind {
        StatementKind::If { condition, accept, reject } if asks(condition, name) => {
            let taken = match (value, reject.as_deref()) {
                (true, _) => Some(&accept.span),
                (false, reject) => reject.map(|reject| &reject.span),
            };
            edits.push((statement.span.clone(), taken.map_or_else(String::new, |span| inside(&source[span.clone()]))));
        }
        StatementKind::If { accept, reject, .. } => {
            in_block(source, accept, name, value, edits);
            if let Some(reject) = reject {
                in_statement(source, reject, name, value, edits);
            }
        }
        StatementKind::For { body: block, .. } | StatementKind::Block(block) => {
            in_block(source, block, name, value, edits);
        }
        _ => {}
    }
}

fn asks(condition: &Expr, name: &str) -> bool {
    match &condition.kind {
        ExprKind::Paren(inner) => asks(inner, name),
        ExprKind::Name(asked) => asked == name,
        _ => false,
    }
}

/// The statements of a block without its braces, indented like the block. An `else if` is returned unchanged.
fn inside(block: &str) -> String {
    let Some(inner) = block.strip_prefix('{').and_then(|rest| rest.strip_suffix('}')) else {
        return block.to_owned();
    };
    let lines: Vec<&str> = inner.trim().lines().map(|line| line.strip_prefix("    ").unwrap_or(line)).collect();
    lines.join("\n")
}
