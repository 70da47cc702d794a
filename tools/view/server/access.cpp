#include "view/server/access.hpp"

#include <random>

namespace plumb::view {
namespace {

bool is_own_name(const Door& door, std::string_view host) {
  const std::string port = ":" + std::to_string(door.port);
  return host == "127.0.0.1" + port || host == "localhost" + port;
}

/// Takes the same time wherever the texts begin to differ.
bool are_equal(std::string_view a, std::string_view b) {
  if (a.size() != b.size()) return false;
  unsigned difference = 0;
  for (std::size_t i = 0; i < a.size(); ++i) difference |= static_cast<unsigned>(a[i] ^ b[i]);
  return difference == 0;
}

}  // namespace

std::string make_token() {
  std::random_device source;
  std::string out;
  for (int i = 0; i < 32; ++i) out += "0123456789abcdef"[source() % 16];
  return out;
}

std::string address(const Door& door) {
  return "http://127.0.0.1:" + std::to_string(door.port) + "/" + door.token + "/";
}

std::string refusal(const Door& door, const Visit& visit) {
  if (!is_own_name(door, visit.host))
    return "This server answers to 127.0.0.1 and localhost alone, not to '" + std::string(visit.host) + "'.";
  constexpr std::string_view scheme = "http://";
  if (!visit.origin.empty() &&
      (!visit.origin.starts_with(scheme) || !is_own_name(door, visit.origin.substr(scheme.size()))))
    return "Pages of '" + std::string(visit.origin) + "' have no access.";
  const std::size_t end = visit.target.find('/', 1);
  if (!visit.target.starts_with('/') || end == std::string_view::npos ||
      !are_equal(visit.target.substr(1, end - 1), door.token))
    return "The token is wrong. Open the address that plumb view printed when it started.";
  return {};
}

std::string_view file_of(const Door& door, std::string_view target) {
  target.remove_prefix(door.token.size() + 2);
  target = target.substr(0, target.find('?'));
  return target.empty() ? "index.html" : target;
}

}  // namespace plumb::view
