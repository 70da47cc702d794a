#include "simd/tree/tree_vector.hpp"

namespace plumb::simd {

constinit const TreeKernels<float> tree_simd128_float{
    prepare<float>,        newton<float>,  newton_line<float>, newton_segments<float>,
    find_stiffness<float>, advance<float>, project<float>};
constinit const TreeKernels<double> tree_simd128_double{
    prepare<double>,        newton<double>,  newton_line<double>, newton_segments<double>,
    find_stiffness<double>, advance<double>, project<double>};

}  // namespace plumb::simd
