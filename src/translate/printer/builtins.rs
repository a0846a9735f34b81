//! The supported built-in functions of WGSL, and their result types.

use crate::wgsl::{Scalar, Type};

/// Functions whose result has the type of their first argument, separated by blanks.
const SHAPED: &str = "abs acos asin atan atan2 ceil clamp cos cross exp exp2 floor fma fract inverseSqrt log log2 max min mix \
    normalize pow reflect round saturate select sign sin smoothstep sqrt step tan transpose trunc";
/// Functions that return a scalar.
const FLAT: &str = "determinant distance dot length";
const OTHERS: &str = "all any textureLoad textureSampleLevel";

/// Whether a variable with this name would hide a function.
pub(super) fn is_builtin(name: &str) -> bool {
    [SHAPED, FLAT, OTHERS].iter().any(|names| has_word(names, name))
}

/// Whether a word is in a list separated by blanks.
pub(super) fn has_word(words: &str, word: &str) -> bool {
    words.split(' ').any(|known| known == word)
}

/// The result type of a function for these argument types.
pub(super) fn result(name: &str, arguments: &[&Type]) -> Option<Type> {
    let joined = || arguments.iter().filter_map(|ty| ty.scalar()).reduce(Scalar::join);
    match name {
        "transpose" => match arguments {
            [Type::Matrix { columns, rows }] => Some(Type::Matrix { columns: *rows, rows: *columns }),
            _ => None,
        },
        "select" => match arguments {
            [no, yes, Type::Scalar(Scalar::Bool) | Type::Vector(_, Scalar::Bool)] => {
                Some(no.scalar().zip(yes.scalar()).map_or_else(|| (*no).clone(), |(no_, yes)| no.of(no_.join(yes))))
            }
            _ => None,
        },
        "all" | "any" => (arguments.len() == 1).then_some(Type::BOOL),
        "textureLoad" | "textureSampleLevel" => {
            let least = if name == "textureLoad" { 3 } else { 4 };
            let is_read = arguments.len() >= least && matches!(arguments[0], Type::Texture(_));
            is_read.then_some(Type::Vector(4, Scalar::F32))
        }
        _ if has_word(FLAT, name) => joined().map(Type::Scalar),
        _ if has_word(SHAPED, name) => joined().and_then(|scalar| arguments.first().map(|ty| ty.of(scalar))),
        _ => None,
    }
}
