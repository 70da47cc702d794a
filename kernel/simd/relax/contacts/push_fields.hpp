#pragma once

#include "simd/relax/relax_kernels.hpp"

namespace plumb::simd {

/// Fields that ends and contacts have alike, at the same numbers.
namespace push_fields = end_fields;

static_assert(contact_fields::normal == push_fields::normal && contact_fields::gap == push_fields::gap &&
              contact_fields::push == push_fields::push && contact_fields::across == push_fields::across &&
              contact_fields::over == push_fields::over && contact_fields::moves == push_fields::moves &&
              contact_fields::friction == push_fields::friction);

}  // namespace plumb::simd
