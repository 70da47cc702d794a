#pragma once

#include <optional>
#include <string>

#include "scenes/basics/files.hpp"

namespace plumb::bench {

/// Opens a file at the beginning of a run that is written at its end. Nobody wants to hear after minutes that
/// it cannot be written. Returns nothing for an empty path. Throws InputError if the file cannot be opened.
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
