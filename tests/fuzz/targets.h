#pragma once
// One function per reader of bytes from strangers, in the form libFuzzer calls. A reader may refuse with
// kBadInput or kInconsistent; anything else (a crash, a sanitizer report, another exception) is a finding.
//
// To add a reader: a function here, its line in kTargets, and <name>_fuzz.cpp of three lines. Every finding goes
// to corpus/<name>/ and is replayed by replay_test.cpp from then on.
#include <cstddef>
#include <cstdint>

#include "ngs/core/error.h"
#include "ngs/io/gaussian_ply.h"
#include "ngs/io/query_ply.h"
#include "ngs/io/safetensors.h"

namespace ngs::fuzz {

template <class Read>
int refuses_or_reads(const Read& read) {
  try {
    read();
  } catch (const Error& e) {
    if (e.code() != ErrorCode::kBadInput && e.code() != ErrorCode::kInconsistent) throw;
  }
  return 0;
}

inline int fuzz_ply(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] {
    const io::PlyFile file = io::PlyFile::parse("fuzz.ply", {data, size});
    for (const io::PlyElement& element : file.elements()) {
      const io::PlyTable table = file.table(element);
      for (const io::PlyProperty& p : table.properties)
        if (table.rows > 0) (void)table.column(p.name).value(table.rows - 1);
    }
  });
}

inline int fuzz_gaussian_ply(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_gaussian_ply("fuzz.ply", {data, size}); });
}

inline int fuzz_query_ply(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_query_ply("fuzz.ply", {data, size}); });
}

inline int fuzz_safetensors(const std::uint8_t* data, std::size_t size) {
  return refuses_or_reads([&] { (void)io::parse_safetensors("fuzz.safetensors", {data, size}); });
}

struct Target {
  const char* name;  // of its corpus folder
  int (*run)(const std::uint8_t*, std::size_t);
};
inline constexpr Target kTargets[] = {
    {"ply", fuzz_ply},
    {"gaussian_ply", fuzz_gaussian_ply},
    {"query_ply", fuzz_query_ply},
    {"safetensors", fuzz_safetensors},
};

}  // namespace ngs::fuzz
