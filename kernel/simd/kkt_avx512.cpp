// In vectors of 256 bits: of 512 these short loops between scalar code are 5% slower (Cascade Lake).
#define PLUMB_ARCH xsimd::avx2
#include "double_vector.hpp"
#include "kkt_body.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_avx512{solve<Batch>, combine<Batch>, add_three<Batch>, accumulate<Batch>};

}  // namespace plumb::simd
