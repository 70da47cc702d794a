#include "simd/double_vector.hpp"
#include "simd/front/front_lanes.hpp"

namespace plumb::simd {

constinit const FrontKernels front_simd128{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
