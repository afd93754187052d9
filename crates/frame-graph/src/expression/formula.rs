//! Expressions over names that the caller knows: in the directives and attributes of shaders.

use super::parse::parse_formula;
use super::{Expr, ExprError};
use data_file::{Place, Value};
use std::ops::Range;

/// An expression such as `min(settings.count, lights.count) * 2`: numbers, names joined by dots, `+ - * / %`, `min`,
/// `max`, comparisons, `&&`, `||` and `!`.
#[derive(Clone, Debug)]
pub struct Formula(Expr);

/// What is wrong with a formula, and at which bytes of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FormulaError {
    /// The bytes of the text.
    pub range: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// What to do about it.
    pub notes: Vec<String>,
}

/// What is wrong with a name, and what to do about it.
pub type NameError = (String, Vec<String>);

impl From<ExprError> for FormulaError {
    fn from(error: ExprError) -> FormulaError {
        FormulaError {
            range: error.start as usize..error.end as usize,
            // Parameters of pipelines are written with `$`, names of formulas are not.
            message: error.message.replace('$', ""),
            notes: error.notes,
        }
    }
}

impl Formula {
    /// Reads a formula.
    ///
    /// # Errors
    /// Text that is no formula.
    pub fn parse(text: &str) -> Result<Formula, FormulaError> {
        Ok(Formula(parse_formula(text)?))
    }

    /// Calculates its value: whole where all its numbers are. `lookup` returns the value of a name, or what is wrong with
    /// the name and what to do about it.
    ///
    /// # Errors
    /// Names without a value, operations that do not fit their operands, and arithmetic without a result.
    pub fn value(
        &self,
        lookup: &mut dyn FnMut(&str) -> Result<Value, NameError>,
    ) -> Result<Value, FormulaError> {
        let mut expr = self.0.clone();
        let mut wrong = None;
        expr.parameters(&mut |(start, end), name, slot| match lookup(name) {
            Ok(value) => *slot = Some((value, Place { file: 0, start, end })),
            Err((message, notes)) if wrong.is_none() => {
                wrong = Some(FormulaError { range: start as usize..end as usize, message, notes });
            }
            Err(_) => {}
        });
        match wrong {
            Some(error) => Err(error),
            None => Ok(expr.value()?),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Formula, Value};

    fn value(text: &str) -> Result<Value, String> {
        let mut lookup = |name: &str| match name {
            "settings.count" => Ok(Value::U32(12)),
            "scene.triangles" => Ok(Value::U32(5)),
            "WEIGHT" => Ok(Value::F32(0.5)),
            other => Err((format!("no `{other}`"), Vec::new())),
        };
        let formula = Formula::parse(text).map_err(|error| error.message)?;
        formula.value(&mut lookup).map_err(|error| format!("{:?}: {}", error.range, error.message))
    }

    #[test]
    fn formulas_are_calculated_from_dotted_names() {
        assert_eq!(value("min(settings.count, 2 * scene.triangles)-1"), Ok(Value::U32(9)));
        assert_eq!(value("(settings.count + 4) / 5 * WEIGHT"), Ok(Value::F32(1.5)));
        assert_eq!(value("settings.count == 12 && WEIGHT > 0.25"), Ok(Value::Bool(true)));
    }

    #[test]
    fn errors_of_formulas_have_their_places() {
        assert_eq!(value("2 + settings.cuont"), Err("4..18: no `settings.cuont`".to_owned()));
        let zero = "0..37: `settings.count / (scene.triangles - 5)` (settings.count = 12, scene.triangles = 5) divides by zero";
        assert_eq!(value("settings.count / (scene.triangles - 5)"), Err(zero.to_owned()));
        assert!(value("settings.count *").unwrap_err().starts_with("expected a name"));
    }
}
