#define PLUMB_ARCH xsimd::fma3<xsimd::avx2>
#include "double_vector.hpp"
#include "kkt_body.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_avx2 = kkt_table<Batch>;

}  // namespace plumb::simd
