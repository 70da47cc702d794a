#include "step/sleep.hpp"

#include <algorithm>
#include <utility>

namespace plumb::detail {

void Sleep::start(std::span<const std::unique_ptr<Solver>> solvers, const Settings& settings) {
  relative_speed_ = settings.precision == Precision::single ? 1e-4 : 1e-10;
  sleep_time_ = settings.sleep_time;
  for (std::uint32_t s = 0; s < solvers.size(); ++s) {
    first_task_.push_back(static_cast<std::uint32_t>(tasks_.size()));
    if (solvers[s]->has_changing_pieces()) continue;
    for (std::uint32_t piece = 0; piece < solvers[s]->pieces(); ++piece) tasks_.push_back({s, piece});
  }
  awake_ = static_cast<std::uint32_t>(tasks_.size());
}

void Sleep::exchange(std::span<const std::unique_ptr<Solver>> solvers, std::span<const Seat> seats) {
  // Tasks before those of the first solver that went or came stay where they are.
  const auto end_of = [&](std::uint32_t s) {
    return s + std::size_t{1} < first_task_.size() ? first_task_[s + 1] : tasks_.size();
  };
  std::uint32_t same = 0;
  while (same < first_task_.size() &&
         (seats[same] == Seat::kept || (seats[same] == Seat::free && first_task_[same] == end_of(same))))
    ++same;
  const std::size_t stay = same > 0 ? end_of(same - 1) : 0;
  const auto count_awake = [&] {
    return static_cast<std::uint32_t>(std::count_if(tasks_.begin() + static_cast<std::ptrdiff_t>(stay),
                                                    tasks_.end(),
                                                    [](const Task& task) { return !task.asleep; }));
  };
  awake_ -= count_awake();
  before_.assign(tasks_.begin() + static_cast<std::ptrdiff_t>(stay), tasks_.end());
  tasks_.erase(tasks_.begin() + static_cast<std::ptrdiff_t>(stay), tasks_.end());
  std::size_t next = 0;  // the first task before of a solver with this number or a later one
  first_task_.resize(same);
  for (std::uint32_t s = same; s < solvers.size(); ++s) {
    first_task_.push_back(static_cast<std::uint32_t>(tasks_.size()));
    for (; next < before_.size() && before_[next].solver == s; ++next)
      if (seats[s] == Seat::kept) tasks_.push_back(before_[next]);
    if (seats[s] != Seat::taken) continue;
    for (std::uint32_t piece = 0; piece < solvers[s]->pieces(); ++piece) tasks_.push_back({s, piece});
  }
  awake_ += count_awake();
}

void Sleep::wake(std::span<const std::unique_ptr<Solver>> solvers, Task& task) {
  task.still_time = 0;
  if (!task.asleep) return;
  task.asleep = false;
  ++awake_;
  ++changes_;
  solvers[task.solver]->wake(task.piece);
}

void Sleep::wake(std::span<const std::unique_ptr<Solver>> solvers, Place place) {
  const Solver& solver = *solvers[place.solver];
  if (solver.has_changing_pieces()) return;
  wake(solvers, tasks_[first_task_[place.solver] + solver.piece_of(place.slot)]);
}

void Sleep::wake_all(std::span<const std::unique_ptr<Solver>> solvers) {
  for (Task& task : tasks_) wake(solvers, task);
}

void Sleep::put_to_rest(std::span<const std::unique_ptr<Solver>> solvers, std::size_t number) {
  Task& task = tasks_[number];
  task.asleep = true;
  --awake_;
  ++changes_;
  solvers[task.solver]->rest(task.piece);
}

std::uint32_t Sleep::settle(std::span<const std::unique_ptr<Solver>> solvers, double dt) {
  std::uint32_t fell_asleep = 0;
  for (Task& task : tasks_) {
    if (task.asleep) continue;
    task.still_time = task.is_still ? task.still_time + dt : 0;
    if (task.still_time < sleep_time_) continue;
    put_to_rest(solvers, static_cast<std::size_t>(&task - tasks_.data()));
    fell_asleep += solvers[task.solver]->islands(task.piece);
  }
  return fell_asleep;
}

}  // namespace plumb::detail
