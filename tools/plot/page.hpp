#pragma once

#include <filesystem>
#include <string>

#include "plot/chart.hpp"
#include "plot/replay.hpp"
#include "plot/table.hpp"
#include "scenes/runs/machine.hpp"

namespace plumb::tools {

/// A section is one part of the results page. It shows headings, text, tables, charts and replays in the
/// order in which they are added. A folder of results holds the sections of several commands. Its index.html
/// lists and shows them all, and loads nothing from elsewhere.
class Section {
 public:
  /// `name` becomes the file's name and the link's target. `command` is what the user typed.
  Section(std::string name, const std::string& title, const std::string& command,
          const scenes::Machine& machine);

  void add_heading(const std::string& text);
  void add_text(const std::string& text);
  void add_table(const Table& table);
  /// Adds a link to a live page, `folder`/live/NAME/index.html, or how to get it if that is not there when
  /// the section is published.
  void add_live();
  /// Adds a replay, which is seen where the browser runs scripts; stills belong beside it.
  void add_replay(const Replay& replay);
  /// Adds a chart, and writes it as a file of its own, FOLDER/`file`.svg, too.
  void add_chart(const std::filesystem::path& folder, const std::string& file, const Chart& chart);
  /// Does the same with a picture that is drawn already.
  void add_svg(const std::filesystem::path& folder, const std::string& file, const std::string& svg);

  /// Writes the section into `folder`/sections, and index.html anew from all the sections there.
  void publish(const std::filesystem::path& folder) const;
  /// Writes the section alone as a page of its own, `folder`/NAME.html. The contents of an index.html that is
  /// written after it link that page, too.
  void publish_alone(const std::filesystem::path& folder) const;

 private:
  std::string text() const;

  std::string name_;
  std::string body_;
  bool has_replay_ = false;
};

/// Makes the folder if it is not there. Throws InputError if it cannot be made.
void make_folder(const std::filesystem::path& folder);

}  // namespace plumb::tools
