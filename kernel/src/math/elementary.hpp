#pragma once

#include <cstdint>

/// These elementary functions have the same bits on every machine. Those of the C library pick a variant by
/// the processor, with or without fused multiply-add. They also differ from one library to the next in the
/// last bit.
///
/// They are made of + − × ÷ √ and of bits, which IEEE 754 fixes, and need rounding to nearest and no
/// contraction (-ffp-contract=off). Errors are in units in the last place (ulp) of the exact result;
/// elementary_test.cpp measures them. A result that would be subnormal is rounded once, or flushed to zero
/// where the caller has asked the processor to.
namespace plumb::detail {

/// Returns eˣ for any x, within 1 ulp. Above 709.782… it is infinity, below −745.133… zero.
double exp(double x);

/// Returns eˣ − 1 for any x, within 2 ulp; also near zero, where exp(x) − 1 cancels.
double expm1(double x);

/// Returns the angle in [0, π] rad whose cosine is x, within 1 ulp. It is NaN unless −1 <= x <= 1.
double acos(double x);

/// Returns the real cube root of any x, within 1 ulp.
double cbrt(double x);

/// Returns x^(1/order) for x >= 0, within 2 ulp. Orders are 1, 2, 4 and 6, those of a step in time.
double root(double x, std::uint32_t order);

}  // namespace plumb::detail
