//! The two types in which a shader's floats are computed.

use std::fmt::Debug;
use std::ops::{Add, Div, Mul, Neg, Rem, Sub};

macro_rules! float {
    (unary: $($unary:ident)*; binary: $($binary:ident)*) => {
        /// A type in which the floats of a shader are computed: `f32`, as on the GPU, or `f64`.
        pub trait Float:
            Copy
            + Debug
            + PartialEq
            + PartialOrd
            + Add<Output = Self>
            + Sub<Output = Self>
            + Mul<Output = Self>
            + Div<Output = Self>
            + Rem<Output = Self>
            + Neg<Output = Self>
        {
            /// Returns the nearest number of this type.
            fn of(x: f64) -> Self;
            /// Returns the number as `f64`.
            fn f64(self) -> f64;
            /// Returns the nearest `f32`.
            fn f32(self) -> f32;
            $(
                /// The method of this name of `f32` and `f64`.
                fn $unary(self) -> Self;
            )*
            $(
                /// The method of this name of `f32` and `f64`.
                fn $binary(self, other: Self) -> Self;
            )*
            /// Returns `self * a + b`, rounded once.
            fn mul_add(self, a: Self, b: Self) -> Self;
        }

        float!(@impl f32: $($unary)*; $($binary)*);
        float!(@impl f64: $($unary)*; $($binary)*);
    };
    (@impl $type:ident: $($unary:ident)*; $($binary:ident)*) => {
        impl Float for $type {
            fn of(x: f64) -> Self {
                x as $type
            }
            fn f64(self) -> f64 {
                f64::from(self)
            }
            fn f32(self) -> f32 {
                self as f32
            }
            $(
                fn $unary(self) -> Self {
                    <$type>::$unary(self)
                }
            )*
            $(
                fn $binary(self, other: Self) -> Self {
                    <$type>::$binary(self, other)
                }
            )*
            fn mul_add(self, a: Self, b: Self) -> Self {
                <$type>::mul_add(self, a, b)
            }
        }
    };
}

float!(
    unary: abs sqrt floor ceil trunc round_ties_even exp exp2 ln log2 sin cos tan asin acos atan sinh cosh tanh asinh
        acosh atanh to_radians to_degrees;
    binary: powf atan2 min max
);
