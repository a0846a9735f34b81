//! Branches whose condition is known, resolved.
//!
//! naga's backends keep them, and with them the sampler and whatever else only the branch not taken uses.

use naga::{Arena, Block, Expression, Handle, Literal, Module, Statement};

/// Puts the branch taken in the place of every `if` whose condition is known. The module is to be compacted afterwards.
pub(super) fn known_branches(module: &mut Module) {
    let constants = module.clone();
    let functions = module.functions.iter_mut().map(|(_, function)| function);
    for function in functions.chain(module.entry_points.iter_mut().map(|entry| &mut entry.function)) {
        function.body = folded(std::mem::take(&mut function.body), &function.expressions, &constants);
    }
}

fn folded(block: Block, expressions: &Arena<Expression>, module: &Module) -> Block {
    let within = |block: Block| folded(block, expressions, module);
    let mut result = Block::new();
    for (statement, span) in block.span_into_iter() {
        match statement {
            Statement::If { condition, accept, reject } => match known(condition, expressions, module) {
                Some(taken) => result.extend_block(within(if taken { accept } else { reject })),
                None => {
                    result.push(Statement::If { condition, accept: within(accept), reject: within(reject) }, span);
                }
            },
            Statement::Block(inner) => result.push(Statement::Block(within(inner)), span),
            Statement::Loop { body, continuing, break_if } => {
                let (body, continuing) = (within(body), within(continuing));
                result.push(Statement::Loop { body, continuing, break_if }, span);
            }
            other => result.push(other, span),
        }
    }
    result
}

/// The value of a condition that is a literal or a constant.
fn known(condition: Handle<Expression>, expressions: &Arena<Expression>, module: &Module) -> Option<bool> {
    match &expressions[condition] {
        Expression::Literal(Literal::Bool(value)) => Some(*value),
        Expression::Constant(constant) => known(module.constants[*constant].init, &module.global_expressions, module),
        _ => None,
    }
}
