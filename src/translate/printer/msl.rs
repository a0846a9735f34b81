//! Metal Shading Language 2.0.
//!
//! There are no global bindings: functions take resources as arguments, and arrays by reference.

use super::dialect::{Builtin, Dialect, Members, Piece, Precedence, Slotted, inside, sized_name, zero_scalar};
use crate::wgsl::{Texture, Type};

#[derive(Debug, Clone, Copy)]
pub(super) struct Msl;

impl Dialect for Msl {
    fn reserved(&self) -> &'static str {
        "access alignas alignof and asm assert auto bias bitand bitor bool break case catch char class compl const \
         const_cast constant constexpr continue decltype default delete device discard_fragment do double else enum \
         explicit export extern false float for fragment friend goto half if inline int kernel level long mutable \
         namespace new noexcept not nullptr operator or private protected public register return sampler short signed \
         sizeof static static_assert struct switch template texture this thread threadgroup throw true try typedef \
         typeid typename uchar uint ulong union unsigned ushort using vec vertex virtual void volatile while xor"
    }

    fn functions(&self) -> &'static str {
        "as_type fmod rsqrt"
    }

    fn opening(&self) -> &'static str {
        "#include <metal_stdlib>\nusing namespace metal;\n\n"
    }

    fn ty(&self, ty: &Type) -> String {
        sized_name(ty).unwrap_or_else(|| match ty {
            Type::Array(of, _) | Type::Pointer(of) => self.ty(of),
            Type::Texture(Texture::Plane) => "texture2d<float>".to_owned(),
            Type::Texture(Texture::Volume) => "texture3d<float>".to_owned(),
            Type::Texture(Texture::Layers) => "texture2d_array<float>".to_owned(),
            _ => "sampler".to_owned(),
        })
    }

    fn constant(&self) -> &'static str {
        "constant "
    }

    fn global(&self, name: &str, Slotted { bound, .. }: &Slotted) -> Option<String> {
        let space = if bound.is_written { "device" } else { "constant" };
        let is_buffer = matches!(bound.ty, Type::Struct(_) | Type::Vector(..));
        Some(if is_buffer { format!("{space} {}& {name}", self.ty(&bound.ty)) } else { self.declared(name, &bound.ty) })
    }

    fn entry(&self, name: &str, body: &str, bound: &[(String, Slotted)]) -> String {
        let parameter = |(name, slotted): &(String, Slotted)| {
            let kind = match slotted.bound.ty {
                Type::Texture(_) => "texture",
                Type::Sampler => "sampler",
                _ => "buffer",
            };
            Some(format!("    {} [[{kind}({})]]", self.global(name, slotted)?, slotted.slot))
        };
        let parameters: Vec<String> = bound.iter().filter_map(parameter).collect();
        format!("kernel void {name}(\n{}\n) {body}", parameters.join(",\n"))
    }

    fn passes_what_is_bound(&self) -> bool {
        true
    }

    fn parameter(&self, name: &str, ty: &Type, is_written: bool) -> String {
        let constant = if is_written { "" } else { "const " };
        match ty {
            Type::Pointer(of) if !matches!(**of, Type::Array(..)) => {
                format!("thread {constant}{}& {name}", self.ty(of))
            }
            Type::Pointer(of) => self.parameter(name, of, is_written),
            Type::Array(of, count) => format!("thread {constant}{} (&{name})[{count}]", self.ty(of)),
            other => self.declared(name, other),
        }
    }

    fn alias(&self, name: &str, ty: &Type) -> Option<String> {
        Some(self.parameter(name, ty, false))
    }

    fn zero(&self, ty: &Type, _: &dyn Fn(&str) -> Members) -> String {
        match ty {
            Type::Scalar(scalar) => zero_scalar(*scalar).to_owned(),
            Type::Array(..) => "{}".to_owned(),
            Type::Vector(_, scalar) => format!("{}({})", self.ty(ty), zero_scalar(*scalar)),
            Type::Matrix { .. } => format!("{}(0.0)", self.ty(ty)),
            _ => format!("{} {{}}", self.ty(ty)),
        }
    }

    fn structure(&self, name: &str, arguments: &str) -> String {
        format!("{name} {{{}}}", inside(arguments))
    }

    fn array(&self, _: &Type, _: u32, arguments: &str) -> String {
        format!("{{ {} }}", inside(arguments).trim())
    }

    fn vector(&self, ty: &Type, arguments: &[Piece]) -> Option<Piece> {
        let Type::Matrix { columns, rows } = ty else { return None };
        if arguments.len() != usize::from(*columns) * usize::from(*rows) {
            return None;
        }
        let column = |column: &[Piece]| {
            let numbers: Vec<&str> = column.iter().map(|piece| piece.text.as_str()).collect();
            format!("float{rows}({})", numbers.join(", "))
        };
        let columns: Vec<String> = arguments.chunks(usize::from(*rows)).map(column).collect();
        Some(Piece::tight(format!("{}({})", self.ty(ty), columns.join(", ")), ty.clone()))
    }

    fn builtin(&self, call: &Builtin<'_>) -> Option<Piece> {
        let text = |number| call.text(number);
        let made = |text: String| Some(Piece::tight(text, call.result.clone()));
        match call.name {
            "bitcast" => made(format!("as_type<{}>({})", self.ty(call.result), text(0))),
            "textureLoad" => {
                let rest: Vec<&str> = (1..call.arguments.len()).map(text).collect();
                made(format!("{}.read({})", text(0), rest.join(", ")))
            }
            "textureSampleLevel" => {
                let (level, place) = call.arguments.split_last()?;
                let rest: Vec<&str> = place.iter().skip(1).map(|piece| piece.text.as_str()).collect();
                made(format!("{}.sample({}, level({}))", text(0), rest.join(", "), level.text))
            }
            "%" => {
                let [left, right] = [0, 1].map(|number| call.arguments[number].within(Precedence::Choice));
                made(format!("fmod({left}, {right})"))
            }
            _ => None,
        }
    }

    fn renamed<'a>(&self, name: &'a str) -> &'a str {
        if name == "inverseSqrt" { "rsqrt" } else { name }
    }
}
