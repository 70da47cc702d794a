#pragma once

#include <memory>

#include "golden/table.hpp"
#include "plumb/plumb.hpp"

namespace plumb::golden {

/// How a row is run, which must not change a bit.
struct Machine {
  Isa isa = Isa::scalar;
  unsigned threads = 1;
  Executor* executor = nullptr;
};

struct Outcome {
  Hashes hashes{};
  Hashes before{};  ///< of the world as it starts
  bool finite = true;
  bool has_shapes = false;
  StepReport total{};
};

/// A row's scene, which goes through the row's drive, words joined by '+':
///
///   still    nothing but equal steps
///   platforms  the first platform goes 12 steps on its way and turns, rests for 4, and so on
///   anchors  the first fixed particle goes 8 steps on its way, rests for 4, and so on
///   forces   the last movable particle is pushed, then pushed otherwise, then let go
///   uneven   steps are 1, 3/4 and 5/4 of dt, in turn
///   rules    half way, sweeps are doubled and weights are changed to equal ones
class RowRun {
 public:
  RowRun(const Row& row, const Machine& machine);
  ~RowRun();

  /// Takes the step of a number, with what is done before it.
  StepReport step(std::uint32_t number);
  World& world();
  const Scene& scene() const;

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

/// Steps the row's scene through all of its steps.
Outcome run_row(const Row& row, const Machine& machine);

}  // namespace plumb::golden
