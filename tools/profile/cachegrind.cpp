#include "profile/cachegrind.hpp"

#include <fcntl.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <sstream>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"
#include "scenes/basics/numbers.hpp"

namespace plumb::tools {
namespace {

std::vector<std::string> words_of(std::string_view line) {
  std::istringstream in{std::string(line)};
  std::vector<std::string> words;
  for (std::string word; in >> word;) words.push_back(word);
  return words;
}

std::string cache_option(const char* name, const Cache& cache) {
  return std::string("--") + name + "=" + std::to_string(cache.bytes) + "," + std::to_string(cache.ways) +
         "," + std::to_string(cache.line);
}

/// Returns the last line that says something.
std::string last_words(const std::string& text) {
  std::istringstream in(text);
  std::string last;
  for (std::string line; std::getline(in, line);)
    if (line.find_first_not_of(" \t") != std::string::npos) last = line;
  return last;
}

}  // namespace

CachegrindTotals parse_cachegrind(std::string_view text) {
  constexpr std::string_view events_mark = "events:", summary_mark = "summary:";
  std::vector<std::string> events, summary;
  while (!text.empty()) {
    const std::size_t end = std::min(text.find('\n'), text.size());
    const std::string_view line = text.substr(0, end);
    text.remove_prefix(std::min(end + 1, text.size()));
    if (line.starts_with(events_mark)) events = words_of(line.substr(events_mark.size()));
    if (line.starts_with(summary_mark)) summary = words_of(line.substr(summary_mark.size()));
  }
  if (events.empty()) throw InputError("cachegrind's output has no line 'events:'");
  if (summary.empty()) throw InputError("cachegrind's output has no line 'summary:'");
  if (events.size() != summary.size()) {
    throw InputError("cachegrind's output names " + std::to_string(events.size()) + " events and sums up " +
                     std::to_string(summary.size()));
  }
  CachegrindTotals totals;
  for (std::size_t i = 0; i < events.size(); ++i) {
    const auto count = scenes::parse_number<std::uint64_t>(summary[i]);
    if (!count) throw InputError("cachegrind's output: '" + summary[i] + "' is not a count");
    totals[events[i]] = *count;
  }
  return totals;
}

std::optional<std::filesystem::path> find_program(const std::string& name) {
  const char* path = std::getenv("PATH");
  std::istringstream in(path ? path : "");
  for (std::string folder; std::getline(in, folder, ':');) {
    const std::filesystem::path file = std::filesystem::path(folder.empty() ? "." : folder) / name;
    std::error_code error;
    if (std::filesystem::is_regular_file(file, error) && ::access(file.c_str(), X_OK) == 0) return file;
  }
  return {};
}

CachegrindRun::CachegrindRun(const std::filesystem::path& valgrind, const std::vector<std::string>& arguments,
                             const Cache& first, const Cache& last, const std::filesystem::path& folder,
                             const std::string& name)
    : counts_(folder / (name + ".counts")),
      output_(folder / (name + ".output")),
      messages_(folder / (name + ".messages")) {
  std::vector<std::string> words{valgrind.string(),
                                 "--tool=cachegrind",
                                 "--quiet",
                                 "--cache-sim=yes",
                                 cache_option("D1", first),
                                 cache_option("LL", last),
                                 "--cachegrind-out-file=" + counts_.string(),
                                 std::filesystem::read_symlink("/proc/self/exe").string()};
  words.insert(words.end(), arguments.begin(), arguments.end());
  std::vector<char*> pointers;
  for (std::string& word : words) pointers.push_back(word.data());
  pointers.push_back(nullptr);

  constexpr int flags = O_WRONLY | O_CREAT | O_TRUNC;
  posix_spawn_file_actions_t actions;
  ::posix_spawn_file_actions_init(&actions);
  ::posix_spawn_file_actions_addopen(&actions, STDOUT_FILENO, output_.c_str(), flags, 0600);
  ::posix_spawn_file_actions_addopen(&actions, STDERR_FILENO, messages_.c_str(), flags, 0600);
  pid_t process = -1;
  const int error = ::posix_spawn(&process, valgrind.c_str(), &actions, nullptr, pointers.data(), environ);
  ::posix_spawn_file_actions_destroy(&actions);
  if (error != 0) throw InputError("cannot start " + valgrind.string() + ": " + std::strerror(error));
  process_ = process;
}

CachegrindRun::~CachegrindRun() {
  wait();
}

int CachegrindRun::wait() {
  int status = 0;
  if (process_ < 0) return status;
  while (::waitpid(process_, &status, 0) < 0 && errno == EINTR) {
  }
  process_ = -1;
  return status;
}

CachegrindRun::Result CachegrindRun::finish() {
  const int status = wait();
  if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
    throw InputError("a run under cachegrind failed, " +
                     (WIFSIGNALED(status) ? "signal " + std::to_string(WTERMSIG(status))
                                          : "exit status " + std::to_string(WEXITSTATUS(status))) +
                     ": " + last_words(scenes::read_file(messages_)));
  }
  return {parse_cachegrind(scenes::read_file(counts_)), scenes::read_file(output_)};
}

TemporaryFolder::TemporaryFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "plumb-profile-XXXXXX").string();
  if (::mkdtemp(pattern.data()) == nullptr)
    throw InputError("cannot make the folder " + pattern + ": " + std::strerror(errno));
  path_ = pattern;
}

TemporaryFolder::~TemporaryFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

}  // namespace plumb::tools
