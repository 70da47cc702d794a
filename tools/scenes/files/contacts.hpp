#pragma once

#include <span>
#include <string>
#include <string_view>

#include "plumb/shapes/contact.hpp"

/// Files of contacts have the header `t,a,b,phase,x,y,z,nx,ny,nz,ix,iy,iz,speed`. A row is one pair of shapes
/// in the frame that ends at a saved time.
namespace plumb::scenes {

inline constexpr std::string_view contacts_header = "t,a,b,phase,x,y,z,nx,ny,nz,ix,iy,iz,speed\n";

/// Appends the rows of one saved time (s). Shapes are named as in `capsule 3`.
void append_contacts(std::string& csv, double t, std::span<const Contact> contacts);

}  // namespace plumb::scenes
