#include "scenes/basics/files.hpp"

#include <unistd.h>

#include <cerrno>
#include <sstream>
#include <system_error>
#include <utility>

#include "plumb/error.hpp"

namespace plumb::scenes {
namespace {

[[noreturn]] void fail(const char* verb, const std::filesystem::path& path, int code) {
  throw InputError(std::string("cannot ") + verb + " " + path.string() + ": " +
                   std::generic_category().message(code));
}

}  // namespace

std::string read_file(const std::filesystem::path& path) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path, ignored)) fail("read", path, EISDIR);
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in) fail("read", path, errno ? errno : EIO);
  std::ostringstream text;
  text << in.rdbuf();
  if (in.bad()) fail("read", path, EIO);
  return std::move(text).str();
}

OutputFile::OutputFile(std::filesystem::path path) : path_(std::move(path)), beside_(path_) {
  std::error_code ignored;
  if (std::filesystem::is_directory(path_, ignored)) fail("write", path_, EISDIR);
  if (std::filesystem::is_regular_file(path_, ignored)) {
    // Through a link, the file it points to is replaced and the link stays.
    path_ = std::filesystem::canonical(path_);
    beside_ = path_;
  }
  // A device or a pipe would be gone if a file were renamed onto it.
  direct_ = std::filesystem::exists(path_, ignored) && !std::filesystem::is_regular_file(path_, ignored);
  if (!direct_) beside_ += ".partial-" + std::to_string(::getpid());
  errno = 0;
  stream_.open(beside_, std::ios::binary | std::ios::trunc);
  if (!stream_) fail("write", path_, errno ? errno : EIO);
}

OutputFile::OutputFile(OutputFile&& other) noexcept
    : path_(std::move(other.path_)),
      beside_(std::exchange(other.beside_, {})),
      stream_(std::move(other.stream_)),
      direct_(other.direct_) {}

OutputFile::~OutputFile() {
  if (beside_.empty() || direct_) return;
  stream_.close();
  std::error_code ignored;
  std::filesystem::remove(beside_, ignored);
}

void OutputFile::commit() {
  errno = 0;
  stream_.close();
  if (stream_.fail()) fail("write", path_, errno ? errno : EIO);
  if (direct_) return;
  std::error_code error;
  std::filesystem::rename(beside_, path_, error);
  if (error) fail("write", path_, error.value());
  beside_.clear();
}

void write_file(const std::filesystem::path& path, std::string_view text) {
  OutputFile file(path);
  file.write(text);
  file.commit();
}

}  // namespace plumb::scenes
