// The page of measurements: what it lists.

#include "plot/page.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "scenes/basics/files.hpp"

namespace plumb::tools::PLUMB_TEST_FILE {
namespace {

TEST(Page, BeginsWithItsContents) {
  const std::filesystem::path folder = testing::TempDir() + "page_contents";
  std::filesystem::remove_all(folder);
  make_folder(folder);
  const scenes::Machine machine{};
  const Section frontier("frontier", "Run time & error", "plumb frontier", machine);
  frontier.publish_alone(folder);
  frontier.publish(folder);
  Section("thesis", "A heavy last link", "plumb thesis", machine).publish(folder);
  const std::string page = scenes::read_file(folder / "index.html");
  const std::size_t begin = page.find("<ul>"), end = page.find("</ul>");
  EXPECT_EQ(page.substr(begin, end - begin),
            "<ul>\n"
            "<li><a href=\"#thesis\">A heavy last link</a></li>\n"
            "<li><a href=\"#frontier\">Run time &amp; error</a>, <a href=\"frontier.html\">its own "
            "page</a></li>\n");
  EXPECT_LT(end, page.find("<section id=\"thesis\">"));
  EXPECT_EQ(scenes::read_file(folder / "frontier.html").find("<ul>"), std::string::npos);
  std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace plumb::tools::PLUMB_TEST_FILE
