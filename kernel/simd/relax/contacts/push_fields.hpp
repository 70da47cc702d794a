#pragma once

#include "simd/relax/relax_kernels.hpp"

namespace plumb::simd {

/// Fields that ends and contacts have alike, at the same numbers.
namespace push_fields = end_fields;

static_assert(line_contact_fields::normal == push_fields::normal &&
              line_contact_fields::gap == push_fields::gap &&
              line_contact_fields::push == push_fields::push &&
              line_contact_fields::over == push_fields::over &&
              line_contact_fields::friction == push_fields::friction);
static_assert(contact_fields::normal == push_fields::normal && contact_fields::gap == push_fields::gap &&
              contact_fields::push == push_fields::push && contact_fields::over == push_fields::over &&
              contact_fields::friction == push_fields::friction);

}  // namespace plumb::simd
