//! An interpreter of a shader's functions, in `f32` or in `f64`.
//!
//! It runs one thread, without resources and rasterizer; statements that need these are errors with name and place.
//! Constants are those of `f32` in either type, and so are floats whose bits are read.

mod expression;
mod math;
mod operator;

use crate::float::Float;
use crate::value::{Pointer, Scalar, Value};
use data_file::Span;
use naga::{
    AddressSpace, ArraySize, Block, Expression, Function, Handle, Module, ScalarKind, Statement, SwitchValue,
    Type, TypeInner,
};
use shader_library::{Shader, naga};
use std::fmt;

/// The error of a function that was not computed to its end.
#[derive(Clone, Debug)]
pub struct Fault {
    /// The error, or the unknown construct.
    pub message: String,
    /// The place in the user's file.
    pub place: Option<Span>,
}

impl Fault {
    pub(crate) fn new(message: impl Into<String>) -> Self {
        Fault { message: message.into(), place: None }
    }

    /// The fault of a construct that the interpreter does not know.
    fn unknown(construct: impl fmt::Display) -> Self {
        Fault::new(format!("{construct} is not known to the interpreter"))
    }

    /// Adds the place of the construct, unless one inside it was named.
    fn at(mut self, shader: &Shader, span: naga::Span) -> Self {
        if self.place.is_none() {
            let range = span.to_range().map(|range| range.start as u32..range.end as u32);
            self.place = range.and_then(|range| shader.place(range));
        }
        self
    }
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.place {
            Some(place) => write!(f, "{place}: {}", self.message),
            None => f.write_str(&self.message),
        }
    }
}

impl std::error::Error for Fault {}

/// Statements that a call executes before it counts as one that does not end.
pub const MOST_STATEMENTS: u64 = 4_000_000;

/// The most values in a variable.
const MOST_VALUES: usize = 1 << 20;

/// Runs functions of a shader. Private variables keep their values from call to call.
pub struct Interpreter<'a, F> {
    shader: &'a Shader,
    module: &'a Module,
    /// The variables of the module, and then those of the functions that run.
    memory: Vec<Value<F>>,
    /// Index of each variable of the module in memory; `None` for those without a value.
    globals: Vec<Option<usize>>,
    statements: u64,
}

/// The state of a running function.
struct Frame<'a, F> {
    function: &'a Function,
    arguments: Vec<Value<F>>,
    values: Vec<Option<Value<F>>>,
    /// The index of its first variable in memory.
    variables: usize,
}

/// How a block ended.
enum Flow<F> {
    Next,
    Break,
    Continue,
    Return(Option<Value<F>>),
}

impl<'a, F: Float> Interpreter<'a, F> {
    /// Creates an interpreter. `given` has values of uniforms by name; those without are refused where they are read.
    ///
    /// # Errors
    /// Fails if the initial value of a private variable cannot be computed.
    pub fn new(shader: &'a Shader, given: &[(&str, Value<F>)]) -> Result<Self, Fault> {
        let module = &shader.module;
        let mut interpreter =
            Interpreter { shader, module, memory: Vec::new(), globals: Vec::new(), statements: 0 };
        for (handle, global) in module.global_variables.iter() {
            let name = global.name.as_deref().unwrap_or_default();
            let value = match global.space {
                AddressSpace::Private => Some(match global.init {
                    Some(init) => interpreter.global_expression(init),
                    None => interpreter.zero(global.ty),
                })
                .transpose()
                .map_err(|fault| fault.at(shader, module.global_variables.get_span(handle)))?,
                _ => given.iter().find(|(of, _)| *of == name).map(|(_, value)| value.clone()),
            };
            interpreter.globals.push(value.map(|value| {
                interpreter.memory.push(value);
                interpreter.memory.len() - 1
            }));
        }
        Ok(interpreter)
    }

    /// Calls the function of this name.
    ///
    /// # Errors
    /// Fails if there is none, it has other parameters or no result, does not end within [`MOST_STATEMENTS`], or needs
    /// resources or other threads.
    pub fn call(&mut self, name: &str, arguments: Vec<Value<F>>) -> Result<Value<F>, Fault> {
        let mut functions = self.module.functions.iter();
        let function = functions.find(|(_, function)| function.name.as_deref() == Some(name));
        let (handle, _) = function.ok_or_else(|| Fault::new(format!("there is no function `{name}`")))?;
        self.statements = 0;
        let called = self.enter(handle, arguments);
        self.memory.truncate(self.globals.iter().flatten().count());
        called?.ok_or_else(|| Fault::new(format!("`{name}` returns nothing")))
    }

    fn enter(
        &mut self,
        handle: Handle<Function>,
        arguments: Vec<Value<F>>,
    ) -> Result<Option<Value<F>>, Fault> {
        let function = &self.module.functions[handle];
        if function.arguments.len() != arguments.len() {
            let name = function.name.as_deref().unwrap_or_default();
            let (takes, given) = (function.arguments.len(), arguments.len());
            return Err(Fault::new(format!("`{name}` takes {takes} arguments and was given {given}")));
        }
        let mut frame = Frame {
            function,
            arguments,
            values: vec![None; function.expressions.len()],
            variables: self.memory.len(),
        };
        for (_, variable) in function.local_variables.iter() {
            let value = match variable.init {
                Some(init) => self.value(&frame, init)?,
                None => self.zero(variable.ty)?,
            };
            self.memory.push(value);
        }
        let flow = self.block(&mut frame, &function.body)?;
        self.memory.truncate(frame.variables);
        Ok(match flow {
            Flow::Return(value) => value,
            _ => None,
        })
    }

    fn block(&mut self, frame: &mut Frame<'a, F>, block: &'a Block) -> Result<Flow<F>, Fault> {
        for (statement, span) in block.span_iter() {
            let flow = self.statement(frame, statement).map_err(|fault| fault.at(self.shader, *span))?;
            if !matches!(flow, Flow::Next) {
                return Ok(flow);
            }
        }
        Ok(Flow::Next)
    }

    fn statement(&mut self, frame: &mut Frame<'a, F>, statement: &'a Statement) -> Result<Flow<F>, Fault> {
        self.statements += 1;
        if self.statements > MOST_STATEMENTS {
            return Err(Fault::new(format!("it does not end within {MOST_STATEMENTS} statements")));
        }
        match statement {
            Statement::Emit(range) => {
                for handle in range.clone() {
                    let value = self.expression(frame, handle).map_err(|fault| {
                        fault.at(self.shader, frame.function.expressions.get_span(handle))
                    })?;
                    frame.values[handle.index()] = Some(value);
                }
            }
            Statement::Block(block) => return self.block(frame, block),
            Statement::If { condition, accept, reject } => {
                let block = if self.truth(frame, *condition)? { accept } else { reject };
                return self.block(frame, block);
            }
            Statement::Switch { selector, cases } => return self.switch(frame, *selector, cases),
            Statement::Loop { body, continuing, break_if } => loop {
                match self.block(frame, body)? {
                    Flow::Break => break,
                    flow @ Flow::Return(_) => return Ok(flow),
                    Flow::Next | Flow::Continue => {}
                }
                self.block(frame, continuing)?;
                if let Some(condition) = break_if
                    && self.truth(frame, *condition)?
                {
                    break;
                }
                // A loop of nothing also ends.
                self.statements += 1;
                if self.statements > MOST_STATEMENTS {
                    return Err(Fault::new(format!("it does not end within {MOST_STATEMENTS} statements")));
                }
            },
            Statement::Break => return Ok(Flow::Break),
            Statement::Continue => return Ok(Flow::Continue),
            Statement::Return { value } => {
                let value = value.map(|value| self.value(frame, value)).transpose()?;
                return Ok(Flow::Return(value));
            }
            Statement::Store { pointer, value } => {
                let value = self.value(frame, *value)?;
                let pointer = self.pointer(frame, *pointer)?;
                let variable = self.memory.get_mut(pointer.variable);
                if !variable.is_some_and(|variable| variable.set(pointer.steps(), value)) {
                    return Err(Fault::new(beyond(pointer)));
                }
            }
            Statement::Call { function, arguments, result } => {
                let mut values = Vec::with_capacity(arguments.len());
                for argument in arguments {
                    values.push(self.value(frame, *argument)?);
                }
                let value = self.enter(*function, values)?;
                if let Some(result) = result {
                    frame.values[result.index()] = value;
                }
            }
            other => {
                return Err(Fault::unknown(statement_name(other)));
            }
        }
        Ok(Flow::Next)
    }

    fn switch(
        &mut self,
        frame: &mut Frame<'a, F>,
        selector: Handle<Expression>,
        cases: &'a [naga::SwitchCase],
    ) -> Result<Flow<F>, Fault> {
        let selected = match self.value(frame, selector)? {
            Value::Scalar(Scalar::I32(x)) => SwitchValue::I32(x),
            Value::Scalar(Scalar::U32(x)) => SwitchValue::U32(x),
            other => return Err(Fault::new(format!("{} selects no case", other.type_name()))),
        };
        let place = cases.iter().position(|case| case.value == selected);
        let place = place.or_else(|| cases.iter().position(|case| case.value == SwitchValue::Default));
        for case in &cases[place.unwrap_or(cases.len())..] {
            match self.block(frame, &case.body)? {
                Flow::Break => break,
                Flow::Next if case.fall_through => {}
                Flow::Next => break,
                flow => return Ok(flow),
            }
        }
        Ok(Flow::Next)
    }

    fn truth(&self, frame: &Frame<'a, F>, condition: Handle<Expression>) -> Result<bool, Fault> {
        match self.value(frame, condition)? {
            Value::Scalar(Scalar::Bool(on)) => Ok(on),
            other => Err(Fault::new(format!("{} is no condition", other.type_name()))),
        }
    }

    fn pointer(&self, frame: &Frame<'a, F>, pointer: Handle<Expression>) -> Result<Pointer, Fault> {
        match self.value(frame, pointer)? {
            Value::Pointer(pointer) => Ok(pointer),
            other => Err(Fault::new(format!("{} is no place of a variable", other.type_name()))),
        }
    }

    fn load(&self, pointer: Pointer) -> Result<Value<F>, Fault> {
        let variable = self.memory.get(pointer.variable);
        variable.and_then(|variable| variable.at(pointer.steps())).ok_or_else(|| Fault::new(beyond(pointer)))
    }

    /// The zero of a type.
    pub(crate) fn zero(&self, ty: Handle<Type>) -> Result<Value<F>, Fault> {
        let mut left = MOST_VALUES;
        self.zero_of(ty, &mut left)
    }

    fn zero_of(&self, ty: Handle<Type>, left: &mut usize) -> Result<Value<F>, Fault> {
        let scalar = |scalar: naga::Scalar| zero_scalar(scalar).map(Value::Scalar);
        let vector = |size: naga::VectorSize, scalar: naga::Scalar| -> Result<_, Fault> {
            let zero = zero_scalar(scalar)?;
            Ok(crate::value::Vector::new(std::iter::repeat_n(zero, size as usize)))
        };
        *left = left.checked_sub(1).ok_or_else(|| {
            Fault::new(format!("a variable has more than {MOST_VALUES} values, too many for the interpreter"))
        })?;
        match &self.module.types[ty].inner {
            TypeInner::Scalar(of) => scalar(*of),
            TypeInner::Vector { size, scalar } => Ok(Value::Vector(vector(*size, *scalar)?)),
            TypeInner::Matrix { columns, rows, scalar } => {
                Ok(Value::Matrix(vec![vector(*rows, *scalar)?; *columns as usize]))
            }
            TypeInner::Array { base, size: ArraySize::Constant(length), .. } => {
                let mut elements = Vec::new();
                for _ in 0..length.get() {
                    elements.push(self.zero_of(*base, left)?);
                }
                Ok(Value::Composite(elements))
            }
            TypeInner::Struct { members, .. } => {
                let members = members.iter().map(|member| self.zero_of(member.ty, left));
                Ok(Value::Composite(members.collect::<Result<_, _>>()?))
            }
            _ => Err(Fault::new("a variable has a type that is not known to the interpreter")),
        }
    }
}

fn zero_scalar<F: Float>(scalar: naga::Scalar) -> Result<Scalar<F>, Fault> {
    match (scalar.kind, scalar.width) {
        (ScalarKind::Bool, _) => Ok(Scalar::Bool(false)),
        (ScalarKind::Sint, 4) => Ok(Scalar::I32(0)),
        (ScalarKind::Uint, 4) => Ok(Scalar::U32(0)),
        (ScalarKind::Float, 4) => Ok(Scalar::Float(F::of(0.0))),
        (_, width) => Err(Fault::new(format!("numbers of {width} bytes are not known to the interpreter"))),
    }
}

fn beyond(pointer: Pointer) -> String {
    format!("an index is beyond the last: {:?}", pointer.steps())
}

fn statement_name(statement: &Statement) -> &'static str {
    match statement {
        Statement::Kill => "`discard`",
        Statement::ControlBarrier(_) | Statement::MemoryBarrier(_) => "a barrier",
        Statement::ImageStore { .. } => "`textureStore`",
        Statement::Atomic { .. } | Statement::ImageAtomic { .. } => "an atomic operation",
        Statement::WorkGroupUniformLoad { .. } => "`workgroupUniformLoad`",
        Statement::RayQuery { .. } => "a ray query",
        Statement::SubgroupBallot { .. }
        | Statement::SubgroupGather { .. }
        | Statement::SubgroupCollectiveOperation { .. } => "a subgroup operation",
        _ => "a statement",
    }
}
