#pragma once

#include <string>
#include <utility>

#include "interface/problems.hpp"
#include "plumb/report.hpp"

namespace plumb::detail {

/// Puts into words what troubles a world, when they begin and when they end.
class StepLog {
 public:
  StepLog() = default;
  explicit StepLog(plumb::Log log) : log_(std::move(log)) {}

  bool hears() const { return log_ != nullptr; }
  void begin(const WorldInfo& info);
  /// Tells of a step that was done, of which the world knows more.
  void tell(const StepReport& report, const World& world);

 private:
  void line(LogLevel level, const std::string& text) const { log_(level, text); }

  plumb::Log log_;
  Troubles last_ = 0;  ///< those of the last step
};

}  // namespace plumb::detail
