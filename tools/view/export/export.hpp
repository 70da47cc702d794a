#pragma once

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "view/server/page_files.hpp"

/// The page of plumb view as one file that needs no server: worlds run in it, in WebAssembly.
namespace plumb::view {

/// Finds the script of the worker (target `plumb_view_wasm`) beside a program, where it is installed, or
/// where the preset `wasm` builds it. Throws InputError with the commands that build it.
std::filesystem::path find_worker(const std::filesystem::path& program);

/// Returns the page as a text of HTML that loads nothing. `worker` is the worker's script, and `start` the
/// text of a replay: what the page begins with. Throws std::logic_error if the page is not made as this
/// expects.
std::string exported_page(const std::vector<PageFile>& files, std::string_view worker,
                          std::string_view start);

}  // namespace plumb::view
