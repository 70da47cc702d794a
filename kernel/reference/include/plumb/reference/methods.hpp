#pragma once

#include "plumb/export.hpp"

/// @file
/// This file offers the methods that the thesis compares with: stiff springs (3.3), Lagrange multipliers
/// (3.4) and Featherstone's articulated bodies (3.5). They are a library of their own, `plumb::reference`, so
/// that programs which only simulate do not carry them.
namespace plumb {

/// Makes Method::springs, multipliers and featherstone known to World. Call it once, before the first World,
/// while no other thread uses plumb. A second call changes nothing.
PLUMB_API void register_reference_methods();

}  // namespace plumb
