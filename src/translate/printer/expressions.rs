//! Expressions and their types.

use super::{
    builtins,
    context::Context,
    dialect::{Builtin, Piece, Precedence},
};
use crate::wgsl::{Call, Callee, Expr, ExprKind, Fault, Scalar, Span, Type, matrix, vector};

/// Prints an expression of the source. Parts that both languages write in the same way are copied, with blanks and
/// comments.
pub(super) fn expression(context: &Context<'_>, of: &Expr) -> Result<Piece, Fault> {
    let unknown = |reason: String| Fault::new(of.span.start, reason);
    match &of.kind {
        ExprKind::Number => Ok(number(context.source(of.span.clone()))),
        ExprKind::Bool => Ok(Piece::tight(context.source(of.span.clone()), Type::BOOL)),
        ExprKind::Name(name) => match context.local(name) {
            Some(local) => Ok(Piece::tight(local.name.clone(), local.ty.clone())),
            None => match (context.constants.get(name), context.bound.get(name.as_str())) {
                (Some(ty), _) => Ok(Piece::tight(name.clone(), ty.clone())),
                (_, Some(slotted)) => Ok(Piece::tight(context.dialect.bound(name, slotted), slotted.bound.ty.clone())),
                _ => Err(unknown(format!("«{name}» is not declared"))),
            },
        },
        ExprKind::Paren(inner) => {
            let piece = expression(context, inner)?;
            // A dereferenced variable loses its asterisk, so it needs no brackets.
            if matches!(inner.kind, ExprKind::Unary('*', _)) {
                return Ok(piece);
            }
            Ok(Piece::tight(context.woven(&of.span, &[(inner.span.clone(), piece.text)]), piece.ty))
        }
        ExprKind::Unary(sign, inner) => unary(context, of, *sign, inner),
        ExprKind::Binary(sign, left, right) => binary(context, of, sign, left, right),
        ExprKind::Index(base, index) => {
            let (found, at) = (expression(context, base)?, expression(context, index)?);
            let ty = match &found.ty {
                Type::Array(of, _) => (**of).clone(),
                Type::Pointer(of) => match &**of {
                    Type::Array(of, _) => (**of).clone(),
                    _ => return Err(unknown("this value has no elements".to_owned())),
                },
                Type::Vector(_, scalar) => Type::Scalar(*scalar),
                Type::Matrix { rows, .. } => Type::Vector(*rows, Scalar::F32),
                _ => return Err(unknown("this value has no elements".to_owned())),
            };
            let pieces = [(base.span.clone(), found.within(Precedence::Tight)), (index.span.clone(), at.text)];
            Ok(Piece::tight(context.woven(&of.span, &pieces), ty))
        }
        ExprKind::Field(base, name) => {
            let found = expression(context, base)?;
            let (ty, named) = match &found.ty {
                Type::Struct(of) => (context.member_type(of, name), context.member(name)),
                Type::Vector(_, scalar) => (swizzled(name, *scalar), name.clone()),
                _ => (None, name.clone()),
            };
            let ty = ty.ok_or_else(|| unknown(format!("this value has no member «{name}»")))?;
            let end = of.span.end - name.len()..of.span.end;
            Ok(Piece::tight(
                context.woven(&of.span, &[(base.span.clone(), found.within(Precedence::Tight)), (end, named)]),
                ty,
            ))
        }
        ExprKind::Call(call) => called(context, of, call),
    }
}

/// A number without suffixes that other languages do not have.
fn number(text: &str) -> Piece {
    let is_hex = text.starts_with("0x");
    let scalar = match text.chars().last() {
        Some('u') => Scalar::U32,
        Some('i') => Scalar::I32,
        Some('f') if !is_hex => Scalar::F32,
        _ if !is_hex && text.contains(['.', 'e', 'E']) => Scalar::AbstractFloat,
        _ => Scalar::AbstractInt,
    };
    let plain = if matches!(scalar, Scalar::I32 | Scalar::F32) { &text[..text.len() - 1] } else { text };
    let point = if scalar == Scalar::F32 && !plain.contains(['.', 'e', 'E']) { ".0" } else { "" };
    Piece::tight(format!("{plain}{point}"), Type::Scalar(scalar))
}

fn swizzled(name: &str, scalar: Scalar) -> Option<Type> {
    let is_swizzle = name.chars().all(|c| "xyzw".contains(c)) || name.chars().all(|c| "rgba".contains(c));
    match u8::try_from(name.len()).ok().filter(|_| is_swizzle)? {
        1 => Some(Type::Scalar(scalar)),
        size @ 2..=4 => Some(Type::Vector(size, scalar)),
        _ => None,
    }
}

fn unary(context: &Context<'_>, of: &Expr, sign: char, inner: &Expr) -> Result<Piece, Fault> {
    let piece = expression(context, inner)?;
    match (sign, &piece.ty) {
        // A reference replaces the pointer.
        ('&', _) => Ok(Piece { ty: Type::Pointer(Box::new(piece.ty)), ..piece }),
        ('*', Type::Pointer(to)) => Ok(Piece { ty: (**to).clone(), ..piece }),
        ('*', _) => Err(Fault::new(of.span.start, "this is not a pointer")),
        ('!', Type::Vector(..)) => Err(Fault::new(of.span.start, "the operator ! is not supported for vectors")),
        _ => {
            let text = context.woven(&of.span, &[(inner.span.clone(), piece.within(Precedence::Operator))]);
            Ok(Piece { text, ty: piece.ty, precedence: Precedence::Operator })
        }
    }
}

fn binary(context: &Context<'_>, of: &Expr, sign: &str, left: &Expr, right: &Expr) -> Result<Piece, Fault> {
    let pieces = [left, right].map(|side| expression(context, side));
    let [Ok(first), Ok(second)] = &pieces else {
        let mut faults = pieces.into_iter().filter_map(Result::err);
        return Err(faults.next().unwrap_or_else(|| Fault::new(of.span.start, "an operator without operands")));
    };
    let is_comparison = ["==", "!=", "<", "<=", ">", ">="].contains(&sign);
    let ty = result_of(sign, &first.ty, &second.ty)
        .ok_or_else(|| Fault::new(of.span.start, format!("«{sign}» does not take operands of these types")))?;
    let otherwise = if is_comparison && first.is_vector() {
        context.dialect.compared(sign, first, second)
    } else if sign == "*" && is_product(&first.ty, &second.ty) {
        let [bare_first, bare_second] =
            [(left, first), (right, second)].map(|(side, piece)| bare(context, side, piece));
        context.dialect.product(&bare_first?, &bare_second?)
    } else if sign == "%" && matches!(ty.scalar(), Some(Scalar::F32 | Scalar::AbstractFloat)) {
        let call = Builtin { name: sign, arguments: &[first.clone(), second.clone()], result: &ty };
        context.dialect.builtin(&call).map(|piece| piece.text)
    } else {
        None
    };
    if let Some(text) = otherwise {
        context.without_comment(left.span.end..right.span.start)?;
        return Ok(Piece::tight(text, ty));
    }
    let within = |side: &Expr, piece: &Piece| (side.span.clone(), piece.within(Precedence::Operator));
    let text = context.woven(&of.span, &[within(left, first), within(right, second)]);
    Ok(Piece { text, ty, precedence: Precedence::Operator })
}

/// An operand that becomes an argument. Brackets around it are removed.
fn bare(context: &Context<'_>, side: &Expr, piece: &Piece) -> Result<Piece, Fault> {
    match &side.kind {
        ExprKind::Paren(inner) if context.without_comment(side.span.clone()).is_ok() => expression(context, inner),
        _ => Ok(piece.clone()),
    }
}

/// Whether a product has a matrix and no scalar as operands.
fn is_product(left: &Type, right: &Type) -> bool {
    let is_matrix = |ty: &Type| matches!(ty, Type::Matrix { .. });
    let is_scalar = |ty: &Type| matches!(ty, Type::Scalar(_));
    (is_matrix(left) && !is_scalar(right)) || (is_matrix(right) && !is_scalar(left))
}

fn result_of(sign: &str, left: &Type, right: &Type) -> Option<Type> {
    let scalar = left.scalar()?.join(right.scalar()?);
    let shape = match (left, right) {
        (Type::Matrix { columns, .. }, Type::Vector(size, _)) if sign == "*" => {
            let Type::Matrix { rows, .. } = left else { return None };
            return (columns == size).then_some(Type::Vector(*rows, Scalar::F32));
        }
        (Type::Vector(size, _), Type::Matrix { columns, rows }) if sign == "*" => {
            return (rows == size).then_some(Type::Vector(*columns, Scalar::F32));
        }
        (Type::Matrix { columns: inner, rows }, Type::Matrix { columns, rows: height }) if sign == "*" => {
            return (inner == height).then_some(Type::Matrix { columns: *columns, rows: *rows });
        }
        (Type::Scalar(_), shape) | (shape, Type::Scalar(_)) => shape,
        (Type::Vector(a, _), Type::Vector(b, _)) if a == b => left,
        (left, right) if left == right => left,
        _ => return None,
    };
    match sign {
        "==" | "!=" | "<" | "<=" | ">" | ">=" => Some(shape.of(Scalar::Bool)),
        "<<" | ">>" => Some(left.clone()),
        _ => Some(shape.of(scalar)),
    }
}

fn called(context: &Context<'_>, of: &Expr, call: &Call) -> Result<Piece, Fault> {
    let arguments: Vec<Piece> =
        call.arguments.iter().map(|argument| expression(context, argument)).collect::<Result<_, _>>()?;
    let types: Vec<&Type> = arguments.iter().map(|piece| &piece.ty).collect();
    let woven = |more: &[String]| in_brackets(context, call, &arguments, more);
    let unknown = |reason: &str| Fault::new(of.span.start, reason.to_owned());
    let name = match &call.callee {
        Callee::Type(ty) => return constructed(context, of, call, ty, &arguments),
        Callee::Bitcast(result) => return builtin(context, of, call, "bitcast", &arguments, result),
        Callee::Name(name) => name.as_str(),
    };
    if let Some(function) = context.functions.get(name) {
        let result = function.returns.clone().unwrap_or_else(|| Type::Struct("void".to_owned()));
        let read = context.read.get(name).cloned().unwrap_or_default();
        return Ok(Piece::tight(format!("{name}{}", woven(&read)), result));
    }
    if context.members(name).is_some() {
        let ty = Type::Struct(name.to_owned());
        let text = if arguments.is_empty() { context.zero(&ty) } else { context.dialect.structure(name, &woven(&[])) };
        let precedence = if arguments.is_empty() { Precedence::Operator } else { Precedence::Tight };
        return Ok(Piece { text, ty, precedence });
    }
    if let Some(ty) = inferred(name, &types) {
        return constructed(context, of, call, &ty, &arguments);
    }
    if name == "select" && matches!(types[..], [_, _, Type::Scalar(_)]) {
        context.without_comment(call.span.clone())?;
        let [no, yes, condition] = [0, 1, 2].map(|number: usize| arguments[number].within(Precedence::Operator));
        let ty = builtins::result(name, &types).ok_or_else(|| unknown("select does not take these types"))?;
        return Ok(Piece { text: format!("{condition} ? {yes} : {no}"), ty, precedence: Precedence::Choice });
    }
    let result =
        builtins::result(name, &types).ok_or_else(|| unknown(&format!("«{name}» is not known for these types")))?;
    builtin(context, of, call, name, &arguments, &result)
}

/// The arguments of a call in brackets, with the arguments `more` at the end.
fn in_brackets(context: &Context<'_>, call: &Call, arguments: &[Piece], more: &[String]) -> String {
    let mut pieces: Vec<(Span, String)> = call
        .arguments
        .iter()
        .zip(arguments)
        .map(|(argument, piece)| (argument.span.clone(), piece.text.clone()))
        .collect();
    let more = more.join(", ");
    match pieces.last_mut() {
        Some((_, last)) if !more.is_empty() => last.extend([", ", &more]),
        None if !more.is_empty() => pieces.push((call.span.end - 1..call.span.end - 1, more)),
        _ => {}
    }
    pieces.extend(call.comma.clone().map(|comma| (comma, String::new())));
    context.woven(&call.span, &pieces)
}

fn builtin(
    context: &Context<'_>,
    of: &Expr,
    call: &Call,
    name: &str,
    arguments: &[Piece],
    result: &Type,
) -> Result<Piece, Fault> {
    if name == "select" && result.scalar().is_some_and(|scalar| scalar.concrete() != Scalar::F32) {
        return Err(Fault::new(of.span.start, "select by components does not take integers"));
    }
    if let Some(piece) = context.dialect.builtin(&Builtin { name, arguments, result }) {
        context.without_comment(call.span.clone())?;
        return Ok(piece);
    }
    let named = context.dialect.renamed(name);
    Ok(Piece::tight(format!("{named}{}", in_brackets(context, call, arguments, &[])), result.clone()))
}

/// The type of `vec3(...)` or `mat3x3(...)`. Its scalar type follows from the arguments.
fn inferred(name: &str, types: &[&Type]) -> Option<Type> {
    let scalar = types.iter().filter_map(|ty| ty.scalar()).reduce(Scalar::join).unwrap_or(Scalar::AbstractFloat);
    let of_vector = vector(name).map(|size| Type::Vector(size, scalar));
    of_vector.or_else(|| matrix(name).map(|(columns, rows)| Type::Matrix { columns, rows }))
}

fn constructed(context: &Context<'_>, of: &Expr, call: &Call, ty: &Type, arguments: &[Piece]) -> Result<Piece, Fault> {
    if let Type::Array(..) = ty {
        return Err(Fault::new(of.span.start, "an array can only be the value of a variable"));
    }
    if arguments.is_empty() {
        return Ok(Piece { text: context.zero(ty), ty: ty.clone(), precedence: Precedence::Operator });
    }
    if let Some(piece) = context.dialect.vector(ty, arguments) {
        context.without_comment(call.span.clone())?;
        return Ok(piece);
    }
    let text = format!("{}{}", context.dialect.ty(ty), in_brackets(context, call, arguments, &[]));
    Ok(Piece::tight(text, ty.clone()))
}

/// The value of a variable: an expression, or a list of array elements.
pub(super) fn value(context: &Context<'_>, of: &Expr) -> Result<Piece, Fault> {
    let ExprKind::Call(call) = &of.kind else { return expression(context, of) };
    let Callee::Type(ty @ Type::Array(element, count)) = &call.callee else { return expression(context, of) };
    let arguments: Vec<Piece> =
        call.arguments.iter().map(|argument| expression(context, argument)).collect::<Result<_, _>>()?;
    let text = if arguments.is_empty() {
        context.zero(ty)
    } else {
        context.dialect.array(element, *count, &in_brackets(context, call, &arguments, &[]))
    };
    Ok(Piece::tight(text, ty.clone()))
}
