// One number after the other: the oracle of the vector bodies.
#include "front_kernels.hpp"

namespace plumb::simd {
namespace {

template <class V>
inline V load(const double* from) {
  return *from;
}
template <class V>
inline V broadcast(double value) {
  return value;
}
inline void store(double value, double* to) {
  *to = value;
}

}  // namespace
}  // namespace plumb::simd

#include "front_body.hpp"

namespace plumb::simd {

constinit const FrontKernels front_scalar{eliminate<double>, forward<double>, backward<double>};

}  // namespace plumb::simd
