#pragma once

#include <optional>
#include <string>

#include "scenes/basics/files.hpp"

namespace plumb::bench {

/// A file to be written at the end of a run, opened at its beginning: nobody wants to hear after minutes that
/// it cannot be written. None for an empty path; throws InputError.
inline std::optional<scenes::OutputFile> open_output(const std::string& path) {
  if (path.empty()) return {};
  return std::optional<scenes::OutputFile>(std::in_place, path);
}

inline void finish_output(std::optional<scenes::OutputFile>& file, const std::string& text) {
  if (!file) return;
  file->write(text);
  file->commit();
}

}  // namespace plumb::bench
