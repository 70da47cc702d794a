#define PLUMB_ARCH xsimd::avx512bw
#include "double_vector.hpp"
#include "kkt_body.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_avx512{solve<Batch>, combine<Batch>, add_three<Batch>, accumulate<Batch>};

}  // namespace plumb::simd
