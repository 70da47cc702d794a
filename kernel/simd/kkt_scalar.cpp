#include "double_scalar.hpp"
#include "kkt_body.hpp"

namespace plumb::simd {

constinit const KktKernels kkt_scalar{solve<double>, combine<double>, add_three<double>, accumulate<double>};

}  // namespace plumb::simd
