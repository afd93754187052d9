//! Reads expressions.

use super::{Expr, ExprError, ExprKind, MAX_DEPTH, Op};
use crate::codes;
use data_file::{Name, Value};

struct Parser<'a> {
    text: &'a str,
    at: usize,
    /// Whether names are those of a formula: `settings.count`, without hyphens.
    formula: bool,
}

/// Reads an expression.
pub(crate) fn parse(text: &str) -> Result<Expr, ExprError> {
    whole(Parser { text, at: 0, formula: false })
}

/// Reads an expression whose names are those of a formula.
pub(super) fn parse_formula(text: &str) -> Result<Expr, ExprError> {
    whole(Parser { text, at: 0, formula: true })
}

fn whole(mut parser: Parser<'_>) -> Result<Expr, ExprError> {
    let expr = parser.or(0)?;
    parser.blanks();
    if parser.at < parser.text.len() {
        return Err(parser.error(parser.at, "expected an operator such as `*`, `&&` or `==`, or the end"));
    }
    Ok(expr)
}

/// Reads `* A / B` from byte `at` of a text on: a factor, a divisor, one of them, or none.
pub(crate) fn parse_scale(text: &str, at: usize) -> Result<(Option<Expr>, Option<Expr>), ExprError> {
    let mut parser = Parser { text, at, formula: false };
    let mut factor = |sign| if parser.eat(sign) { parser.unary(0).map(Some) } else { Ok(None) };
    let scale = (factor("*")?, factor("/")?);
    parser.blanks();
    if parser.at < text.len() {
        return Err(parser.error(parser.at, "expected `* number`, `/ number`, or the end"));
    }
    Ok(scale)
}

impl Parser<'_> {
    fn error(&self, start: usize, message: impl Into<String>) -> ExprError {
        let end = self.text[start..].chars().next().map_or(start, |c| start + c.len_utf8());
        ExprError {
            code: &codes::EXPRESSION,
            start: start as u32,
            end: end.max(self.at) as u32,
            message: message.into(),
            notes: Vec::new(),
        }
    }

    fn rest(&self) -> &str {
        &self.text[self.at..]
    }

    fn blanks(&mut self) {
        let rest = self.rest();
        self.at += rest.len() - rest.trim_start().len();
    }

    fn eat(&mut self, text: &str) -> bool {
        self.blanks();
        let found = self.rest().starts_with(text);
        if found {
            self.at += text.len();
        }
        found
    }

    fn binary(op: Op, left: Expr, right: Expr) -> Expr {
        let (start, end) = (left.start, right.end);
        Expr { start, end, kind: ExprKind::Binary(op, Box::new(left), Box::new(right)) }
    }

    fn or(&mut self, depth: u32) -> Result<Expr, ExprError> {
        self.chain(depth, &[Op::Or], Self::and)
    }

    fn and(&mut self, depth: u32) -> Result<Expr, ExprError> {
        self.chain(depth, &[Op::And], Self::comparison)
    }

    fn comparison(&mut self, depth: u32) -> Result<Expr, ExprError> {
        let left = self.sum(depth)?;
        let ops = [Op::Equal, Op::NotEqual, Op::LessEqual, Op::GreaterEqual, Op::Less, Op::Greater];
        for op in ops {
            if self.eat(op.text()) {
                return Ok(Self::binary(op, left, self.sum(depth)?));
            }
        }
        Ok(left)
    }

    fn sum(&mut self, depth: u32) -> Result<Expr, ExprError> {
        self.chain(depth, &[Op::Add, Op::Subtract], Self::product)
    }

    fn product(&mut self, depth: u32) -> Result<Expr, ExprError> {
        self.chain(depth, &[Op::Multiply, Op::Divide, Op::Remainder], Self::unary)
    }

    /// Operands joined by any of some operators, from the left.
    fn chain(
        &mut self,
        depth: u32,
        ops: &[Op],
        operand: fn(&mut Self, u32) -> Result<Expr, ExprError>,
    ) -> Result<Expr, ExprError> {
        let mut left = operand(self, depth)?;
        let mut length = depth;
        while let Some(op) = ops.iter().find(|op| self.eat(op.text())) {
            length = self.deeper(length)?;
            left = Self::binary(*op, left, operand(self, depth)?);
        }
        Ok(left)
    }

    fn deeper(&self, depth: u32) -> Result<u32, ExprError> {
        if depth >= MAX_DEPTH {
            let message = format!("this expression is nested more than {MAX_DEPTH} deep");
            return Err(ExprError {
                code: &codes::NESTING,
                ..self.error(self.at.min(self.text.len()), message)
            });
        }
        Ok(depth + 1)
    }

    fn unary(&mut self, depth: u32) -> Result<Expr, ExprError> {
        self.blanks();
        let start = self.at;
        if !self.rest().starts_with("!=") && self.eat("!") {
            let inner = self.unary(self.deeper(depth)?)?;
            return Ok(Expr { start: start as u32, end: inner.end, kind: ExprKind::Not(Box::new(inner)) });
        }
        let is_number = |c: char| c.is_ascii_digit() || c == '.';
        if self.rest().starts_with('-') && !self.rest()[1..].starts_with(is_number) {
            self.at += 1;
            let zero = Expr { start: start as u32, end: start as u32, kind: ExprKind::Value(Value::U32(0)) };
            let inner = self.unary(self.deeper(depth)?)?;
            return Ok(Self::binary(Op::Subtract, zero, inner));
        }
        if self.eat("(") {
            let inner = self.or(self.deeper(depth)?)?;
            if !self.eat(")") {
                return Err(self.error(self.at, "expected `)`"));
            }
            return Ok(inner);
        }
        let kind = self.atom(start, depth)?;
        Ok(Expr { start: start as u32, end: self.at as u32, kind })
    }

    fn name(&mut self) -> &str {
        let start = self.at;
        let rest = self.rest();
        let is_name = |c: char| c.is_alphanumeric() || c == '_' || c == if self.formula { '.' } else { '-' };
        let len = rest.find(|c| !is_name(c)).unwrap_or(rest.len());
        self.at += len;
        &self.text[start..self.at]
    }

    fn atom(&mut self, start: usize, depth: u32) -> Result<ExprKind, ExprError> {
        let first = self.rest().chars().next();
        match first {
            Some(quote @ ('"' | '\'')) => {
                let Some(len) = self.rest()[1..].find(quote) else {
                    return Err(self.error(start, "this text is not closed"));
                };
                let text = self.rest()[1..1 + len].to_owned();
                self.at += len + 2;
                Ok(ExprKind::Value(Value::Text(text)))
            }
            Some('0'..='9' | '-' | '.' | '+') => {
                let rest = self.rest();
                let is_number = |(i, c): (usize, char)| {
                    c.is_ascii_alphanumeric()
                        || matches!(c, '.' | '_')
                        || matches!(c, '-' | '+') && (i == 0 || rest[..i].ends_with(['e', 'E']))
                };
                let len = rest.char_indices().find(|x| !is_number(*x)).map_or(rest.len(), |(i, _)| i);
                let digits = rest[..len].replace('_', "");
                self.at += len;
                let value = if let Ok(n) = digits.parse() {
                    Value::U32(n)
                } else if let Ok(n) = digits.parse() {
                    Value::I32(n)
                } else if digits.trim_start_matches(['-', '+']).bytes().all(|c| c.is_ascii_digit()) {
                    return Err(self.error(start, format!("`{digits}` is beyond the whole numbers")));
                } else if let Some(x) = digits.parse().ok().filter(|x: &f32| x.is_finite()) {
                    Value::F32(x)
                } else {
                    return Err(self.error(start, format!("`{digits}` is not a number")));
                };
                Ok(ExprKind::Value(value))
            }
            Some('$') => {
                self.at += 1;
                let name = Name::from(self.name());
                if name.is_empty() {
                    return Err(self.error(start, "expected the name of a parameter after `$`"));
                }
                Ok(ExprKind::Parameter(name, None))
            }
            Some(c) if c.is_alphabetic() || c == '_' => {
                let word = self.name().to_owned();
                match word.as_str() {
                    "true" => Ok(ExprKind::Value(Value::Bool(true))),
                    "false" => Ok(ExprKind::Value(Value::Bool(false))),
                    "scene" if self.rest().starts_with('.') => {
                        self.at += 1;
                        let name = Name::from(self.name());
                        if name.is_empty() {
                            return Err(self.error(self.at, "expected the name of a trait after `scene.`"));
                        }
                        Ok(ExprKind::Trait(name))
                    }
                    "min" if self.eat("(") => self.least(Op::Min, depth),
                    "max" if self.eat("(") => self.least(Op::Max, depth),
                    _ if self.eat("(") => {
                        let mut error = self.error(start, format!("there is no function `{word}`"));
                        error.code = &codes::EXPRESSION_NAME;
                        error.notes.push("the functions are `min(a, b)` and `max(a, b)`".into());
                        Err(error)
                    }
                    _ => Ok(ExprKind::Parameter(Name::from(word), None)),
                }
            }
            Some(_) => Err(self.error(start, "expected a name, a value, `!`, `-` or `(`")),
            None => Err(self.error(start, "expected a name or a value before the end")),
        }
    }

    /// Returns the operands of `min` or `max`, two or more, and the closing parenthesis.
    fn least(&mut self, op: Op, depth: u32) -> Result<ExprKind, ExprError> {
        let mut length = self.deeper(depth)?;
        let mut left = self.or(length)?;
        let mut whole = false;
        while self.eat(",") {
            length = self.deeper(length)?;
            left = Self::binary(op, left, self.or(length)?);
            whole = true;
        }
        if !whole || !self.eat(")") {
            let what = if whole { "expected `,` or `)`" } else { "expected `,` and a second number" };
            return Err(self.error(self.at, what));
        }
        Ok(left.kind)
    }
}
