#pragma once

#include <filesystem>
#include <string>

#include "plot/chart.hpp"
#include "plot/table.hpp"
#include "scenes/runs/machine.hpp"

namespace plumb::tools {

/// One part of the results page: headings, text, tables and charts in the order they are added. A folder of
/// results holds the sections of several commands, and index.html shows them all, with nothing to be loaded
/// from elsewhere.
class Section {
 public:
  /// `name` is the file's name and the link's target, `command` what the user typed.
  Section(std::string name, const std::string& title, const std::string& command,
          const scenes::Machine& machine);

  void add_heading(const std::string& text);
  void add_text(const std::string& text);
  void add_table(const Table& table);
  /// Also written as its own file, FOLDER/`file`.svg.
  void add_chart(const std::filesystem::path& folder, const std::string& file, const Chart& chart);
  /// The same for what is drawn already.
  void add_svg(const std::filesystem::path& folder, const std::string& file, const std::string& svg);

  /// Writes the section into `folder`/sections and index.html anew from all the sections there.
  void publish(const std::filesystem::path& folder) const;
  /// The section alone as a page of its own, `folder`/NAME.html.
  void publish_alone(const std::filesystem::path& folder) const;

 private:
  std::string name_;
  std::string body_;
};

/// Makes the folder if need be; throws InputError if it cannot be.
void make_folder(const std::filesystem::path& folder);

}  // namespace plumb::tools
