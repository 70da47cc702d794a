#pragma once

#include <span>
#include <string>

namespace plumb::tools {

/// Encodes bytes as base64 with padding (RFC 4648).
std::string encode_base64(std::span<const unsigned char> bytes);

}  // namespace plumb::tools
