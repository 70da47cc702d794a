// An exported page loads nothing: all its modules, its worker and its start are in it, and no text ends its
// element.
#include "view/export/export.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <stdexcept>

#include "support/refusals.hpp"

namespace plumb::view::PLUMB_TEST_FILE {
namespace {

std::size_t count(std::string_view text, std::string_view what) {
  std::size_t out = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, at + 1)) ++out;
  return out;
}

TEST(ViewExport, HasAllInItself) {
  const std::string page =
      exported_page(page_files(), "const a = '</script>';", R"({"name": "</script><b>"})");
  EXPECT_EQ(count(page, " src="), 0U);
  EXPECT_EQ(count(page, "href="), count(page, "href=\"data:,\"")) << "only the empty icon";
  EXPECT_EQ(count(page, "</script>"), 4U) << "modules, worker, start, and what begins";
  EXPECT_NE(page.find(R"(const a = '<\/script>';)"), page.npos);
  EXPECT_NE(page.find(R"(\u003c/script>\u003cb>)"), page.npos);
  std::size_t modules = 0;
  for (const PageFile& file : page_files())
    if (file.name.ends_with(".js") && file.name != "worker.js") {
      EXPECT_EQ(count(page, "\"plumb/" + std::string(file.name) + "\": \"data:text/javascript;base64,"), 1U);
      EXPECT_EQ(count(file.text, "\nimport "), count(file.text, "from \"./") + count(file.text, "from \"../"))
          << file.name;
      ++modules;
    }
  EXPECT_GT(modules, 5U);
  EXPECT_EQ(count(page, "data:text/javascript;base64,"), modules);
}

TEST(ViewExport, RefusesAnotherPage) {
  EXPECT_THROW(exported_page({}, "", ""), std::logic_error);
  EXPECT_THROW(exported_page({{"index.html", "<html>"}, {"style.css", ""}}, "", ""), std::logic_error);
}

TEST(ViewExport, FindsTheWorkerOrSaysHowToBuildIt) {
  const std::filesystem::path folder = std::filesystem::temp_directory_path() / "plumb_view_export" / "bin";
  std::filesystem::remove_all(folder.parent_path());
  std::filesystem::create_directories(folder);
  EXPECT_NE(test::refusal([&] { find_worker(folder / "plumb"); }).find("--target plumb_view_wasm"),
            std::string::npos);
  const std::filesystem::path shared = folder.parent_path() / "share/plumb";
  std::filesystem::create_directories(shared);
  std::ofstream(shared / "plumb_view.js") << "\n";
  EXPECT_EQ(find_worker(folder / "plumb"), shared / "plumb_view.js");
  std::ofstream(folder / "plumb_view.js") << "\n";
  EXPECT_EQ(find_worker(folder / "plumb"), folder / "plumb_view.js");
  std::filesystem::remove_all(folder.parent_path());
}

}  // namespace
}  // namespace plumb::view::PLUMB_TEST_FILE
