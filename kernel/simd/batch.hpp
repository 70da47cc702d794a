// Vectors of one instruction set under one name: Batch of xsimd for its architecture PLUMB_ARCH, where a file
// sets that before, else plumb's own of 128 bits. Everything has internal linkage, since files of every set
// include it.
#pragma once

#ifdef PLUMB_ARCH
#include <xsimd/xsimd.hpp>
#else
#include "simd/vector128.hpp"
#endif

namespace plumb::simd {
namespace {

#ifdef PLUMB_ARCH
namespace lanes = xsimd;
template <class T>
using BatchOf = xsimd::batch<T, PLUMB_ARCH>;
#else
namespace lanes = vector128;
template <class T>
using BatchOf = vector128::Batch<T>;
#endif

}  // namespace
}  // namespace plumb::simd
