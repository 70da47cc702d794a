#include "plot/page.hpp"

#include <algorithm>
#include <string_view>
#include <vector>

#include "plumb/error.hpp"
#include "scenes/basics/files.hpp"

namespace plumb::tools {
namespace {

constexpr const char* page_head = R"(<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>plumb: measured</title>
<style>
:root { color-scheme: light dark; --ink: #222; --soft: #555; --back: #fff; --card: #f5f6f8; --line: #ddd; --strong: #888;
  --accent: #1f5fa8; --near: #1f5fa8; --far: #8fb3dc; --ball: #d1495b; --ground: #777; --shade: #0003; }
@media (prefers-color-scheme: dark) { :root { --ink: #e6eaf2; --soft: #9aa5b8; --back: #11151c; --card: #1a202b; --line: #2d3646;
  --strong: #6b7890; --accent: #6ea8f0; --near: #5b9bff; --far: #2f578f; --ball: #ff7a8a; --ground: #8a94a6; --shade: #000a; } }
body { font: 16px/1.5 system-ui, sans-serif; color: var(--ink); background: var(--back); max-width: 62rem; margin: 2rem auto; padding: 0 1rem; overflow-wrap: break-word; }
a { color: var(--accent); }
h1 { font-size: 1.8rem; margin-bottom: 0; }
h2 { margin-top: 3rem; padding-top: 1rem; border-top: 2px solid var(--accent); }
h3 { margin-top: 2rem; }
p { max-width: 46rem; }
table { border-collapse: collapse; font-size: 0.9rem; font-variant-numeric: tabular-nums; margin: 1rem 0; display: block; }
th, td { padding: 0.2rem 0.6rem; text-align: right; border-bottom: 1px solid var(--line); white-space: nowrap; }
th:first-child, td:first-child { text-align: left; padding-left: 0; }
td.text { white-space: normal; min-width: 14rem; }
.text { text-align: left; }
th { border-bottom: 2px solid var(--strong); font-weight: 600; }
figure { margin: 1rem 0; }
figure { overflow-x: auto; }
/* A shade at the edge says that there is more: what moves along covers it at both ends. */
table { overflow-x: auto; background: linear-gradient(90deg, var(--back) 1.5rem, transparent) 0 0 / 3rem 100% local no-repeat,
  linear-gradient(270deg, var(--back) 1.5rem, transparent) 100% 0 / 3rem 100% local no-repeat,
  linear-gradient(90deg, var(--shade), transparent) 0 0 / 0.7rem 100% scroll no-repeat,
  linear-gradient(270deg, var(--shade), transparent) 100% 0 / 0.7rem 100% scroll no-repeat; }
/* Wide ones reach to the edge of a window that is wider than the text. */
@media (min-width: 64rem) { table { width: max-content; max-width: calc(50vw + 29rem); } }
/* Pictures are files of their own, too, and white in the dark. */
svg { display: block; max-width: 100%; height: auto; background: #fff; border-radius: 4px; }
.made { font-size: 0.85rem; color: var(--soft); background: var(--card); padding: 0.6rem 1rem; border-radius: 4px; max-width: none; }
code { font-size: 0.9em; }
.replay { max-width: 38rem; }
.runs { display: grid; grid-auto-flow: column; grid-auto-columns: minmax(0, 19rem); gap: 0.5rem; align-items: end; }
.runs p { margin: 0 0 0.3rem; font-size: 0.9rem; }
.runs canvas { display: block; width: 100%; }
.time { display: flex; align-items: center; gap: 0.6rem; margin-top: 0.4rem; }
.time input { flex: 1; min-width: 0; accent-color: var(--accent); }
.time output { min-width: 3.5rem; text-align: right; font-variant-numeric: tabular-nums; color: var(--soft); }
.time button, .time select { font: inherit; font-size: 0.9rem; min-width: 4.5rem; min-height: 2.2rem; color: inherit; background: var(--card); border: 1px solid var(--line); border-radius: 6px; }
@media (max-width: 700px) {
  .time button, .time select { min-height: 2.8rem; }
  th:first-child, td:first-child { white-space: normal; overflow-wrap: break-word; min-width: 4.5rem; max-width: 9rem; }
  th { white-space: normal; }
  th, td { padding: 0.2rem 0.5rem; }
  td.text { min-width: 11rem; }
  figure svg { max-width: none; width: 42rem; }
}
</style>
</head>
<body>
<h1>plumb</h1>
<p>What this build measures on this machine.</p>
)";

constexpr const char* page_end = "</body>\n</html>\n";

/// Stands in a section where a link to its live page comes, if there is one.
constexpr std::string_view live_mark = "<!--live-->";

std::string with_live(std::string section, const std::filesystem::path& folder, const std::string& name) {
  const std::size_t at = section.find(live_mark);
  if (at == std::string::npos) return section;
  const std::string page = "live/" + name + "/index.html";
  return section.replace(
      at, live_mark.size(),
      std::filesystem::exists(folder / page)
          ? "<p><a href=\"" + page + "\">Play with it</a>, live in this browser.</p>"
          : "<p>To play with it, run <code>plumb view</code>, or <code>tools/setup --ports</code> and then "
            "<code>tools/demo</code> again, which puts live pages here.</p>");
}

/// Turns an SVG file's text into an element of a page: it keeps what follows the <svg tag. Every id gets a
/// prefix, because gnuplot gives the same ids to all its pictures.
std::string inline_svg(std::string svg, const std::string& prefix) {
  if (const std::size_t start = svg.find("<svg"); start != std::string::npos) svg.erase(0, start);
  for (const char* mark : {"id=\"", "id='", "href=\"#", "href='#", "url(#"}) {
    const std::size_t length = std::char_traits<char>::length(mark);
    for (std::size_t at = svg.find(mark); at != std::string::npos; at = svg.find(mark, at + length)) {
      svg.insert(at + length, prefix + "-");
    }
  }
  return svg;
}

/// Returns the line of the contents for a section: a link to it, and to the page that it has alone, if any.
std::string content_item(const std::string& section, const std::filesystem::path& folder,
                         const std::string& name) {
  const std::size_t begin = section.find("<h2>") + 4, end = section.find("</h2>");
  const bool stands_alone = std::filesystem::exists(folder / (name + ".html"));
  return "<li><a href=\"#" + name + "\">" + section.substr(begin, end - begin) + "</a>" +
         (stands_alone ? ", <a href=\"" + name + ".html\">its own page</a>" : "") + "</li>\n";
}

}  // namespace

Section::Section(std::string name, const std::string& title, const std::string& command,
                 const scenes::Machine& machine)
    : name_(std::move(name)) {
  body_ = "<section id=\"" + name_ + "\">\n<h2>" + escape_html(title) + "</h2>\n<p class=\"made\"><code>" +
          escape_html(command) + "</code><br>" + escape_html(machine.cpu) + ", " + escape_html(machine.isa) +
          ", " + std::to_string(machine.threads) + (machine.threads == 1 ? " thread" : " threads") + "<br>" +
          escape_html(machine.compiler) + " <code>" + escape_html(machine.flags) +
          "</code><br>commit <code>" + escape_html(machine.commit) + "</code></p>\n";
}

void Section::add_heading(const std::string& text) {
  body_ += "<h3>" + escape_html(text) + "</h3>\n";
}

void Section::add_text(const std::string& text) {
  body_ += "<p>" + escape_html(text) + "</p>\n";
}

void Section::add_table(const Table& table) {
  body_ += table.to_html();
}

void Section::add_live() {
  body_ += std::string(live_mark) + "\n";
}

void Section::add_replay(const Replay& replay) {
  body_ += replay_data(replay);
  has_replay_ = true;
}

void Section::add_chart(const std::filesystem::path& folder, const std::string& file, const Chart& chart) {
  add_svg(folder, file, draw_svg(chart));
}

void Section::add_svg(const std::filesystem::path& folder, const std::string& file, const std::string& svg) {
  scenes::write_file(folder / (file + ".svg"), svg);
  body_ += "<figure>\n" + inline_svg(svg, file) + "</figure>\n";
}

std::string Section::text() const {
  return body_ + (has_replay_ ? replay_player() : "") + "</section>\n";
}

void Section::publish(const std::filesystem::path& folder) const {
  const std::filesystem::path sections = folder / "sections";
  make_folder(sections);
  scenes::write_file(sections / (name_ + ".html"), text());
  std::vector<std::filesystem::path> files;
  for (const auto& entry : std::filesystem::directory_iterator(sections)) {
    if (entry.path().extension() == ".html") files.push_back(entry.path());
  }
  // The thesis's experiment comes first, since the others answer questions that it raises.
  std::sort(files.begin(), files.end(), [](const auto& l, const auto& r) {
    return std::pair(l.stem() != "thesis", l.stem()) < std::pair(r.stem() != "thesis", r.stem());
  });
  std::string contents, all;
  for (const auto& file : files) {
    const std::string section = scenes::read_file(file), name = file.stem().string();
    contents += content_item(section, folder, name);
    all += with_live(section, folder, name);
  }
  scenes::write_file(folder / "index.html", page_head + ("<ul>\n" + contents + "</ul>\n") + all + page_end);
}

void Section::publish_alone(const std::filesystem::path& folder) const {
  make_folder(folder);
  scenes::write_file(folder / (name_ + ".html"), page_head + with_live(text(), folder, name_) + page_end);
}

void make_folder(const std::filesystem::path& folder) {
  std::error_code error;
  std::filesystem::create_directories(folder, error);
  if (error) throw InputError("cannot make the folder " + folder.string() + ": " + error.message());
}

}  // namespace plumb::tools
