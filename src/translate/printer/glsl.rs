//! GLSL: 4.50, 3.30 and ES 3.00 for text to include, 4.50 and ES 3.10 for programs.

use super::dialect::{Builtin, Dialect, Members, Piece, Precedence, Slotted, scalar_name, zero_scalar};
use crate::wgsl::{Scalar, Texture, Type};

#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Glsl {
    /// Blocks and textures have binding numbers.
    Desktop450,
    /// Uniforms are outside blocks.
    Desktop330,
    /// Uniforms are outside blocks, and precisions are declared.
    Es300,
    /// Bindings are numbered as in OpenGL, which counts buffers and textures separately.
    Program450,
    /// Bindings are numbered as in OpenGL, and precisions are declared.
    Program310,
}

impl Dialect for Glsl {
    // glslang mistakes a member named `length` for the method of arrays.
    fn reserved(&self) -> &'static str {
        "active asm atomic_uint attribute bool break buffer bvec2 bvec3 bvec4 case cast centroid class coherent \
         common const continue default discard do double else enum extern external false filter fixed flat float for \
         goto half highp hvec2 hvec3 hvec4 if image1D image2D image3D in inline inout input int interface invariant \
         ivec2 ivec3 ivec4 layout length long lowp mat2 mat3 mat4 mediump namespace noinline noperspective out output \
         packed partition patch precise precision public readonly resource restrict return row_major sample sampler2D \
         sampler2DArray sampler3D shared short sizeof smooth static struct subroutine superp switch template texture \
         this true typedef uint uniform union unsigned using uvec2 uvec3 uvec4 varying vec2 vec3 vec4 void volatile \
         while writeonly"
    }

    fn functions(&self) -> &'static str {
        "equal floatBitsToInt floatBitsToUint greaterThan greaterThanEqual intBitsToFloat inverse inversesqrt lessThan \
         lessThanEqual mod not notEqual texelFetch textureLod uintBitsToFloat"
    }

    fn opening(&self) -> &'static str {
        match self {
            Self::Desktop450 | Self::Desktop330 => "",
            Self::Es300 => "precision highp float;\nprecision highp int;\n\n",
            Self::Program450 => "#version 450 core\n",
            Self::Program310 => "#version 310 es\nprecision highp float;\nprecision highp int;\n\n",
        }
    }

    fn ty(&self, ty: &Type) -> String {
        match ty {
            Type::Scalar(scalar) => scalar_name(*scalar).to_owned(),
            Type::Vector(size, scalar) => match scalar.concrete() {
                Scalar::Bool => format!("bvec{size}"),
                Scalar::I32 => format!("ivec{size}"),
                Scalar::U32 => format!("uvec{size}"),
                _ => format!("vec{size}"),
            },
            Type::Matrix { columns, rows } if columns == rows => format!("mat{columns}"),
            Type::Matrix { columns, rows } => format!("mat{columns}x{rows}"),
            Type::Array(of, count) => format!("{}[{count}]", self.ty(of)),
            Type::Struct(name) => name.clone(),
            Type::Pointer(of) => self.ty(of),
            Type::Texture(Texture::Plane) => "sampler2D".to_owned(),
            Type::Texture(Texture::Volume) => "sampler3D".to_owned(),
            Type::Texture(Texture::Layers) => "sampler2DArray".to_owned(),
            Type::Sampler => "sampler".to_owned(),
        }
    }

    fn constant(&self) -> &'static str {
        "const "
    }

    fn global(&self, name: &str, Slotted { bound, slot }: &Slotted) -> Option<String> {
        let declared = self.declared(name, &bound.ty);
        let binding = match self {
            Self::Desktop450 => Some(bound.binding.to_string()),
            Self::Program450 | Self::Program310 => Some(slot.to_string()),
            Self::Desktop330 | Self::Es300 => None,
        };
        let precision = if matches!(self, Self::Es300 | Self::Program310) { "highp " } else { "" };
        Some(match (&bound.ty, binding) {
            (Type::Sampler, _) => return None,
            (Type::Texture(_), Some(binding)) => format!("layout(binding = {binding}) uniform {precision}{declared};"),
            (Type::Texture(_), None) => format!("uniform {precision}{declared};"),
            (_, None) => format!("uniform {declared};"),
            (_, Some(binding)) => {
                let (layout, kind) = if bound.is_written { ("std430", "buffer") } else { ("std140", "uniform") };
                let block = block_name(name);
                format!("layout({layout}, binding = {binding}) {kind} {block} {{ {declared}; }};")
            }
        })
    }

    fn entry(&self, _: &str, body: &str, _: &[(String, Slotted)]) -> String {
        format!("layout(local_size_x = 1) in;\n\nvoid main() {body}")
    }

    fn zero(&self, ty: &Type, members: &dyn Fn(&str) -> Members) -> String {
        let list = |zeros: Vec<String>| format!("{}({})", self.ty(ty), zeros.join(", "));
        match ty {
            Type::Scalar(scalar) => zero_scalar(*scalar).to_owned(),
            Type::Vector(_, scalar) => list(vec![zero_scalar(*scalar).to_owned()]),
            Type::Array(of, count) => list(vec![self.zero(of, members); *count as usize]),
            Type::Struct(name) => list(members(name).iter().map(|(_, ty)| self.zero(ty, members)).collect()),
            _ => list(vec!["0.0".to_owned()]),
        }
    }

    fn array(&self, of: &Type, count: u32, arguments: &str) -> String {
        format!("{}[{count}]{arguments}", self.ty(of))
    }

    fn builtin(&self, call: &Builtin<'_>) -> Option<Piece> {
        let text = |number| call.text(number);
        let made = |text: String| Some(Piece::tight(text, call.result.clone()));
        match call.name {
            "saturate" => made(format!("clamp({}, 0.0, 1.0)", text(0))),
            "select" => made(format!("mix({}, {}, {})", text(0), text(1), text(2))),
            "bitcast" => {
                let from = call.arguments.first().and_then(|piece| piece.ty.scalar()).map(Scalar::concrete);
                let name = match (from, call.result.scalar()) {
                    (Some(Scalar::F32), Some(Scalar::I32)) => "floatBitsToInt",
                    (Some(Scalar::F32), Some(Scalar::U32)) => "floatBitsToUint",
                    (Some(Scalar::I32), Some(Scalar::F32)) => "intBitsToFloat",
                    (Some(Scalar::U32), Some(Scalar::F32)) => "uintBitsToFloat",
                    _ => return made(format!("{}({})", self.ty(call.result), text(0))),
                };
                made(format!("{name}({})", text(0)))
            }
            "textureLoad" => {
                let (level, place) = call.arguments.split_last()?;
                let place = Builtin { arguments: place, ..*call }.joined(&format!("ivec{}", call.coordinates()), 1);
                made(format!("texelFetch({}, {place}, {})", text(0), level.text))
            }
            "textureSampleLevel" => {
                let (level, place) = call.arguments.split_last()?;
                let place = match place {
                    [_, _, at] => at.text.clone(),
                    _ => Builtin { arguments: place, ..*call }.joined("vec3", 2),
                };
                made(format!("textureLod({}, {place}, {})", text(0), level.text))
            }
            "%" => {
                let [left, right] = [0, 1].map(|number| call.arguments[number].within(Precedence::Tight));
                made(format!("({left} - {right} * trunc({left} / {right}))"))
            }
            _ => None,
        }
    }

    fn renamed<'a>(&self, name: &'a str) -> &'a str {
        match name {
            "inverseSqrt" => "inversesqrt",
            "atan2" => "atan",
            other => other,
        }
    }

    fn compared(&self, sign: &str, left: &Piece, right: &Piece) -> Option<String> {
        let name = match sign {
            "<" => "lessThan",
            "<=" => "lessThanEqual",
            ">" => "greaterThan",
            ">=" => "greaterThanEqual",
            "==" => "equal",
            _ => "notEqual",
        };
        Some(format!("{name}({}, {})", left.text, right.text))
    }
}

/// The name of the block around a variable: `LtcTableBlock` for `ltc_table`.
fn block_name(name: &str) -> String {
    let capital = |word: &str| word[..1].to_uppercase() + &word[1..];
    name.split('_').filter(|word| !word.is_empty()).map(capital).collect::<String>() + "Block"
}
