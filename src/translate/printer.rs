//! Prints WGSL in another language, as a person would write it: with the same names, comments and lines.
//!
//! The declarations that the entry point uses are printed in the order of the source, but each declaration follows
//! those that it depends on. Code that both languages write in the same way is copied from the source, with its
//! comments, blanks and line breaks.
//!
//! Invariants: knows neither naga nor light models; equal arguments give equal bytes; unsupported source gives an error
//! with line and column, never a panic.

mod builtins;
mod context;
mod dialect;
mod expressions;
mod glsl;
mod hlsl;
mod msl;
mod order;
mod statements;

use crate::wgsl::{Fault, Function, Item, ItemKind, parse};
use context::Context;
use dialect::{Dialect, Slotted};
use expressions::value;
use glsl::Glsl;
use hlsl::Hlsl;
use ltcforge_shaders::Language;
use msl::Msl;
use order::Order;

/// The purpose of the entry point.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Form {
    /// The entry point selects the functions to print, and is not printed itself.
    Include,
    /// The entry point is printed as a compute shader.
    Program,
}

/// Prints the declarations of `source` that the entry point `entry` uses, in `language`. Errors have line and column.
pub(crate) fn printed(language: Language, source: &str, entry: &str, form: Form) -> Result<String, String> {
    let dialect: &dyn Dialect = match (language, form) {
        (Language::Glsl, Form::Include) => &Glsl::Desktop450,
        (Language::Glsl, Form::Program) => &Glsl::Program450,
        (Language::Glsl330, Form::Include) => &Glsl::Desktop330,
        (Language::Glsl330, Form::Program) => return Err("GLSL 3.30 has no compute shaders".to_owned()),
        (Language::GlslEs, Form::Include) => &Glsl::Es300,
        (Language::GlslEs, Form::Program) => &Glsl::Program310,
        (Language::Hlsl, _) => &Hlsl,
        (Language::Msl, _) => &Msl,
        (Language::Wgsl | Language::Spirv, _) => return Err("this language is not printed".to_owned()),
    };
    module(source, entry, form, dialect).map_err(|fault| fault.message(source))
}

fn module(source: &str, entry: &str, form: Form, dialect: &dyn Dialect) -> Result<String, Fault> {
    let parsed = parse(source)?;
    let order = Order::from(&parsed, entry)?;
    let mut context = Context::new(&parsed, dialect);
    if dialect.passes_what_is_bound() {
        context.read = order.read(&parsed);
    }
    let made = order.made(&parsed);
    let mut out = String::from(dialect.opening());
    let (mut is_tall, mut waiting) = (false, String::new());
    for (number, lead) in order.printed(&parsed) {
        let item = &parsed.items[number];
        let text = match &item.kind {
            ItemKind::Function(_) if item.name == entry && form == Form::Include => continue,
            ItemKind::Function(function) if item.name == entry => Some(program(&mut context, entry, function)?),
            _ => declaration(&mut context, item, made.contains(item.name.as_str()))?,
        };
        waiting += &lead.free;
        let Some(text) = text else { continue };
        let is_next_tall = matches!(item.kind, ItemKind::Function(_) | ItemKind::Struct { .. });
        if !out.is_empty()
            && !out.ends_with("\n\n")
            && (is_tall || is_next_tall || lead.is_apart || !waiting.is_empty())
        {
            out += "\n";
        }
        out.extend([waiting.as_str(), &lead.own, &text, "\n"]);
        waiting.clear();
        is_tall = is_next_tall;
    }
    Ok(commented(&out))
}

/// Prints the entry point of a program. The entry point takes no parameters.
fn program(context: &mut Context<'_>, name: &str, function: &Function) -> Result<String, Fault> {
    // The function gets no parameters for its resources, because the dialect binds them to the printed entry point.
    let read = context.read.remove(name).unwrap_or_default();
    let bound: Vec<(String, Slotted)> = read
        .into_iter()
        .filter_map(|name| context.bound.get(name.as_str()).cloned().map(|slotted| (name, slotted)))
        .collect();
    let (_, body) = statements::function(context, name, function)?;
    Ok(context.dialect.entry(name, &body, &bound))
}

/// Prints a declaration. `is_made` is true if the code constructs values of the structure from members.
fn declaration(context: &mut Context<'_>, item: &Item, is_made: bool) -> Result<Option<String>, Fault> {
    let name = &item.name;
    match &item.kind {
        ItemKind::Struct { members, fields } => {
            let mut pieces = Vec::new();
            for member in members {
                let declared = context.dialect.declared(&context.member(&member.name), &member.ty);
                match &member.comma {
                    Some(comma) => pieces.extend([(member.span.clone(), declared), (comma.clone(), ";".to_owned())]),
                    None => pieces.push((member.span.clone(), declared + ";")),
                }
            }
            let maker =
                context.members(name).filter(|_| is_made).and_then(|members| context.dialect.maker(name, &members));
            let maker = maker.map_or_else(String::new, |maker| format!("\n\n{maker}"));
            Ok(Some(format!("struct {name} {};{maker}", context.woven(fields, &pieces))))
        }
        ItemKind::Constant { ty, value: given } => {
            context.without_comment(item.span.start..given.span.start)?;
            let piece = value(context, given)?;
            let ty = ty.clone().unwrap_or_else(|| piece.ty.concrete());
            let declared = context.dialect.declared(name, &ty);
            context.constants.insert(name.clone(), ty);
            Ok(Some(format!("{}{declared} = {};", context.dialect.constant(), piece.text)))
        }
        ItemKind::Override => Err(Fault::new(item.span.start, format!("the override «{name}» has no value"))),
        ItemKind::Global(_) if context.dialect.passes_what_is_bound() => Ok(None),
        ItemKind::Global(_) => {
            Ok(context.bound.get(name.as_str()).and_then(|slotted| context.dialect.global(name, slotted)))
        }
        ItemKind::Function(function) => {
            let (parameters, body) = statements::function(context, name, function)?;
            let result = function.returns.as_ref().map_or_else(|| "void".to_owned(), |ty| context.dialect.ty(ty));
            Ok(Some(format!("{result} {name}{parameters} {body}")))
        }
    }
}

/// The text with comments that start with two slashes, as in all printed languages.
fn commented(text: &str) -> String {
    let line = |line: &str| match line.trim_start().strip_prefix("///") {
        Some(rest) => format!("{}//{rest}\n", &line[..line.len() - line.trim_start().len()]),
        None => format!("{line}\n"),
    };
    text.lines().map(line).collect()
}

#[cfg(test)]
mod tests;
