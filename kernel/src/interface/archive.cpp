#include "interface/archive.hpp"

#include "scene/refuse.hpp"

namespace plumb::detail {

void Archive::refuse_end() const {
  if (restores()) refuse("snapshot: ends early, after ", done_, " bytes of state");
  refuse("snapshot: does not fit into the memory given; snapshot_size() says how many bytes it takes");
}

}  // namespace plumb::detail
