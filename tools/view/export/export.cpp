#include "view/export/export.hpp"

#include <stdexcept>

#include "plumb/error.hpp"

namespace plumb::view {
namespace {

constexpr const char* worker_name = "plumb_view.js";

std::string base64(std::string_view bytes) {
  constexpr char digits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string out;
  out.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const std::size_t n = std::min<std::size_t>(3, bytes.size() - i);
    unsigned three = 0;
    for (std::size_t k = 0; k < 3; ++k)
      three = three << 8 | (k < n ? static_cast<unsigned char>(bytes[i + k]) : 0U);
    for (std::size_t k = 0; k < 4; ++k) out += k <= n ? digits[three >> (18 - 6 * k) & 63] : '=';
  }
  return out;
}

std::string replaced(std::string_view text, std::string_view what, std::string_view by) {
  std::string out;
  std::size_t from = 0;
  for (std::size_t at = text.find(what); at != text.npos; at = text.find(what, from)) {
    out.append(text, from, at - from).append(by);
    from = at + what.size();
  }
  return out.append(text, from);
}

std::string_view text_of(const std::vector<PageFile>& files, std::string_view name) {
  for (const PageFile& file : files)
    if (file.name == name) return file.text;
  throw std::logic_error("the page has no " + std::string(name));
}

/// Returns a module that imports others by plumb/NAME, instead of the way to them from its folder.
std::string imported_by_name(std::string_view name, std::string_view text) {
  const std::size_t slash = name.rfind('/');
  const std::string folder(name.substr(0, slash == name.npos ? 0 : slash + 1));
  const std::string beside = replaced(text, "from \"./", "from \"plumb/" + folder);
  return replaced(beside, "from \"../", "from \"plumb/");
}

/// Returns a map of modules. One that lies in a data: address has no neighbours, so that modules import each
/// other by name. What connects the page to worlds is another one here.
std::string modules(const std::vector<PageFile>& files) {
  std::string out;
  for (const PageFile& file : files) {
    if (!file.name.ends_with(".js") || file.name == "worker.js") continue;
    const std::string_view text = file.name == "socket.js" ? text_of(files, "worker.js") : file.text;
    out += (out.empty() ? "" : ",\n") + ("\"plumb/" + std::string(file.name)) +
           "\": \"data:text/javascript;base64," + base64(imported_by_name(file.name, text)) + "\"";
  }
  return "{\"imports\": {\n" + out + "\n}}";
}

std::string script(std::string_view attributes, std::string_view text) {
  return "<script " + std::string(attributes) + ">" + std::string(text) + "</script>\n";
}

void put(std::string& page, std::string_view place, const std::string& text) {
  const std::size_t at = page.find(place);
  if (at == page.npos) throw std::logic_error("the page has no " + std::string(place));
  page.replace(at, place.size(), text);
}

/// Takes out what asks a server for modules ahead of their turn.
void take_out_preloads(std::string& page) {
  constexpr std::string_view begin = "<link rel=\"modulepreload\"";
  for (std::size_t at = page.find(begin); at != page.npos; at = page.find(begin))
    page.erase(at, page.find('\n', at) - at + 1);
}

}  // namespace

std::filesystem::path find_worker(const std::filesystem::path& program) {
  const std::filesystem::path folder = program.parent_path();
  for (const auto& place : {folder / worker_name, folder / "../share/plumb" / worker_name,
                            folder / "../../build-wasm/bin" / worker_name})
    if (std::filesystem::exists(place)) return place.lexically_normal();
  throw InputError(
      "--export needs the worlds in WebAssembly, " + std::string(worker_name) + ", which is neither in " +
      folder.string() +
      ", nor in share/plumb, nor in build-wasm/bin. In plumb's source folder these commands make it: "
      "tools/setup --ports && cmake --preset wasm && cmake --build build-wasm --target plumb_view_wasm");
}

std::string exported_page(const std::vector<PageFile>& files, std::string_view worker,
                          std::string_view start) {
  std::string page(text_of(files, "index.html"));
  take_out_preloads(page);
  put(page, "<link rel=\"stylesheet\" href=\"style.css\">",
      "<style>\n" + std::string(text_of(files, "style.css")) + "</style>");
  // No text may end the element that it stands in.
  put(page, "<script type=\"module\" src=\"main.js\"></script>",
      script("type=\"importmap\"", modules(files)) +
          script("type=\"text/plain\" id=\"kernel\"", replaced(worker, "</script", "<\\/script")) +
          script("type=\"application/json\" id=\"start\"", replaced(start, "<", "\\u003c")) +
          script("type=\"module\"", "import \"plumb/main.js\";"));
  return page;
}

}  // namespace plumb::view
