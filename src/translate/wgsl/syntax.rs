//! The syntax tree.

use super::lexer::{Span, Token};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Scalar {
    Bool,
    F32,
    I32,
    U32,
    /// A number without a suffix. It takes the type of the other operand.
    AbstractInt,
    AbstractFloat,
}

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Texture {
    /// `texture_2d<f32>`.
    Plane,
    /// `texture_3d<f32>`.
    Volume,
    /// `texture_2d_array<f32>`.
    Layers,
}

impl Texture {
    /// The number of coordinates of a texel. They include the layer.
    pub(crate) fn coordinates(self) -> usize {
        if self == Self::Plane { 2 } else { 3 }
    }
}

#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) enum Type {
    Scalar(Scalar),
    Vector(u8, Scalar),
    Matrix {
        columns: u8,
        rows: u8,
    },
    Array(Box<Type>, u32),
    Struct(String),
    /// A pointer to a variable of a function.
    Pointer(Box<Type>),
    Texture(Texture),
    Sampler,
}

#[derive(Debug, Clone)]
pub(crate) struct Expr {
    pub(crate) kind: ExprKind,
    pub(crate) span: Span,
    /// The number of nodes from this node down to the deepest leaf.
    pub(crate) depth: u32,
}

#[derive(Debug, Clone)]
pub(crate) enum ExprKind {
    Number,
    Bool,
    Name(String),
    Paren(Box<Expr>),
    Unary(char, Box<Expr>),
    Binary(&'static str, Box<Expr>, Box<Expr>),
    Index(Box<Expr>, Box<Expr>),
    Field(Box<Expr>, String),
    Call(Call),
}

#[derive(Debug, Clone)]
pub(crate) struct Call {
    pub(crate) callee: Callee,
    pub(crate) arguments: Vec<Expr>,
    /// The range from `(` to `)`.
    pub(crate) span: Span,
    /// The comma after the last argument.
    pub(crate) comma: Option<Span>,
}

#[derive(Debug, Clone)]
pub(crate) enum Callee {
    /// A function, a structure, or a vector or matrix whose scalar type follows from the arguments.
    Name(String),
    /// A type with its parameters, such as `vec2<f32>`.
    Type(Type),
    /// `bitcast<T>`.
    Bitcast(Type),
}

#[derive(Debug, Clone)]
pub(crate) struct Block {
    pub(crate) statements: Vec<Statement>,
    /// The range from `{` to `}`.
    pub(crate) span: Span,
}

/// A statement without its semicolon.
#[derive(Debug, Clone)]
pub(crate) struct Statement {
    pub(crate) kind: StatementKind,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) enum StatementKind {
    /// `let` or `var`.
    Declare {
        name: String,
        ty: Option<Type>,
        value: Option<Expr>,
    },
    /// `=`, `+=` and so on.
    Assign {
        target: Expr,
        value: Expr,
    },
    /// `++` or `--`.
    Step(Expr),
    Call(Expr),
    Return(Option<Expr>),
    If {
        condition: Expr,
        accept: Block,
        reject: Option<Box<Statement>>,
    },
    For {
        start: Option<Box<Statement>>,
        condition: Option<Expr>,
        step: Option<Box<Statement>>,
        body: Block,
    },
    Block(Block),
    /// `break` or `continue`.
    Leave,
}

#[derive(Debug, Clone)]
pub(crate) struct Field {
    pub(crate) name: String,
    pub(crate) ty: Type,
    /// The range of the name and the type.
    pub(crate) span: Span,
    pub(crate) comma: Option<Span>,
}

#[derive(Debug, Clone)]
pub(crate) struct Parameter {
    pub(crate) name: String,
    pub(crate) ty: Type,
    pub(crate) span: Span,
}

#[derive(Debug, Clone)]
pub(crate) struct Function {
    pub(crate) parameters: Vec<Parameter>,
    /// The range of the parameters from `(` to `)`.
    pub(crate) span: Span,
    pub(crate) comma: Option<Span>,
    pub(crate) returns: Option<Type>,
    pub(crate) body: Block,
}

#[derive(Debug, Clone)]
pub(crate) enum ItemKind {
    /// `fields` is the range from `{` to `}`.
    Struct {
        members: Vec<Field>,
        fields: Span,
    },
    Constant {
        ty: Option<Type>,
        value: Expr,
    },
    Override,
    Global(Resource),
    Function(Function),
}

#[derive(Debug, Clone)]
pub(crate) struct Item {
    pub(crate) name: String,
    pub(crate) kind: ItemKind,
    /// The range, including attributes and semicolon.
    pub(crate) span: Span,
}

/// A buffer, a texture or a sampler that is bound to a shader.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(crate) struct Resource {
    pub(crate) ty: Type,
    pub(crate) group: u32,
    pub(crate) binding: u32,
    /// Whether the resource is storage that the shader writes to.
    pub(crate) is_written: bool,
}

/// A source text, and its declarations in order.
#[derive(Debug, Clone)]
pub(crate) struct Module<'a> {
    pub(crate) source: &'a str,
    pub(crate) tokens: Vec<Token>,
    pub(crate) items: Vec<Item>,
}

impl Scalar {
    /// The common type of two operands. A number without a suffix takes the type of the other operand.
    pub(crate) fn join(self, other: Self) -> Self {
        match self {
            Self::AbstractInt => other,
            Self::AbstractFloat if other != Self::AbstractInt => other,
            _ => self,
        }
    }

    /// The type of a variable that is initialised with this value.
    pub(crate) fn concrete(self) -> Self {
        match self {
            Self::AbstractInt => Self::I32,
            Self::AbstractFloat => Self::F32,
            other => other,
        }
    }
}

impl Type {
    pub(crate) const FLOAT: Self = Self::Scalar(Scalar::F32);
    pub(crate) const BOOL: Self = Self::Scalar(Scalar::Bool);

    /// The scalar type of the elements.
    pub(crate) fn scalar(&self) -> Option<Scalar> {
        match self {
            Self::Scalar(scalar) | Self::Vector(_, scalar) => Some(*scalar),
            Self::Matrix { .. } => Some(Scalar::F32),
            _ => None,
        }
    }

    /// The same shape with another scalar type.
    pub(crate) fn of(&self, scalar: Scalar) -> Self {
        match self {
            Self::Scalar(_) => Self::Scalar(scalar),
            Self::Vector(size, _) => Self::Vector(*size, scalar),
            other => other.clone(),
        }
    }

    pub(crate) fn concrete(&self) -> Self {
        self.scalar().map_or_else(|| self.clone(), |scalar| self.of(scalar.concrete()))
    }
}

/// The size in a name such as `vec2`, `vec3` or `vec4`.
pub(crate) fn vector(name: &str) -> Option<u8> {
    name.strip_prefix("vec").and_then(size)
}

/// The number of columns and rows in a name such as `mat3x3`.
pub(crate) fn matrix(name: &str) -> Option<(u8, u8)> {
    let (columns, rows) = name.strip_prefix("mat")?.split_once('x')?;
    size(columns).zip(size(rows))
}

fn size(text: &str) -> Option<u8> {
    ["2", "3", "4"].contains(&text).then(|| text.parse().ok()).flatten()
}
