// Replays the corpus of every reader, and a fixed set of mutations of each file: bits, bytes, lengths and splices, as a
// fuzzer would try first, on every run and without a fuzzer.
#include <doctest/doctest.h>

#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include "fuzz/targets.h"
#include "ngs/core/rng.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

constexpr int kMutationsPerReader = 2400, kMinPerFile = 40;

std::vector<std::string> corpus_of(const std::string& reader) {
  std::vector<std::string> paths;
  for (const auto& entry : std::filesystem::directory_iterator(NGS_SOURCE_DIR "/tests/fuzz/corpus/" + reader))
    if (entry.is_regular_file()) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

struct Dice {
  std::uint64_t seed, next = 0;
  std::size_t below(std::size_t n) { return std::size_t(rng_bits(seed, RngStream::kTest, next++) % n); }
};

std::string mutated(std::string bytes, Dice dice) {
  constexpr char kInteresting[] = {0, 1, 127, char(128), char(255), '\n', ' ', '-', '9'};
  for (std::size_t edits = 1 + dice.below(4); edits > 0 && !bytes.empty(); --edits) {
    const std::size_t at = dice.below(bytes.size());
    switch (dice.below(5)) {
      case 0: bytes[at] = char(bytes[at] ^ (1 << dice.below(8))); break;
      case 1: bytes[at] = kInteresting[dice.below(sizeof kInteresting)]; break;
      case 2: bytes.erase(at, 1 + dice.below(16)); break;
      case 3: bytes.insert(at, bytes.substr(dice.below(bytes.size()), 1 + dice.below(16))); break;
      default: bytes.insert(at, 1 + dice.below(3), '9'); break;  // longer numbers in headers
    }
  }
  return bytes;
}

TEST_CASE("every reader handles its corpus and mutations of it without crash or unexpected exception") {
  for (const fuzz::Target& target : fuzz::kTargets) {
    const std::vector<std::string> paths = corpus_of(std::string(target.name));
    CAPTURE(target.name);
    REQUIRE_FALSE(paths.empty());
    const int mutations = std::max(kMinPerFile, kMutationsPerReader / int(paths.size()));
    for (const std::string& path : paths) {
      CAPTURE(path);
      const std::string bytes = test::read_bytes(path);
      for (int m = -1; m < mutations; ++m) {
        CAPTURE(m);
        const std::string input = m < 0 ? bytes : mutated(bytes, {std::uint64_t(m)});
        const std::vector<std::uint8_t> exact(input.begin(), input.end());  // no spare byte behind the end
        CHECK_NOTHROW(fuzz::run(target, exact));
      }
    }
  }
}

}  // namespace
}  // namespace ngs
