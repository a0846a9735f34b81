//! Parses statements.

use super::{
    lexer::Fault,
    stream::Stream,
    syntax::{Block, ExprKind, Statement, StatementKind},
};

pub(super) fn function_body(stream: &mut Stream<'_>) -> Result<Block, Fault> {
    block(stream)
}

fn block(stream: &mut Stream<'_>) -> Result<Block, Fault> {
    stream.deeper(|stream| {
        let start = stream.here();
        stream.expect("{")?;
        let mut statements = Vec::new();
        while !stream.take("}") {
            statements.push(statement(stream)?);
        }
        Ok(Block { statements, span: start..stream.before() })
    })
}

/// Parses a statement. Consumes its semicolon, but excludes it from the span.
fn statement(stream: &mut Stream<'_>) -> Result<Statement, Fault> {
    let start = stream.here();
    let kind = if stream.is_next("{") {
        StatementKind::Block(block(stream)?)
    } else if stream.is_next("if") {
        return conditional(stream);
    } else if stream.take("for") {
        stream.expect("(")?;
        let begin = if stream.is_next(";") { None } else { Some(Box::new(simple(stream)?)) };
        stream.expect(";")?;
        let condition = if stream.is_next(";") { None } else { Some(stream.expression()?) };
        stream.expect(";")?;
        let step = if stream.is_next(")") { None } else { Some(Box::new(simple(stream)?)) };
        stream.expect(")")?;
        StatementKind::For { start: begin, condition, step, body: block(stream)? }
    } else {
        let simple = simple(stream)?;
        stream.expect(";")?;
        return Ok(simple);
    };
    Ok(Statement { kind, span: start..stream.before() })
}

fn conditional(stream: &mut Stream<'_>) -> Result<Statement, Fault> {
    stream.deeper(|stream| {
        let start = stream.here();
        stream.expect("if")?;
        let condition = stream.expression()?;
        let accept = block(stream)?;
        let reject = if stream.take("else") {
            let at = stream.here();
            Some(Box::new(if stream.is_next("if") {
                conditional(stream)?
            } else {
                let block = block(stream)?;
                Statement { span: at..block.span.end, kind: StatementKind::Block(block) }
            }))
        } else {
            None
        };
        Ok(Statement { kind: StatementKind::If { condition, accept, reject }, span: start..stream.before() })
    })
}

/// Parses a simple statement: one that can be in the head of a loop, or that ends with a semicolon.
fn simple(stream: &mut Stream<'_>) -> Result<Statement, Fault> {
    const ASSIGNMENTS: [&str; 9] = ["=", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^="];
    let start = stream.here();
    let kind = if stream.take("let") || stream.take("var") {
        let name = stream.word()?.to_owned();
        let ty = stream.take(":").then(|| stream.ty()).transpose()?;
        let value = stream.take("=").then(|| stream.expression()).transpose()?;
        if ty.is_none() && value.is_none() {
            return Err(stream.unexpected("«:» or «=»"));
        }
        StatementKind::Declare { name, ty, value }
    } else if stream.take("return") {
        StatementKind::Return(if stream.is_next(";") { None } else { Some(stream.expression()?) })
    } else if stream.take("break") || stream.take("continue") {
        StatementKind::Leave
    } else {
        let target = stream.expression()?;
        if stream.take("++") || stream.take("--") {
            StatementKind::Step(target)
        } else if ASSIGNMENTS.iter().any(|sign| stream.take(sign)) {
            StatementKind::Assign { target, value: stream.expression()? }
        } else if matches!(target.kind, ExprKind::Call(_)) {
            StatementKind::Call(target)
        } else {
            return Err(stream.unexpected("an assignment or a call"));
        }
    };
    Ok(Statement { kind, span: start..stream.before() })
}
