// The output files of the tools satisfy data-schema/.
#include <doctest/doctest.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "ngs/io/files/safetensors.h"
#include "ngs/io/formats/compression/zip_archive.h"
#include "ngs/io/image/exr.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/io/ply/ply.h"
#include "support/process.h"
#include "support/python.h"
#include "support/schema_check.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tool_fixture.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::json;

Json schema(const std::string& name) {
  return Json::parse(std::ifstream(fs::path(NGS_SOURCE_DIR) / "data-schema" / name));
}

std::vector<std::string> fixture_files(const std::string& extension) {
  std::vector<std::string> paths;
  for (const fs::directory_entry& entry : fs::recursive_directory_iterator(test::fixture_folder()))
    if (entry.path().extension() == extension) paths.push_back(entry.path().string());
  std::sort(paths.begin(), paths.end());
  return paths;
}

/// The entry of a table that matches `name`; '*' matches anything, exact entries come first.
const Json* entry_of(const Json& table, const std::string& name) {
  for (const bool exact : {true, false})
    for (const Json& entry : table) {
      const std::string pattern = entry["name"];
      const std::string stem = pattern.substr(0, pattern.find('*'));
      const bool star = stem.size() != pattern.size();
      if (exact ? pattern == name : star && name.rfind(stem, 0) == 0) return &entry;
    }
  return nullptr;
}

/// Empty, or the first value outside [min, max] of `entry`.
template <class Value>
std::string outside(const Json& entry, std::int64_t n, const Value& value) {
  const Json &min = entry["range"][0], &max = entry["range"][1];
  for (std::int64_t i = 0; i < n; ++i)
    if ((!min.is_null() && !(value(i) >= min.get<double>())) || (!max.is_null() && !(value(i) <= max.get<double>())))
      return "row " + std::to_string(i) + ": " + std::to_string(value(i));
  return {};
}

}  // namespace

TEST_CASE("every PLY of the chain has only listed properties, with the listed types and ranges") {
  const Json table = schema("ply-properties.json");
  const std::vector<std::string> paths = fixture_files(".ply");
  REQUIRE_FALSE(paths.empty());
  for (const std::string& path : paths) {
    const io::PlyFile file = io::PlyFile::open(path);
    const io::PlyElement* vertex = file.find("vertex");
    REQUIRE(vertex != nullptr);
    const io::PlyTable rows = file.table(*vertex);
    const std::string header = test::read_bytes(path).substr(0, 1 << 16);
    const std::regex property("property ([a-z0-9]+) (\\S+)\n");
    int found = 0;
    for (std::sregex_iterator at(header.begin(), header.end(), property), end; at != end; ++at, ++found) {
      INFO(path << ": " << (*at)[2].str());
      const Json* entry = entry_of(table, (*at)[2]);
      REQUIRE(entry != nullptr);
      CHECK((*entry)["type"] == (*at)[1].str());
      const io::PlyColumn column = rows.column((*at)[2].str());
      CHECK(outside(*entry, rows.rows, [&](std::int64_t i) { return column.value(i); }) == "");
    }
    CHECK(found >= 3);
  }
}

TEST_CASE("every EXR of the chain has only listed channels, in the listed ranges") {
  const Json table = schema("exr-channels.json");
  for (const std::string& path : fixture_files(".exr")) {
    const io::ExrImage image = io::read_exr(path);
    for (const auto& channel : image.channels) {
      INFO(path << ": " << channel.first);
      const auto& name = channel.first;
      const auto& values = channel.second;
      const Json* entry = entry_of(table, name);
      REQUIRE(entry != nullptr);
      CHECK(outside(*entry, std::int64_t(values.size()),
                    [&](std::int64_t i) { return double(values[std::size_t(i)]); }) == "");
    }
  }
}

TEST_CASE("scene.json and metrics.json of the chain satisfy their schemas, and broken ones do not") {
  const auto file = [](const std::string& name) {
    return Json::parse(std::ifstream(test::fixture_folder() + "/" + name));
  };
  for (const char* scene : {"scene.json", "imported.json"}) {
    INFO(std::string(scene));
    CHECK(test::schema_violations(schema("scene.schema.json"), file(scene)) == "");
  }
  Json broken = file("scene.json");
  broken["views"][0]["width"] = 0;
  CHECK(test::schema_violations(schema("scene.schema.json"), broken) != "");
  for (const char* metrics : {"metrics.json", "photos.json"}) {
    INFO(std::string(metrics));
    CHECK(test::schema_violations(schema("metrics.schema.json"), file(metrics)) == "");
  }
  broken = file("metrics.json");
  broken["mean"]["iou"] = 1.5;
  CHECK(test::schema_violations(schema("metrics.schema.json"), broken) != "");
}

TEST_CASE("objects.json of ngs-group satisfies its schema, and a broken one does not") {
  const Json rules = schema("objects.schema.json");
  Json objects = Json::parse(std::ifstream(test::fixture_folder() + "/grouped/objects.json"));
  REQUIRE(objects.at("objects").size() == 1);
  CHECK(test::schema_violations(rules, objects) == "");
  objects["objects"][0].erase("id");
  CHECK(test::schema_violations(rules, objects) != "");
}

TEST_CASE("scenes, depth and scores of both halves satisfy their schemas, and a damaged truth is an error") {
  const test::TempDir dir;
  const auto run = [&](const std::vector<std::string>& argv, int exit_code) {
    const test::ProcessResult result = test::run_tool(argv);
    INFO(result.err);
    CHECK(result.exit_code == exit_code);
    return result.err;
  };
  const auto file = [&](const std::string& name) { return Json::parse(std::ifstream(dir.file(name))); };
  const std::string truth = dir.file("scene/halves"), depth = truth + "/background/depth/near-05.exr";
  run({"ngs-synth", "tiny", "--truth", "halves", "--width-px", "32", "--height-px", "24", "--fit-steps", "8", "-o",
       dir.file("scene")},
      0);
  for (const char* half : {"background", "object"})
    CHECK(test::schema_violations(schema("scene.schema.json"),
                                  file("scene/halves/" + std::string(half) + "/scene.json")) == "");
  const io::ExrImage exr = io::read_exr(depth);
  REQUIRE(exr.channels.size() == 1);
  CHECK(entry_of(schema("exr-channels.json"), exr.channels.begin()->first) != nullptr);

  fs::create_directory(dir.file("cut"));
  for (const char* half : {"object.ply", "background.ply"})
    fs::copy_file(dir.file("scene/point_cloud.ply"), dir.file("cut/" + std::string(half)));
  const std::vector<std::string> eval = {
      "ngs-eval", dir.file("cut"),   truth, "--halves", "--model", dir.file("scene/point_cloud.ply"), "-w",
      "-o",       dir.file("m.json")};
  run(eval, 0);
  Json scores = file("m.json");
  CHECK(test::schema_violations(schema("metrics.schema.json"), scores) == "");
  CHECK(scores["background"]["outside_change"]["most"] == 0);  // nothing was cut
  CHECK(scores["object"]["seen"]["views"].get<int>() + scores["object"]["unseen"]["views"].get<int>() == 64);
  CHECK(scores["object"]["seen"]["views"] > 10);
  CHECK(scores["object"]["unseen"]["views"] > 10);
  scores["object"]["seen"]["iou"] = 2;
  CHECK(test::schema_violations(schema("metrics.schema.json"), scores) != "");

  fs::remove(depth);
  CHECK(run(eval, 3).find("near-05.exr") != std::string::npos);
}

TEST_CASE("scores of all objects of id maps satisfy their schema") {
  const test::TempDir dir;
  const auto run = [&](const std::vector<std::string>& argv) { REQUIRE(test::run_tool(argv).exit_code == 0); };
  run({"ngs-synth", "tiny", "--no-fit", "--mask-noise", "jitter:1,blob:1", "-o", dir.file("scene")});
  run({"ngs-eval", dir.file("scene/labels"), dir.file("scene/labels_gt"), "--instances", "-o", dir.file("i.json")});
  Json file = Json::parse(std::ifstream(dir.file("i.json")));
  CHECK(test::schema_violations(schema("metrics.schema.json"), file) == "");
  CHECK(file.at("counts").at("matched") == 2);
  file["counts"].erase("split");
  CHECK(test::schema_violations(schema("metrics.schema.json"), file) != "");
}

TEST_CASE("the JSON files of ngs-synth satisfy the schemas, and broken files do not") {
  const test::TempDir dir;
  const std::string scene = dir.file("scene");
  REQUIRE(test::run_tool({"ngs-synth", "tiny", "--no-fit", "--mask-noise", "jitter:1", "-o", scene}).exit_code == 0);
  for (const char* name : {"recipe", "ground-truth"}) {
    INFO(std::string(name));
    const std::string written = std::string(name) == "recipe" ? "recipe.json" : "ground_truth.json";
    Json file = Json::parse(std::ifstream(dir.file("scene/" + written)));
    const Json rules = schema(std::string(name) + ".schema.json");
    CHECK(test::schema_violations(rules, file) == "");
    for (const auto& [key, value] : rules["properties"].items())
      if (key != "cast_shadows" && key != "objects") CHECK(file.contains(key));  // only where they are used
    file["unknown"] = 1;
    CHECK(test::schema_violations(rules, file) != "");
  }
}

// The output of ngs-extract --npz, read by our own reader and by numpy with the code of the FAQ.

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
