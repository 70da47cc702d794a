#pragma once

#include <string_view>
#include <vector>

namespace plumb::view {

/// A file of the page, as it stands in tools/view/page.
struct PageFile {
  std::string_view name;
  std::string_view text;
};

/// Returns all files of the page. The build makes this function of them.
std::vector<PageFile> page_files();

}  // namespace plumb::view
