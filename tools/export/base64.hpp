#pragma once

#include <span>
#include <string>

namespace plumb::tools {

/// RFC 4648, with padding.
std::string encode_base64(std::span<const unsigned char> bytes);

}  // namespace plumb::tools
