//! Vectors of three numbers, for f32 and f64.

use super::Scalar;

/// A vector.
pub type Triple<T> = [T; 3];

/// The scalar product.
#[must_use]
pub fn dot<T: Scalar>(a: Triple<T>, b: Triple<T>) -> T {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

/// The vector product.
#[must_use]
pub fn cross<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// The sum.
#[must_use]
pub fn plus<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

/// The difference.
#[must_use]
pub fn minus<T: Scalar>(a: Triple<T>, b: Triple<T>) -> Triple<T> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// The product with a number.
#[must_use]
pub fn scaled<T: Scalar>(a: Triple<T>, by: T) -> Triple<T> {
    [a[0] * by, a[1] * by, a[2] * by]
}

/// The vector scaled to the unit sphere; zero for a vector without a direction.
#[must_use]
pub fn unit<T: Scalar>(v: Triple<T>) -> Triple<T> {
    let length = dot(v, v).sqrt();
    if length > T::SHORTEST { [v[0] / length, v[1] / length, v[2] / length] } else { [T::ZERO; 3] }
}
