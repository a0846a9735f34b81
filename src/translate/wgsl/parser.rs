//! Parses tokens into types and declarations.

use super::{
    lexer::{Fault, Span, tokens},
    statements::function_body,
    stream::Stream,
    syntax::{Field, Function, Item, ItemKind, Module, Parameter, Resource},
};

/// Parses the declarations of a source.
pub(crate) fn parse(source: &str) -> Result<Module<'_>, Fault> {
    let tokens = tokens(source)?;
    let mut stream = Stream::new(source, &tokens);
    let mut items = Vec::new();
    while !stream.is_at_end() {
        items.push(item(&mut stream)?);
    }
    Ok(Module { source, tokens, items })
}

fn item(stream: &mut Stream<'_>) -> Result<Item, Fault> {
    let start = stream.here();
    let (group, binding) = place(stream)?;
    let keyword = stream.word()?;
    let (name, kind) = match keyword {
        "fn" => {
            let (name, function) = function(stream)?;
            (name, ItemKind::Function(function))
        }
        "struct" => {
            let name = stream.word()?.to_owned();
            let (members, fields) = members(stream)?;
            (name, ItemKind::Struct { members, fields })
        }
        "const" => {
            let name = stream.word()?.to_owned();
            let ty = stream.take(":").then(|| stream.ty()).transpose()?;
            stream.expect("=")?;
            let value = stream.expression()?;
            stream.expect(";")?;
            (name, ItemKind::Constant { ty, value })
        }
        "override" => {
            let name = stream.word()?.to_owned();
            while !stream.take(";") {
                stream.next()?;
            }
            (name, ItemKind::Override)
        }
        "var" => {
            let mut is_written = false;
            if stream.take("<") {
                while !stream.take(">") {
                    is_written |= stream.next()? == "read_write";
                }
            }
            let name = stream.word()?.to_owned();
            stream.expect(":")?;
            let ty = stream.ty()?;
            stream.expect(";")?;
            let binding = binding.ok_or_else(|| Fault::new(start, format!("{name} has no binding")))?;
            (name, ItemKind::Global(Resource { ty, group: group.unwrap_or(0), binding, is_written }))
        }
        other => return Err(Fault::new(stream.before(), format!("«{other}» does not start a known declaration"))),
    };
    Ok(Item { name, kind, span: start..stream.before() })
}

/// Skips attributes, and returns the group and binding numbers.
fn place(stream: &mut Stream<'_>) -> Result<(Option<u32>, Option<u32>), Fault> {
    let (mut group, mut binding) = (None, None);
    while stream.take("@") {
        let name = stream.word()?;
        if stream.take("(") {
            let at = stream.here();
            let value = stream.next()?;
            let number = || value.parse().map(Some).map_err(|_| Fault::new(at, format!("the {name} must be a number")));
            match name {
                "group" => group = number()?,
                "binding" => binding = number()?,
                _ => {}
            }
            while !stream.take(")") {
                stream.next()?;
            }
        }
    }
    Ok((group, binding))
}

fn members(stream: &mut Stream<'_>) -> Result<(Vec<Field>, Span), Fault> {
    let start = stream.here();
    stream.expect("{")?;
    let mut members = Vec::new();
    while !stream.take("}") {
        let at = stream.here();
        let name = stream.word()?.to_owned();
        stream.expect(":")?;
        let ty = stream.ty()?;
        let span = at..stream.before();
        let comma = stream.taken(",");
        if comma.is_none() && !stream.is_next("}") {
            return Err(stream.unexpected("«,» or «}»"));
        }
        members.push(Field { name, ty, span, comma });
    }
    Ok((members, start..stream.before()))
}

fn function(stream: &mut Stream<'_>) -> Result<(String, Function), Fault> {
    let name = stream.word()?.to_owned();
    let start = stream.here();
    stream.expect("(")?;
    let (mut parameters, mut comma) = (Vec::new(), None);
    while !stream.take(")") {
        place(stream)?;
        let at = stream.here();
        let name = stream.word()?.to_owned();
        stream.expect(":")?;
        let ty = stream.ty()?;
        parameters.push(Parameter { name, ty, span: at..stream.before() });
        comma = stream.taken(",");
        if comma.is_none() && !stream.is_next(")") {
            return Err(stream.unexpected("«,» or «)»"));
        }
    }
    // This is the comma after the last parameter, because a parenthesis follows.
    let span = start..stream.before();
    let mut returns = None;
    if stream.take("->") {
        place(stream)?;
        returns = Some(stream.ty()?);
    }
    let body = function_body(stream)?;
    Ok((name, Function { parameters, span, comma, returns, body }))
}
