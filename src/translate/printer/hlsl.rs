//! HLSL for shader model 5.1.
//!
//! Columns of a matrix are stored as HLSL rows. Therefore `M[i]` is column i in every language, and `M v` is `mul(v,
//! M)`.

use super::dialect::{Builtin, Dialect, Members, Piece, Precedence, Slotted, inside, sized_name, zero_scalar};
use crate::wgsl::{Resource, Scalar, Texture, Type};

#[derive(Debug, Clone, Copy)]
pub(super) struct Hlsl;

impl Dialect for Hlsl {
    fn reserved(&self) -> &'static str {
        "asm auto bool break buffer case catch cbuffer centroid char class column_major compile const const_cast continue \
         default delete discard do double dword else enum explicit export extern false far fixed float for friend fxgroup \
         goto groupshared half if in inline inout int interface line lineadj linear long matrix mutable namespace near \
         new nointerpolation noperspective operator out packoffset pass point precise private protected public register \
         return row_major sample sampler shared short signed sizeof snorm stateblock static string struct switch tbuffer \
         technique template texture this throw triangle triangleadj true try typedef typename uint uniform union unorm \
         unsigned using vector virtual void volatile while"
    }

    fn functions(&self) -> &'static str {
        "asfloat asint asuint fmod frac lerp mad mul rsqrt"
    }

    fn ty(&self, ty: &Type) -> String {
        sized_name(ty).unwrap_or_else(|| match ty {
            Type::Array(of, _) | Type::Pointer(of) => self.ty(of),
            Type::Texture(Texture::Plane) => "Texture2D<float4>".to_owned(),
            Type::Texture(Texture::Volume) => "Texture3D<float4>".to_owned(),
            Type::Texture(Texture::Layers) => "Texture2DArray<float4>".to_owned(),
            _ => "SamplerState".to_owned(),
        })
    }

    fn constant(&self) -> &'static str {
        "static const "
    }

    fn global(&self, name: &str, Slotted { bound, .. }: &Slotted) -> Option<String> {
        let Resource { ty, group, binding, is_written } = bound;
        let space = if *group == 0 { String::new() } else { format!(", space{group}") };
        let declared = self.declared(name, ty);
        Some(match ty {
            Type::Texture(_) => format!("{declared} : register(t{binding}{space});"),
            Type::Sampler => format!("{declared} : register(s{binding}{space});"),
            _ if *is_written => format!("RWStructuredBuffer<{}> {name} : register(u{binding}{space});", self.ty(ty)),
            _ => format!("cbuffer {name} : register(b{binding}{space}) {{ {declared}; }}"),
        })
    }

    fn bound(&self, name: &str, Slotted { bound, .. }: &Slotted) -> String {
        if bound.is_written { format!("{name}[0]") } else { name.to_owned() }
    }

    fn entry(&self, name: &str, body: &str, _: &[(String, Slotted)]) -> String {
        format!("[numthreads(1, 1, 1)]\nvoid {name}() {body}")
    }

    fn zero(&self, ty: &Type, _: &dyn Fn(&str) -> Members) -> String {
        let cast = |ty: &Type| match ty {
            Type::Scalar(scalar) => zero_scalar(*scalar).to_owned(),
            Type::Vector(_, scalar) => format!("({}){}", self.ty(ty), zero_scalar(*scalar)),
            Type::Matrix { .. } => format!("({})0.0", self.ty(ty)),
            _ => format!("({})0", self.ty(ty)),
        };
        match ty {
            Type::Array(of, count) => format!("{{ {} }}", vec![cast(of); *count as usize].join(", ")),
            _ => cast(ty),
        }
    }

    fn structure(&self, name: &str, arguments: &str) -> String {
        format!("{name}Of{arguments}")
    }

    fn maker(&self, name: &str, members: &Members) -> Option<String> {
        let parameters: Vec<String> = members.iter().map(|(name, ty)| self.declared(name, ty)).collect();
        let names: Vec<&str> = members.iter().map(|(name, _)| name.as_str()).collect();
        let (parameters, names) = (parameters.join(", "), names.join(", "));
        Some(format!("{name} {name}Of({parameters}) {{\n    {name} made = {{ {names} }};\n    return made;\n}}"))
    }

    fn array(&self, _: &Type, _: u32, arguments: &str) -> String {
        format!("{{ {} }}", inside(arguments).trim())
    }

    fn vector(&self, ty: &Type, arguments: &[Piece]) -> Option<Piece> {
        // A constructor takes one scalar per component. A cast repeats one scalar.
        match arguments {
            [one] if matches!(ty, Type::Vector(..)) && matches!(one.ty, Type::Scalar(_)) => Some(Piece {
                text: format!("({}){}", self.ty(ty), one.within(Precedence::Tight)),
                ty: ty.clone(),
                precedence: Precedence::Operator,
            }),
            _ => None,
        }
    }

    fn builtin(&self, call: &Builtin<'_>) -> Option<Piece> {
        let text = |number| call.text(number);
        let made = |text: String| Some(Piece::tight(text, call.result.clone()));
        match call.name {
            "select" => {
                let [yes, no] = [1, 0].map(|number| call.arguments[number].within(Precedence::Operator));
                let text = format!("{} ? {yes} : {no}", call.arguments[2].within(Precedence::Operator));
                Some(Piece { text, ty: call.result.clone(), precedence: Precedence::Choice })
            }
            "bitcast" => {
                let name = match call.result.scalar() {
                    Some(Scalar::I32) => "asint",
                    Some(Scalar::U32) => "asuint",
                    _ => "asfloat",
                };
                made(format!("{name}({})", text(0)))
            }
            "textureLoad" => {
                made(format!("{}.Load({})", text(0), call.joined(&format!("int{}", call.coordinates() + 1), 1)))
            }
            "textureSampleLevel" => {
                let (level, place) = call.arguments.split_last()?;
                let place = match place {
                    [_, _, at] => at.text.clone(),
                    _ => Builtin { arguments: place, ..*call }.joined("float3", 2),
                };
                made(format!("{}.SampleLevel({}, {place}, {})", text(0), text(1), level.text))
            }
            "%" => made(format!("fmod({}, {})", text(0), text(1))),
            _ => None,
        }
    }

    fn renamed<'a>(&self, name: &'a str) -> &'a str {
        match name {
            "inverseSqrt" => "rsqrt",
            "fract" => "frac",
            "mix" => "lerp",
            "fma" => "mad",
            other => other,
        }
    }

    fn product(&self, left: &Piece, right: &Piece) -> Option<String> {
        Some(format!("mul({}, {})", right.text, left.text))
    }
}
