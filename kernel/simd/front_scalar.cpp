#include "double_scalar.hpp"
#include "front_body.hpp"

namespace plumb::simd {

constinit const FrontKernels front_scalar{eliminate<double>, forward<double>, backward<double>};

}  // namespace plumb::simd
