//! The differences between a target language and WGSL.

use crate::wgsl::{Resource, Scalar, Type};

/// The precedence of an expression, from tightest to loosest.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Precedence {
    /// A name, a call, or an expression in brackets.
    Tight,
    /// Operators and casts.
    Operator,
    /// `a ? b : c`.
    Choice,
}

/// An expression in the target language.
#[derive(Debug, Clone)]
pub(super) struct Piece {
    pub(super) text: String,
    pub(super) ty: Type,
    pub(super) precedence: Precedence,
}

impl Piece {
    pub(super) fn tight(text: impl Into<String>, ty: Type) -> Self {
        Self { text: text.into(), ty, precedence: Precedence::Tight }
    }

    /// The text, in brackets if its precedence is looser than `most`.
    pub(super) fn within(&self, most: Precedence) -> String {
        if self.precedence > most { format!("({})", self.text) } else { self.text.clone() }
    }

    pub(super) fn is_vector(&self) -> bool {
        matches!(self.ty, Type::Vector(..))
    }
}

/// A call of a built-in function.
pub(super) struct Builtin<'a> {
    pub(super) name: &'a str,
    pub(super) arguments: &'a [Piece],
    pub(super) result: &'a Type,
}

impl Builtin<'_> {
    /// The text of an argument. Empty if it is missing.
    pub(super) fn text(&self, number: usize) -> &str {
        self.arguments.get(number).map_or("", |piece| &piece.text)
    }

    /// The number of coordinates of a texel. The first argument is the texture.
    pub(super) fn coordinates(&self) -> usize {
        match self.arguments.first().map(|piece| &piece.ty) {
            Some(Type::Texture(texture)) => texture.coordinates(),
            _ => 3,
        }
    }

    /// The arguments from number `from` on, as one vector of type `vector`.
    pub(super) fn joined(&self, vector: &str, from: usize) -> String {
        let parts: Vec<&str> = (from..self.arguments.len()).map(|number| self.text(number)).collect();
        format!("{vector}({})", parts.join(", "))
    }
}

/// A resource, with its number among the resources of the same kind.
#[derive(Debug, Clone)]
pub(super) struct Slotted {
    pub(super) bound: Resource,
    pub(super) slot: usize,
}

/// The members of a structure.
pub(super) type Members = Vec<(String, Type)>;

pub(super) trait Dialect {
    /// Reserved words, separated by blanks.
    fn reserved(&self) -> &'static str;

    /// Functions of the language that have other names in WGSL, separated by blanks. Variables must not hide them.
    fn functions(&self) -> &'static str;

    /// The lines before all declarations.
    fn opening(&self) -> &'static str {
        ""
    }

    /// The name of a type that is not an array.
    fn ty(&self, ty: &Type) -> String;

    /// The keyword before a global constant.
    fn constant(&self) -> &'static str;

    /// The declaration of a resource, or its parameter. `None` if the language has neither.
    fn global(&self, name: &str, bound: &Slotted) -> Option<String>;

    /// How an expression refers to a resource.
    fn bound(&self, name: &str, _bound: &Slotted) -> String {
        name.to_owned()
    }

    /// The entry point of a program with its body. It runs as one thread and reads the resources `bound`.
    fn entry(&self, name: &str, body: &str, bound: &[(String, Slotted)]) -> String;

    /// Whether functions take resources as parameters.
    fn passes_what_is_bound(&self) -> bool {
        false
    }

    /// A parameter of a function. `is_written` is true if the function writes to it.
    fn parameter(&self, name: &str, ty: &Type, is_written: bool) -> String {
        let plain = self.declared(name, ty);
        if is_written { format!("inout {plain}") } else { plain }
    }

    /// A reference to an array, if the language cannot copy arrays.
    fn alias(&self, _name: &str, _ty: &Type) -> Option<String> {
        None
    }

    /// A declaration without a value: type and name.
    fn declared(&self, name: &str, ty: &Type) -> String {
        match ty {
            Type::Array(of, count) => format!("{} {name}[{count}]", self.ty(of)),
            Type::Pointer(of) => self.declared(name, of),
            other => format!("{} {name}", self.ty(other)),
        }
    }

    /// A value with all zeros. `members` returns the members of a structure.
    fn zero(&self, ty: &Type, members: &dyn Fn(&str) -> Members) -> String;

    /// A structure constructed from arguments in brackets.
    fn structure(&self, name: &str, arguments: &str) -> String {
        format!("{name}{arguments}")
    }

    /// The function that constructs a structure, if the language needs one.
    fn maker(&self, _name: &str, _members: &Members) -> Option<String> {
        None
    }

    /// An array constructed from arguments in brackets, as the value of a variable.
    fn array(&self, of: &Type, count: u32, arguments: &str) -> String;

    /// A vector or matrix, if the language does not write it as a type with arguments.
    fn vector(&self, _ty: &Type, _arguments: &[Piece]) -> Option<Piece> {
        None
    }

    /// A call of a built-in function, if the language does not write it as a name with arguments.
    fn builtin(&self, _call: &Builtin<'_>) -> Option<Piece> {
        None
    }

    /// The name of a built-in function.
    fn renamed<'a>(&self, name: &'a str) -> &'a str {
        name
    }

    /// The comparison of vectors, if the language does not write it as an operator.
    fn compared(&self, _sign: &str, _left: &Piece, _right: &Piece) -> Option<String> {
        None
    }

    /// The product of a matrix and a matrix or vector, if the language does not write this product as an operator.
    fn product(&self, _left: &Piece, _right: &Piece) -> Option<String> {
        None
    }
}

/// A scalar zero. All languages write it in the same way.
pub(super) fn zero_scalar(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::Bool => "false",
        Scalar::U32 => "0u",
        Scalar::I32 | Scalar::AbstractInt => "0",
        Scalar::F32 | Scalar::AbstractFloat => "0.0",
    }
}

/// The names of scalar types in C-like languages.
pub(super) fn scalar_name(scalar: Scalar) -> &'static str {
    match scalar {
        Scalar::Bool => "bool",
        Scalar::U32 => "uint",
        Scalar::I32 | Scalar::AbstractInt => "int",
        Scalar::F32 | Scalar::AbstractFloat => "float",
    }
}

/// The name of a type in HLSL and Metal.
pub(super) fn sized_name(ty: &Type) -> Option<String> {
    match ty {
        Type::Scalar(scalar) => Some(scalar_name(*scalar).to_owned()),
        Type::Vector(size, scalar) => Some(format!("{}{size}", scalar_name(*scalar))),
        Type::Matrix { columns, rows } => Some(format!("float{columns}x{rows}")),
        Type::Struct(name) => Some(name.clone()),
        _ => None,
    }
}

/// The arguments of a call without the brackets.
pub(super) fn inside(arguments: &str) -> &str {
    arguments.strip_prefix('(').and_then(|rest| rest.strip_suffix(')')).unwrap_or(arguments)
}
