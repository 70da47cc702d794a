#include "contact/edits/kept_part.hpp"

#include "contact/linkage/scene_parts.hpp"

namespace plumb::detail {

Scene KeptPart::scene() const {
  if (!names_) return *whole_;
  Scene out = part_of(*whole_, *names_);
  if (is_lumped_) lump_masses(out);
  return out;
}

bool KeptPart::is_of_body(std::uint32_t number) const {
  const Rod& of = rod(number);
  return any(whole_->bodies, [&](const Body& body) {
    return std::count_if(body.particles.begin(), body.particles.end(),
                         [&](std::uint32_t each) { return each == of.a || each == of.b; }) == 2;
  });
}

bool KeptPart::bends(std::uint32_t number) const {
  const Rod& of = rod(number);
  const auto joins = [&](std::uint32_t one, std::uint32_t other) {
    return (of.a == one && of.b == other) || (of.a == other && of.b == one);
  };
  return any(whole_->bends, [&](const Bend& bend) { return joins(bend.a, bend.b) || joins(bend.b, bend.c); });
}

bool KeptPart::stands_like(const Scene& part) const {
  const auto position = [&](std::size_t k) {
    return whole_->particles[names_ ? names_->particles[k] : k].position;
  };
  for (std::size_t k = 1; k < part.particles.size(); ++k)
    if (position(k) - position(0) != part.particles[k].position - part.particles[0].position) return false;
  return true;
}

}  // namespace plumb::detail
