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

/// Totals belong to a whole program run. Events are spelt as cachegrind does: Ir, D1mr, DLmw and others. Only
/// events that it counted are there.
using CachegrindTotals = std::map<std::string, std::uint64_t, std::less<>>;

/// Reads the totals from the lines `events:` and `summary:` of a cachegrind output file. Throws InputError if
/// either is missing or they do not match.
CachegrindTotals parse_cachegrind(std::string_view text);

/// Returns the program `name` as the PATH finds it, or none.
std::optional<std::filesystem::path> find_program(const std::string& name);

/// Runs this program, with other arguments, under cachegrind. Several runs may go on at once.
class CachegrindRun {
 public:
  /// Starts the run. `folder` takes its files, whose names begin with `name`. Throws InputError if it cannot
  /// be started.
  CachegrindRun(const std::filesystem::path& valgrind, const std::vector<std::string>& arguments,
                const Cache& first, const Cache& last, const std::filesystem::path& folder,
                const std::string& name);
  ~CachegrindRun();
  CachegrindRun(const CachegrindRun&) = delete;
  CachegrindRun& operator=(const CachegrindRun&) = delete;

  struct Result {
    CachegrindTotals totals;
    std::string output;  ///< What the program wrote to its standard output.
  };
  /// Waits for the end of the run. Throws InputError with its last words if it fails.
  Result finish();

 private:
  int wait();

  std::filesystem::path counts_, output_, messages_;
  int process_ = -1;
};

/// Makes a folder for files that are not to stay, and removes it at the end of the block.
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
