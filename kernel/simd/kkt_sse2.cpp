#define PLUMB_ARCH xsimd::sse2
#include "double_vector.hpp"
#include "kkt_body.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_sse2 = kkt_table<Batch>;

}  // namespace plumb::simd
