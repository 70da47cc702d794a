#include "interface/archive.hpp"

#include "scene/refuse.hpp"

namespace plumb::detail {

void Archive::refuse_end() const {
  if (restores()) refuse("snapshot: ends early, after ", done_, " bytes of state");
  refuse("snapshot: does not fit into the memory given; snapshot_size() says how many bytes it takes");
}

void Archive::bytes(void* of, std::size_t count) {
  if (way_ != Way::measure) {
    if (count > room_ - done_) refuse_end();
    if (way_ == Way::restore)
      std::memcpy(of, from_ + done_, count);
    else if (count < many)
      std::memcpy(to_ + done_, of, count);
    else
      return save_many(static_cast<const std::byte*>(of), count);
  }
  done_ += count;
}

/// Blocks of the sum begin where bytes are written, not where they are read.
void Archive::save_many(const std::byte* from, std::size_t count) {
  const auto put = [&](std::size_t some) {
    std::memcpy(to_ + done_, from, some);
    done_ += some;
    from += some;
    count -= some;
  };
  put((ByteSum::block - done_ % ByteSum::block) % ByteSum::block);
  add_to_sum();
  const std::size_t copied = sum_.copy({from, count}, to_ + done_);
  done_ += copied;
  summed_ += copied;
  from += copied;
  count -= copied;
  put(count);
}

}  // namespace plumb::detail
