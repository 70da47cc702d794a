#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "profile/caches.hpp"

namespace plumb::tools {

/// Totals of a whole program run by event, as cachegrind spells events: Ir, D1mr, DLmw, ... Only those that
/// it counted.
using CachegrindTotals = std::map<std::string, std::uint64_t, std::less<>>;

/// The totals in the text of a cachegrind output file: its `events:` and `summary:` lines. Throws InputError
/// if either is missing or they do not match.
CachegrindTotals parse_cachegrind(std::string_view text);

/// The program `name` as the PATH finds it; none if it does not.
std::optional<std::filesystem::path> find_program(const std::string& name);

/// A run of this program, with other arguments, under cachegrind. Several may run at once.
class CachegrindRun {
 public:
  /// Starts it. `folder` takes its files, whose names begin with `name`. Throws InputError if it cannot be
  /// started.
  CachegrindRun(const std::filesystem::path& valgrind, const std::vector<std::string>& arguments,
                const Cache& first, const Cache& last, const std::filesystem::path& folder,
                const std::string& name);
  ~CachegrindRun();
  CachegrindRun(const CachegrindRun&) = delete;
  CachegrindRun& operator=(const CachegrindRun&) = delete;

  struct Result {
    CachegrindTotals totals;
    std::string output;  ///< what the program wrote to its standard output
  };
  /// Waits for its end. Throws InputError with the last words of the run if it fails.
  Result finish();

 private:
  int wait();

  std::filesystem::path counts_, output_, messages_;
  int process_ = -1;
};

/// A folder of its own for files that are not to stay.
class TemporaryFolder {
 public:
  TemporaryFolder();
  ~TemporaryFolder();
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const std::filesystem::path& path() const { return path_; }

 private:
  std::filesystem::path path_;
};

}  // namespace plumb::tools
