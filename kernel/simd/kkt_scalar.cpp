#include "double_scalar.hpp"
#include "kkt_body.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_scalar = kkt_table<double>;

}  // namespace plumb::simd
