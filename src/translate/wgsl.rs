//! The subset of WGSL in which `shaders/` is written, as a syntax tree over its own text.
//!
//! Each node stores its position in the text. Comments and blanks are between nodes and stay in the text.
//!
//! Invariants: knows no other language; hostile source gives a [`Fault`], never a panic.

mod fold;
mod lexer;
mod parser;
mod statements;
mod stream;
mod syntax;

pub(crate) use fold::folded;
pub(crate) use lexer::{Fault, Kind, Span, Token};
pub(crate) use parser::parse;
pub(crate) use syntax::{
    Block, Call, Callee, Expr, ExprKind, Function, Item, ItemKind, Module, Resource, Scalar, Statement, StatementKind,
    Texture, Type, matrix, vector,
};
