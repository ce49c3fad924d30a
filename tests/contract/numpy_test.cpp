// The output of ngs-extract --npz, read by our own reader and by numpy with the code of the FAQ.
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <nlohmann/json.hpp>

#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "support/process.h"
#include "support/python.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

constexpr std::size_t kMaxBytes = 1 << 20;

/// The data after the header of an .npy file; the header must contain `descr` and `count`.
template <class T>
std::vector<T> values_of(const io::ZipReader& archive, const std::string& name, const std::string& descr,
                         std::size_t count) {
  const std::vector<std::uint8_t> file = archive.read(name, kMaxBytes);
  REQUIRE(file.size() > 10);
  const std::size_t header = 10u + file[8] + 256u * file[9];
  CHECK(header % 64 == 0);
  const std::string text(file.begin() + 10, file.begin() + std::ptrdiff_t(header));
  CAPTURE(text);
  CHECK(text.starts_with("{'descr': '" + descr + "', 'fortran_order': False, 'shape': (" + std::to_string(count) +
                         ",), }"));
  REQUIRE(file.size() == header + count * sizeof(T));
  std::vector<T> values(count);
  std::memcpy(values.data(), file.data() + header, count * sizeof(T));
  return values;
}

void extract(const nlohmann::json& arguments) { test::succeeded(test::run_process(test::command(arguments))); }

/// The first block of Python after <!-- numpy --> in the FAQ.
std::string documented_python() {
  const std::string page = test::read_bytes(NGS_SOURCE_DIR "/docs/faq.md");
  const std::string opening = "<!-- numpy -->\n```python\n";
  const std::size_t start = page.find(opening);
  REQUIRE(start != std::string::npos);
  const std::size_t from = start + opening.size();
  return page.substr(from, page.find("```\n", from) - from);
}

}  // namespace

TEST_CASE("ngs-extract --npz contains the labels before rounding, and the rows that --object-ply writes") {
  const test::TempDir tmp;
  const std::string& fixture = test::fixture_folder();
  const std::string npz = tmp.path() + "/labels.npz", object = tmp.path() + "/object.ply";
  extract({"ngs-extract", fixture + "/labelled.ply", "--npz", npz, "--object-ply", object});

  const io::GaussianPly model = io::read_gaussian_ply(fixture + "/labelled.ply");
  const io::GaussianPly kept = io::read_gaussian_ply(object);
  const std::size_t n = std::size_t(model.cloud.size()), m = std::size_t(kept.cloud.size());
  REQUIRE(m > 0);
  REQUIRE(m < n);
  const std::string bytes = test::read_bytes(npz);
  const io::ZipReader archive(npz, {reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size()});

  CHECK(values_of<float>(archive, "labels.npy", "<f4", n) == model.labels.label);
  const auto seen = values_of<std::uint8_t>(archive, "seen.npy", "|b1", n);
  for (std::size_t i = 0; i < n; ++i) CHECK(seen[i] == (model.labels.views[i] > 0 ? 1 : 0));
  const auto rows = values_of<std::int64_t>(archive, "object.npy", "<i8", m);
  for (std::size_t k = 0; k < m; ++k)
    for (std::size_t axis = 0; axis < 3; ++axis)
      CHECK(kept.cloud.position[3 * k + axis] == model.cloud.position[3 * std::size_t(rows[k]) + axis]);
}

TEST_CASE("numpy reads the output of ngs-extract --npz with the code of the FAQ") {
  const std::string program = test::python_with("numpy");
  if (program.empty()) return test::skip("python3 with numpy is absent");
  const test::TempDir tmp;
  const std::string labelled = test::fixture_folder() + "/labelled.ply";
  extract({"ngs-extract", labelled, "--npz", tmp.path() + "/labels.npz", "--object-ply", tmp.path() + "/object.ply"});
  std::filesystem::copy_file(labelled, tmp.path() + "/labelled.ply");

  const std::string asserts =
      "\nassert z['seen'].dtype == bool and z['object'].dtype == np.int64 and labels.dtype == np.float32"
      "\nassert (splat['ngs_label'] == labels).all() and (np.diff(rows) > 0).all()\n";
  const test::ProcessResult result = test::succeeded(
      test::run_process({.argv = {program, "-c", documented_python() + asserts}, .folder = tmp.path()}));
  const auto rows = [](const std::string& ply) { return std::to_string(io::read_gaussian_ply(ply).cloud.size()); };
  CAPTURE(result.out);
  CHECK(
      result.out.starts_with(rows(tmp.path() + "/object.ply") + " of " + rows(labelled) + " Gaussians are the object"));
}

}  // namespace ngs
