// Runs rows of the golden table and says which bits are not those of the table. It needs no test library, so
// that it is built for processors for which there is none.
//
//   portable_hashes TABLE [--every N] [--isa NAME] [--threads N] [--row NAME] [--but NAME]

#include <charconv>
#include <cstdio>
#include <cstring>
#include <exception>
#include <optional>
#include <string>
#include <string_view>

#include "golden/run.hpp"
#include "golden/table.hpp"
#include "plumb/error.hpp"
#include "threads/sharing.hpp"

namespace plumb::golden {
namespace {

struct Options {
  const char* table = nullptr;
  std::uint32_t every = 1;   ///< Of so many rows, the first is run.
  std::optional<Isa> isa{};  ///< None: all that this processor runs.
  unsigned threads = 1;
  std::string row{};  ///< Empty: all.
  std::string but{};  ///< A row that is left out.
};

std::uint32_t parse_count(std::string_view text) {
  std::uint32_t value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || end != text.data() + text.size() || value == 0)
    throw InputError("'" + std::string(text) + "' is no number from 1 up");
  return value;
}

Isa parse_isa(std::string_view text) {
  for (const Isa isa : all_isas())
    if (to_string(isa) == text && is_supported(isa)) return isa;
  throw InputError("this processor or build has no instruction set " + std::string(text));
}

Options parse_options(int count, char** words) {
  Options out;
  for (int i = 1; i < count; ++i) {
    const std::string_view word = words[i];
    const bool is_option = word.starts_with("--");
    if (is_option && i + 1 == count) throw InputError(std::string(word) + " needs a value");
    if (!is_option)
      out.table = words[i];
    else if (word == "--every")
      out.every = parse_count(words[++i]);
    else if (word == "--threads")
      out.threads = parse_count(words[++i]);
    else if (word == "--isa")
      out.isa = parse_isa(words[++i]);
    else if (word == "--row")
      out.row = words[++i];
    else if (word == "--but")
      out.but = words[++i];
    else
      throw InputError("unknown option " + std::string(word));
  }
  if (out.table == nullptr) throw InputError("no table is named");
  return out;
}

/// Counts what was run and what had other bits.
struct Tally {
  std::uint32_t runs = 0, others = 0;
};

void run(const Row& row, const Options& options, Executor* executor, Tally& tally) {
  for (const Isa isa : all_isas()) {
    if (!is_supported(isa) || (options.isa && *options.isa != isa)) continue;
    const std::string_view name = to_string(isa);
    Row fresh = row;
    fresh.wanted = run_row(row, {.isa = isa, .threads = options.threads, .executor = executor}).hashes;
    ++tally.runs;
    if (fresh.wanted == row.wanted) continue;
    ++tally.others;
    std::printf("other bits on %.*s: %s\n", static_cast<int>(name.size()), name.data(),
                format_row(fresh).c_str());
    std::fflush(stdout);
  }
}

int run_table(const Options& options) {
  std::unique_ptr<Executor> pool;
  std::optional<detail::EagerExecutor> eager;
  if (options.threads > 1) {
    pool = make_default_executor(options.threads);
    // Threads share even the small scenes of the table.
    eager.emplace(*pool, detail::SharingThresholds{.projections = 1, .rods = 512});
  }
  Tally tally;
  std::uint32_t number = 0;
  for (const Row& row : read_table(options.table)) {
    if (number++ % options.every != 0 || (!options.row.empty() && row.name != options.row)) continue;
    if (row.name == options.but) {
      std::printf("%s is left out\n", row.name.c_str());
      continue;
    }
    run(row, options, eager ? &*eager : nullptr, tally);
  }
  std::printf("%u runs, %u with other bits than the table\n", tally.runs, tally.others);
  return tally.runs > 0 && tally.others == 0 ? 0 : 1;
}

}  // namespace
}  // namespace plumb::golden

int main(int count, char** words) {
  try {
    return plumb::golden::run_table(plumb::golden::parse_options(count, words));
  } catch (const std::exception& error) {
    std::fprintf(stderr, "portable_hashes: %s\n", error.what());
    return 2;
  }
}
