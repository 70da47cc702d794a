// This file writes and reads snapshots of a world. kernel/README.md says what their bytes mean.

#include <algorithm>
#include <cstring>
#include <utility>

#include "step/snapshot/header.hpp"
#include "step/world_impl.hpp"

namespace plumb {

using detail::Archive;
using detail::Header;
using detail::refuse;

namespace {

/// Returns the header of a snapshot that fits to a world. Refuses others with a reason.
Header checked(std::span<const std::byte> from, const detail::Fingerprint& world) {
  if (from.size() < sizeof(Header))
    refuse("snapshot: has ", from.size(), " bytes, and its header alone takes ", sizeof(Header));
  Header header;
  Archive archive = Archive::restore(from);
  archive(header);
  if (header.begin != detail::snapshot_magic) refuse("snapshot: does not begin as one");
  if (header.format_of != detail::snapshot_format)
    refuse("snapshot: has format ", header.format_of, ", and this plumb reads ", detail::snapshot_format);
  if (header.size < sizeof(Header) || header.size > from.size())
    refuse("snapshot: is cut off, or damaged: it says that it has ", header.size, " bytes, and ", from.size(),
           " are here");
  if (header.sum != detail::sum_over(header, from.first(header.size)))
    refuse("snapshot: is damaged: the sum over its bytes is not what it was");
  if (header.library_of != detail::library_version)
    refuse("snapshot: was written by another version of plumb");
  if (header.fits_to.scene != world.scene) refuse("snapshot: is of another scene");
  if (header.fits_to.settings != world.settings)
    refuse(
        "snapshot: is of a world with other settings; only isa, threads, executor, stop and weights may "
        "differ");
  return header;
}

}  // namespace

void World::Impl::archive_own(Archive& archive, Impl& of) {
  auto& [memory, step, fixed, precision, twists, of_kind, platforms, targets, chains, bodies, positions,
         velocities, teleports, tensions, contacts, events, time, log, fingerprint] = of;
  archive(time, platforms, targets);
}

/// The past is listed first, since all else fits only to a world that became alike.
void World::Impl::archive(Archive& archive) {
  if (!step->has_archive())
    refuse("snapshot: springs, multipliers and featherstone keep none; relax, direct and auto do");
  if (!archive.restores()) {
    step->archive_past(archive);
    archive_own(archive, *this);
    return step->archive(archive);
  }
  if (auto other = step->restored_past(archive)) {
    step = std::move(other);
    bodies = detail::BodyPoses(step->scene());
  }
  archive_own(archive, *this);
  step->archive(archive);
  fit_numbers();
  const std::span<const std::uint8_t> will_be = step->will_be_fixed();
  std::copy_n(will_be.begin(), fixed.size(), fixed.begin());
  step->population().particles.for_free([this](std::uint32_t particle) { fixed[particle] = 0; });
}

std::size_t World::snapshot_size() const {
  Archive archive = Archive::measure();
  impl_->archive(archive);
  return sizeof(Header) + archive.size();
}

std::size_t World::save(std::span<std::byte> out) const {
  if (out.size() < sizeof(Header))
    refuse("snapshot: does not fit into ", out.size(), " bytes; snapshot_size() says how many it takes");
  Archive body = Archive::save(out.subspan(sizeof(Header)));
  impl_->archive(body);
  const Header header{.size = sizeof(Header) + body.size(), .fits_to = impl_->fingerprint};
  detail::write_header(header, out, [&](std::span<const std::byte> own) { return body.sum_with(own); });
  return header.size;
}

void World::restore(std::span<const std::byte> from) {
  const Header header = checked(from, impl_->fingerprint);
  Archive body = Archive::restore(from.first(header.size).subspan(sizeof(Header)));
  impl_->archive(body);
  if (body.size() != header.size - sizeof(Header)) refuse("snapshot: holds more than this world reads");
}

}  // namespace plumb
