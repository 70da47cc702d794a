#pragma once

#include <filesystem>
#include <fstream>
#include <string>
#include <string_view>

namespace plumb::scenes {

/// Reads the whole file. Throws InputError with the system's reason.
std::string read_file(const std::filesystem::path& path);

/// An output file appears under its name only once it is complete: it is written beside, and renamed by
/// commit(). Without a commit nothing is left behind, and what stood there before is untouched. A device or a
/// pipe, such as /dev/stdout, is written straight away.
class OutputFile {
 public:
  /// Throws InputError with the system's reason if the file cannot be written there.
  explicit OutputFile(std::filesystem::path path);
  ~OutputFile();
  OutputFile(OutputFile&& other) noexcept;
  OutputFile& operator=(OutputFile&&) = delete;

  void write(std::string_view text) { stream_ << text; }
  /// Finishes the file. Throws InputError if anything written did not reach the disk.
  void commit();

 private:
  std::filesystem::path path_;
  std::filesystem::path beside_;
  std::ofstream stream_;
  bool direct_ = false;
};

/// Opens, writes and commits an OutputFile in one go.
void write_file(const std::filesystem::path& path, std::string_view text);

}  // namespace plumb::scenes
