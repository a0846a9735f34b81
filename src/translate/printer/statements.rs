//! Statements and the bodies of functions.

use super::{
    context::{Context, root},
    dialect::Piece,
    expressions::{expression, value},
};
use crate::wgsl::{Block, Expr, ExprKind, Fault, Function, Span, Statement, StatementKind, Type};

/// The parameters of a function in brackets, and its body.
pub(super) fn function(context: &mut Context<'_>, name: &str, function: &Function) -> Result<(String, String), Fault> {
    context.enter();
    let mut pieces: Vec<(Span, String)> = Vec::new();
    for parameter in &function.parameters {
        let named = context.declare(&parameter.name, parameter.ty.clone(), None);
        let is_passed_on =
            matches!(parameter.ty, Type::Pointer(_)) && context.passes_on(&function.body.span, &parameter.name);
        let is_written = is_passed_on || writes(&function.body, &parameter.name);
        let text = context.dialect.parameter(&named, &parameter.ty, is_written);
        pieces.push((parameter.span.clone(), text));
    }
    let passed: Vec<String> =
        context.read.get(name).into_iter().flatten().filter_map(|global| passed(context, global)).collect();
    if !passed.is_empty() {
        let passed = passed.join(", ");
        match pieces.last_mut() {
            Some((_, last)) => last.extend([",\n    ", &passed]),
            None => pieces.push((function.span.end - 1..function.span.end - 1, passed)),
        }
    }
    pieces.extend(function.comma.clone().map(|comma| (comma, String::new())));
    let parameters = context.woven(&function.span, &pieces);
    let body = block(context, &function.body, &function.body);
    context.leave();
    Ok((parameters, body?))
}

fn passed(context: &Context<'_>, global: &str) -> Option<String> {
    context.bound.get(global).and_then(|slotted| context.dialect.global(global, slotted))
}

/// Whether a block assigns to a variable or to a part of the variable.
fn writes(block: &Block, name: &str) -> bool {
    block.statements.iter().any(|statement| statement_writes(statement, name))
}

fn statement_writes(statement: &Statement, name: &str) -> bool {
    let one = |statement: &Option<Box<Statement>>| statement.as_ref().is_some_and(|of| statement_writes(of, name));
    match &statement.kind {
        StatementKind::Assign { target, .. } | StatementKind::Step(target) => root(target) == Some(name),
        StatementKind::If { accept, reject, .. } => writes(accept, name) || one(reject),
        StatementKind::For { start, step, body, .. } => one(start) || one(step) || writes(body, name),
        StatementKind::Block(block) => writes(block, name),
        _ => false,
    }
}

/// Prints a block of a function. `whole` is the body of the function.
fn block(context: &mut Context<'_>, of: &Block, whole: &Block) -> Result<String, Fault> {
    context.enter();
    let pieces = statements(context, of, whole);
    context.leave();
    Ok(context.woven(&of.span, &pieces?))
}

fn statements(context: &mut Context<'_>, of: &Block, whole: &Block) -> Result<Vec<(Span, String)>, Fault> {
    let mut pieces = Vec::new();
    let mut rest = &of.statements[..];
    while let [first, after @ ..] = rest {
        rest = after;
        if let Some((span, text)) = after.first().map(|next| joined(context, first, next)).transpose()?.flatten() {
            pieces.push((span, text));
            rest = &after[1..];
            continue;
        }
        pieces.push((first.span.clone(), statement(context, first, whole)?));
    }
    Ok(pieces)
}

/// Joins `var x: T;` and `x = value;` into a single declaration.
fn joined(context: &mut Context<'_>, first: &Statement, next: &Statement) -> Result<Option<(Span, String)>, Fault> {
    let StatementKind::Declare { name, ty: Some(ty), value: None } = &first.kind else { return Ok(None) };
    let StatementKind::Assign { target, value } = &next.kind else { return Ok(None) };
    let is_whole = matches!(&target.kind, ExprKind::Name(target) if target == name)
        && context.source(target.span.end..value.span.start).trim() == "=";
    let between = first.span.end..next.span.start;
    if !is_whole || context.mentions(&value.span, name) || context.without_comment(between).is_err() {
        return Ok(None);
    }
    let piece = expression(context, value)?;
    let declared = declaration(context, name, ty, None);
    let text = context.woven(&next.span, &[(target.span.clone(), declared), (value.span.clone(), piece.text)]);
    Ok(Some((first.span.start..next.span.end, text)))
}

/// Declares a variable: its type and name.
fn declaration(context: &mut Context<'_>, name: &str, ty: &Type, value: Option<&Span>) -> String {
    let named = context.declare(name, ty.clone(), value);
    context.dialect.declared(&named, ty)
}

fn statement(context: &mut Context<'_>, of: &Statement, whole: &Block) -> Result<String, Fault> {
    let replaced = |context: &Context<'_>, parts: &[&Expr]| -> Result<String, Fault> {
        let pieces = parts.iter().map(|part| Ok((part.span.clone(), expression(context, part)?.text)));
        Ok(context.woven(&of.span, &pieces.collect::<Result<Vec<_>, Fault>>()?))
    };
    match &of.kind {
        StatementKind::Declare { name, ty, value } => declare(context, of, name, ty.as_ref(), value.as_ref(), whole),
        StatementKind::Assign { target, value } => replaced(context, &[target, value]),
        StatementKind::Step(part) | StatementKind::Call(part) | StatementKind::Return(Some(part)) => {
            replaced(context, &[part])
        }
        StatementKind::Return(None) | StatementKind::Leave => replaced(context, &[]),
        StatementKind::If { condition, accept, reject } => {
            let mut text = expression(context, condition)?.text;
            if !matches!(condition.kind, ExprKind::Paren(_)) {
                text = format!("({text})");
            }
            let mut pieces =
                vec![(condition.span.clone(), text), (accept.span.clone(), block(context, accept, whole)?)];
            if let Some(reject) = reject {
                pieces.push((reject.span.clone(), statement(context, reject, whole)?));
            }
            Ok(context.woven(&of.span, &pieces))
        }
        StatementKind::For { start, condition, step, body } => {
            context.enter();
            let pieces = looped(context, [start.as_deref(), step.as_deref()], condition.as_ref(), body, whole);
            context.leave();
            Ok(context.woven(&of.span, &pieces?))
        }
        StatementKind::Block(inner) => block(context, inner, whole),
    }
}

fn looped(
    context: &mut Context<'_>,
    [start, step]: [Option<&Statement>; 2],
    condition: Option<&Expr>,
    body: &Block,
    whole: &Block,
) -> Result<Vec<(Span, String)>, Fault> {
    let mut pieces = Vec::new();
    if let Some(start) = start {
        pieces.push((start.span.clone(), statement(context, start, whole)?));
    }
    if let Some(condition) = condition {
        pieces.push((condition.span.clone(), expression(context, condition)?.text));
    }
    if let Some(step) = step {
        pieces.push((step.span.clone(), statement(context, step, whole)?));
    }
    pieces.push((body.span.clone(), block(context, body, whole)?));
    Ok(pieces)
}

fn declare(
    context: &mut Context<'_>,
    of: &Statement,
    name: &str,
    ty: Option<&Type>,
    given: Option<&Expr>,
    whole: &Block,
) -> Result<String, Fault> {
    let piece = match (given, ty) {
        (Some(given), _) => value(context, given)?,
        (None, Some(ty)) => Piece::tight(context.zero(ty), ty.clone()),
        (None, None) => return Err(Fault::new(of.span.start, "this variable has neither type nor value")),
    };
    let span = given.map(|given| given.span.clone());
    context.without_comment(of.span.start..span.as_ref().map_or(of.span.end, |span| span.start))?;
    let ty = ty.cloned().unwrap_or_else(|| piece.ty.concrete());
    let is_copy = matches!(ty, Type::Array(..)) && given.is_some_and(|given| matches!(given.kind, ExprKind::Name(_)));
    let named = context.declare(name, ty.clone(), span.as_ref());
    let declared = match context.dialect.alias(&named, &ty).filter(|_| is_copy) {
        Some(_) if writes(whole, name) => {
            return Err(Fault::new(of.span.start, format!("«{name}» is a copy of an array and cannot be assigned to")));
        }
        Some(alias) => alias,
        None => context.dialect.declared(&named, &ty),
    };
    Ok(format!("{declared} = {}", piece.text))
}
