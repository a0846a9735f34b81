//! A position in the list of tokens, with parsers for signs, types and expressions.

use super::{
    lexer::{Fault, Kind, Span, Token},
    syntax::{Call, Callee, Expr, ExprKind, Scalar, Texture, Type, matrix, vector},
};

/// The largest nesting depth of brackets, operators and blocks.
const DEEPEST: u32 = 60;

/// The largest array length. The zeros of an array are written out.
const LONGEST: u32 = 64;

pub(super) struct Stream<'a> {
    source: &'a str,
    tokens: &'a [Token],
    at: usize,
    depth: u32,
}

impl<'a> Stream<'a> {
    /// Domain: the last of `tokens` is [`Kind::End`].
    pub(super) fn new(source: &'a str, tokens: &'a [Token]) -> Self {
        Self { source, tokens, at: 0, depth: 0 }
    }

    fn token(&self) -> &'a Token {
        &self.tokens[self.at.min(self.tokens.len() - 1)]
    }

    fn text(&self) -> &'a str {
        &self.source[self.token().span.clone()]
    }

    pub(super) fn is_at_end(&self) -> bool {
        self.token().kind == Kind::End
    }

    /// The start of the next token.
    pub(super) fn here(&self) -> usize {
        self.token().span.start
    }

    /// The end of the last consumed token.
    pub(super) fn before(&self) -> usize {
        self.at.checked_sub(1).map_or(0, |last| self.tokens[last].span.end)
    }

    /// Whether the next token is this word or sign.
    pub(super) fn is_next(&self, text: &str) -> bool {
        self.text() == text
    }

    pub(super) fn unexpected(&self, wanted: &str) -> Fault {
        let found = if self.is_at_end() { "the end".to_owned() } else { format!("«{}»", self.text()) };
        Fault::new(self.here(), format!("expected {wanted}, found {found}"))
    }

    /// Consumes any token except the end.
    pub(super) fn next(&mut self) -> Result<&'a str, Fault> {
        if self.is_at_end() {
            return Err(self.unexpected("more"));
        }
        let text = self.text();
        self.at += 1;
        Ok(text)
    }

    /// Consumes this word or sign if it is next, and returns its span.
    pub(super) fn taken(&mut self, text: &str) -> Option<Span> {
        let span = self.token().span.clone();
        self.is_next(text).then(|| self.at += 1).map(|()| span)
    }

    pub(super) fn take(&mut self, text: &str) -> bool {
        self.taken(text).is_some()
    }

    pub(super) fn expect(&mut self, text: &str) -> Result<(), Fault> {
        if self.take(text) { Ok(()) } else { Err(self.unexpected(&format!("«{text}»"))) }
    }

    pub(super) fn word(&mut self) -> Result<&'a str, Fault> {
        if self.token().kind == Kind::Word { self.next() } else { Err(self.unexpected("a name")) }
    }

    /// Runs `read` one nesting level deeper.
    pub(super) fn deeper<T>(&mut self, read: impl FnOnce(&mut Self) -> Result<T, Fault>) -> Result<T, Fault> {
        self.depth += 1;
        if self.depth > DEEPEST {
            return Err(Fault::new(self.here(), format!("this is nested more than {DEEPEST} deep")));
        }
        let found = read(self);
        self.depth -= 1;
        found
    }

    /// Parses a type.
    pub(super) fn ty(&mut self) -> Result<Type, Fault> {
        self.deeper(|stream| {
            let at = stream.here();
            let name = stream.word()?;
            stream.type_named(name, at)
        })
    }

    /// Parses the parameters of the type `name`, which starts at `at`.
    fn type_named(&mut self, name: &str, at: usize) -> Result<Type, Fault> {
        let found = match name {
            "bool" => Type::BOOL,
            "f32" => Type::FLOAT,
            "i32" => Type::Scalar(Scalar::I32),
            "u32" => Type::Scalar(Scalar::U32),
            "sampler" => Type::Sampler,
            "array" => {
                self.expect("<")?;
                let of = self.ty()?;
                self.expect(",")?;
                let at = self.here();
                let count = self.next()?.trim_end_matches('u').parse().ok().filter(|count| *count <= LONGEST);
                let count =
                    count.ok_or_else(|| Fault::new(at, format!("an array has at most {LONGEST} elements here")))?;
                if matches!(of, Type::Array(..)) {
                    return Err(Fault::new(at, "arrays of arrays are not supported"));
                }
                self.take(",");
                self.expect(">")?;
                Type::Array(Box::new(of), count)
            }
            "ptr" => {
                self.expect("<")?;
                self.expect("function")?;
                self.expect(",")?;
                let of = self.ty()?;
                self.expect(">")?;
                Type::Pointer(Box::new(of))
            }
            _ => match (vector(name), matrix(name)) {
                (Some(size), _) => match self.parameter()? {
                    Type::Scalar(scalar) => Type::Vector(size, scalar),
                    _ => return Err(Fault::new(at, "the elements of a vector must be scalars")),
                },
                (_, Some((columns, rows))) => {
                    self.parameter()?;
                    Type::Matrix { columns, rows }
                }
                _ if name == "texture_3d" => self.parameter().map(|_| Type::Texture(Texture::Volume))?,
                _ if name == "texture_2d" => self.parameter().map(|_| Type::Texture(Texture::Plane))?,
                _ if name == "texture_2d_array" => self.parameter().map(|_| Type::Texture(Texture::Layers))?,
                _ => Type::Struct(name.to_owned()),
            },
        };
        Ok(found)
    }

    /// Parses a type in angle brackets.
    fn parameter(&mut self) -> Result<Type, Fault> {
        self.expect("<")?;
        let of = self.ty()?;
        self.expect(">")?;
        Ok(of)
    }

    pub(super) fn expression(&mut self) -> Result<Expr, Fault> {
        self.deeper(|stream| stream.binary(0))
    }

    /// Parses operators with a precedence of at least `least`.
    fn binary(&mut self, least: u8) -> Result<Expr, Fault> {
        let mut left = self.unary()?;
        while let Some((sign, strength)) = self.operator().filter(|(_, strength)| *strength >= least) {
            for _ in 0..if sign == ">>" { 2 } else { 1 } {
                self.next()?;
            }
            let right = self.deeper(|stream| stream.binary(strength + 1))?;
            let (span, depth) = (left.span.start..right.span.end, left.depth.max(right.depth));
            left = node(ExprKind::Binary(sign, Box::new(left), Box::new(right)), span, depth)?;
        }
        Ok(left)
    }

    /// The operator at this position and its precedence, as in C. Where WGSL has another precedence, it requires
    /// brackets.
    fn operator(&self) -> Option<(&'static str, u8)> {
        const OPERATORS: [(&str, u8); 18] = [
            ("||", 0),
            ("&&", 1),
            ("|", 2),
            ("^", 3),
            ("&", 4),
            ("==", 5),
            ("!=", 5),
            ("<=", 6),
            (">=", 6),
            ("<<", 7),
            (">>", 7),
            ("<", 6),
            (">", 6),
            ("+", 8),
            ("-", 8),
            ("*", 9),
            ("/", 9),
            ("%", 9),
        ];
        let follows = self.tokens.get(self.at + 1);
        let is_shift = self.is_next(">")
            && follows
                .is_some_and(|next| next.span.start == self.token().span.end && &self.source[next.span.clone()] == ">");
        let sign = if is_shift { ">>" } else { self.text() };
        OPERATORS.into_iter().find(|(operator, _)| *operator == sign)
    }

    fn unary(&mut self) -> Result<Expr, Fault> {
        let start = self.here();
        for sign in ['-', '!', '~', '*', '&'] {
            if self.take(&sign.to_string()) {
                let of = self.deeper(Self::unary)?;
                let (span, depth) = (start..of.span.end, of.depth);
                return node(ExprKind::Unary(sign, Box::new(of)), span, depth);
            }
        }
        let mut found = self.primary()?;
        loop {
            let (kind, depth) = if self.take(".") {
                let name = self.word()?.to_owned();
                let depth = found.depth;
                (ExprKind::Field(Box::new(found), name), depth)
            } else if self.take("[") {
                let index = self.expression()?;
                self.expect("]")?;
                let depth = found.depth.max(index.depth);
                (ExprKind::Index(Box::new(found), Box::new(index)), depth)
            } else {
                return Ok(found);
            };
            found = node(kind, start..self.before(), depth)?;
        }
    }

    fn primary(&mut self) -> Result<Expr, Fault> {
        let start = self.here();
        if self.take("(") {
            let inner = self.expression()?;
            self.expect(")")?;
            let depth = inner.depth;
            return node(ExprKind::Paren(Box::new(inner)), start..self.before(), depth);
        }
        if self.token().kind == Kind::Number {
            self.next()?;
            return node(ExprKind::Number, start..self.before(), 0);
        }
        let name = self.word()?;
        if name == "true" || name == "false" {
            return node(ExprKind::Bool, start..self.before(), 0);
        }
        let is_generic = vector(name).is_some() || matrix(name).is_some() || name == "array";
        let callee = if name == "bitcast" {
            Callee::Bitcast(self.parameter()?)
        } else if ["f32", "i32", "u32", "bool"].contains(&name) || (is_generic && self.is_next("<")) {
            Callee::Type(self.type_named(name, start)?)
        } else {
            Callee::Name(name.to_owned())
        };
        let open = self.here();
        if !self.take("(") {
            return match callee {
                Callee::Name(name) => node(ExprKind::Name(name), start..self.before(), 0),
                _ => Err(self.unexpected("«(»")),
            };
        }
        let (mut arguments, mut comma) = (Vec::new(), None);
        while !self.take(")") {
            arguments.push(self.expression()?);
            comma = self.taken(",");
            if comma.is_none() && !self.is_next(")") {
                return Err(self.unexpected("«,» or «)»"));
            }
        }
        let depth = arguments.iter().map(|argument| argument.depth).max().unwrap_or(0);
        let call = Call { callee, arguments, span: open..self.before(), comma };
        node(ExprKind::Call(call), start..self.before(), depth)
    }
}

fn node(kind: ExprKind, span: Span, below: u32) -> Result<Expr, Fault> {
    let depth = below + 1;
    if depth > DEEPEST {
        return Err(Fault::new(span.start, format!("this expression is nested more than {DEEPEST} deep")));
    }
    Ok(Expr { kind, span, depth })
}
