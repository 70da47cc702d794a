#define PLUMB_ARCH xsimd::avx512bw
#include "double_vector.hpp"
#include "front_body.hpp"

namespace plumb::simd {

constinit const FrontKernels front_avx512{eliminate<Batch>, forward<Batch>, backward<Batch>};

}  // namespace plumb::simd
