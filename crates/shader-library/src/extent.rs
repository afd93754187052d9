//! Bounds on what is given to naga, found by a scan of the text.
//!
//! naga reads expressions, statements and declarations by functions that call themselves. It bounds how deep brackets
//! nest, but neither chains such as `a + a + a…` and `else if…`, which make trees as deep as they are long, nor the
//! length of `const a = b; const b = c;…`; each of them overflows the stack, which ends the program. Here is counted what
//! makes trees deep, without reading them; [`compile`](crate::compile) gives naga a stack that holds what is let through.
//! The numbers of statements and declarations are bounded too, since naga's time grows with their square.

use crate::scan::{Lexeme, lexemes};
use std::ops::Range;

/// Deepest nesting of brackets; naga's own bound is between 64 and 127, depending on what is nested, and without a place.
const MAX_NESTING: usize = 64;

/// Most operators, and branches of one `if`, that stand in each other; with 2 MiB of stack, naga fails above 1000.
const MAX_CHAIN: usize = 1000;

/// Most statements of a function; naga takes 0.3 s for this many.
const MAX_STATEMENTS: usize = 16_384;

/// Most declarations, each of which can need the next; with 2 MiB of stack, naga fails above 4000.
const MAX_DECLARATIONS: usize = 4096;

/// Counts within one pair of brackets, or outside of all.
#[derive(Default)]
struct Level {
    /// Operators and branches since the last comma or the end of a statement.
    chain: usize,
    /// Words with a `<` behind them, for which no `>` has come: lists of types, and comparisons.
    angles: usize,
}

/// Returns the first place where a text exceeds the bounds, and how.
pub(crate) fn exceeded(text: &str) -> Option<(Range<u32>, String)> {
    let mut levels = vec![Level::default()];
    // The sums over all levels.
    let (mut chain, mut angles) = (0, 0);
    let (mut statements, mut declarations) = (0, 0);
    let mut lexemes = lexemes(text).peekable();
    let mut after_word = false;
    while let Some((lexeme, at)) = lexemes.next() {
        let outside = levels.len() == 1;
        let level = levels.last_mut()?;
        match lexeme {
            Lexeme::Symbol('(' | '[' | '{') => {
                level.chain += 1;
                chain += 1;
                statements += usize::from(lexeme == Lexeme::Symbol('{'));
                levels.push(Level::default());
            }
            Lexeme::Symbol(close @ (')' | ']' | '}')) if !outside => {
                chain -= level.chain;
                angles -= level.angles;
                levels.pop();
                let goes_on = matches!(lexemes.peek(), Some((Lexeme::Word("else"), _)));
                if close == '}' && !goes_on {
                    end(levels.last_mut()?, &mut chain, &mut angles);
                }
            }
            Lexeme::Symbol(';') => {
                end(level, &mut chain, &mut angles);
                statements += usize::from(!outside);
            }
            Lexeme::Symbol(',') => {
                chain -= level.chain;
                level.chain = 0;
            }
            Lexeme::Symbol('<') if after_word => {
                level.angles += 1;
                angles += 1;
            }
            Lexeme::Symbol('>') if level.angles > 0 => {
                level.angles -= 1;
                angles -= 1;
            }
            Lexeme::Symbol('.' | '+' | '-' | '*' | '/' | '%' | '&' | '|' | '^' | '!' | '~' | '<' | '>')
            | Lexeme::Word("else") => {
                level.chain += 1;
                chain += 1;
            }
            Lexeme::Word("fn" | "struct" | "const" | "var" | "override" | "alias") if outside => {
                declarations += 1;
                statements = 0;
            }
            Lexeme::Word(_) | Lexeme::Symbol(_) | Lexeme::Doc(_) => {}
        }
        after_word = matches!(lexeme, Lexeme::Word(_));
        let what = if levels.len() + angles > MAX_NESTING {
            format!("brackets are nested deeper than {MAX_NESTING}")
        } else if chain > MAX_CHAIN {
            format!("there are more than {MAX_CHAIN} operators or branches in each other")
        } else if statements > MAX_STATEMENTS {
            format!("a function has more than {MAX_STATEMENTS} statements")
        } else if declarations > MAX_DECLARATIONS {
            format!("there are more than {MAX_DECLARATIONS} declarations")
        } else {
            continue;
        };
        return Some((at as u32..at as u32 + 1, what));
    }
    None
}

/// A statement ends.
fn end(level: &mut Level, chain: &mut usize, angles: &mut usize) {
    *chain -= level.chain;
    *angles -= level.angles;
    *level = Level::default();
}
