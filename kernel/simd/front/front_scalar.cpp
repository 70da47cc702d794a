#include "simd/double_scalar.hpp"
#include "simd/front/front_lanes.hpp"

namespace plumb::simd {

constinit const FrontKernels front_scalar{eliminate<double>, forward<double>, backward<double>};

}  // namespace plumb::simd
