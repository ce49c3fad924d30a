#include "ngs/io/scene/evidence_file.h"

#include <nlohmann/json.hpp>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/files/safetensors.h"

namespace ngs::io {
namespace {

using SumField = std::uint64_t& (*)(ObjectSums&);

/// Visits every array of the file except the contrasts: rows(name, array) for arrays per Gaussian [N], cells(name,
/// field) for arrays per Gaussian and object [N, K]. E is Evidence or const Evidence.
template <class E, class Rows, class Cells>
void for_each_array(E& e, const Rows& rows, const Cells& cells) {
  const auto field = [&](const char* name, SumField of) { cells(name, of); };
  rows("weight.whole", e.weight.whole);
  rows("weight.fraction", e.weight.fraction);
  field("object_weight.whole", [](ObjectSums& s) -> std::uint64_t& { return s.weight.whole; });
  field("object_weight.fraction", [](ObjectSums& s) -> std::uint64_t& { return s.weight.fraction; });
  rows("pixels", e.pixels);
  field("object_pixels", [](ObjectSums& s) -> std::uint64_t& { return s.pixels; });
  rows("views", e.views);
  field("signal_sum", [](ObjectSums& s) -> std::uint64_t& { return s.signal_sum; });
  field("signal_square_sum.whole", [](ObjectSums& s) -> std::uint64_t& { return s.signal_square_sum.whole; });
  field("signal_square_sum.fraction", [](ObjectSums& s) -> std::uint64_t& { return s.signal_square_sum.fraction; });
}
constexpr const char* kContrast = "contrast_sum";  // Evidence stores one_minus_contrast_sum instead

std::vector<std::uint64_t> dense(const Evidence& e, SumField field) {
  const auto objects = std::size_t(e.objects);
  std::vector<std::uint64_t> cells(std::size_t(e.gaussians) * objects);
  for (std::size_t i = 0; i < std::size_t(e.gaussians); ++i)
    e.object_weights.for_each_in(i, [&](std::size_t k, ObjectSums of) { cells[i * objects + k] = field(of); });
  return cells;
}

std::vector<std::uint64_t> contrasts(const Evidence& e) {
  const auto objects = std::size_t(e.objects);
  std::vector<std::uint64_t> cells(std::size_t(e.gaussians) * objects);
  for (std::size_t i = 0; i < std::size_t(e.gaussians); ++i)
    for (std::size_t k = 0; k < objects; ++k) cells[i * objects + k] = e.contrast_sum(i, k);
  return cells;
}

void set_shares(const std::vector<std::uint64_t>& cells, SumField field, Evidence& e) {
  const auto objects = std::size_t(e.objects);
  for (std::size_t i = 0; i < std::size_t(e.gaussians); ++i)
    for (std::size_t k = 0; k < objects; ++k)
      if (cells[i * objects + k] != 0) field(e.object_weights.touch(i, k)) = cells[i * objects + k];
}

/// The inverse of contrasts(): one_minus_contrast_sum = views - contrast_sum.
void set_contrasts(std::vector<std::uint64_t> sum, Evidence& e) {
  for (std::size_t cell = 0; cell < sum.size(); ++cell)
    sum[cell] = (std::uint64_t(e.views[cell / std::size_t(e.objects)]) << 32) - sum[cell];
  set_shares(
      sum, [](ObjectSums& s) -> std::uint64_t& { return s.one_minus_contrast_sum; }, e);
}

std::vector<std::string> names_in(const TensorFile& file, const std::string& key) {
  const nlohmann::json json = nlohmann::json::parse(file.meta(key), nullptr, false);
  std::vector<std::string> names;
  bool good = json.is_array();
  for (std::size_t i = 0; good && i < json.size(); ++i)
    if ((good = json[i].is_string())) names.push_back(json[i].get<std::string>());
  if (!good)
    throw Error(ErrorCode::kBadInput, file.name + ": metadata '" + key + "' is not a list of names",
                "write it again with ngs-variance --partial");
  return names;
}

}  // namespace

void write_evidence(const std::string& path, const EvidencePart& part, StoredPaths stored) {
  TensorFile file;
  const Evidence& e = part.evidence;
  for_each_array(
      e, [&](const char* name, const auto& values) { file.add(name, {e.gaussians}, values); },
      [&](const char* name, SumField field) {
        file.add(name, {e.gaussians, e.objects}, dense(e, field));
      });
  file.add(kContrast, {e.gaussians, e.objects}, contrasts(e));
  file.metadata["ngs:schema"] = "ngs.evidence.1";
  file.metadata["model"] = part.model_hash;
  file.metadata["scene"] = path_to_folder(stored_folder(path, stored), part.scene_path);
  file.metadata["made_with"] = part.made_with;
  file.metadata["objects"] = nlohmann::json(part.objects).dump();
  file.metadata["views"] = nlohmann::json(part.views).dump();
  write_safetensors(path, file);
}

EvidencePart parse_evidence(const std::string& path, Bytes bytes) {
  const TensorFile file = parse_safetensors(path, bytes);
  EvidencePart part;
  part.model_hash = file.meta("model");
  part.scene_path = path_from_folder(folder_of_file(path), file.meta("scene"));
  if (file.metadata.contains("made_with"))
    part.made_with = file.meta("made_with");  // absent in parts written before this key existed
  part.objects = names_in(file, "objects");
  part.views = names_in(file, "views");
  Evidence& e = part.evidence;
  const auto gaussians = std::int64_t(file.get<std::uint32_t>("views", {-1}).size());
  const int objects = int(part.objects.size());
  const std::vector<std::int64_t> rows{gaussians}, cells{gaussians, objects};
  e = Evidence(gaussians, objects);
  for_each_array(
      e, [&]<class T>(const char* name, std::vector<T>& values) { values = file.get<T>(name, rows); },
      [&](const char* name, SumField field) { set_shares(file.get<std::uint64_t>(name, cells), field, e); });
  set_contrasts(file.get<std::uint64_t>(kContrast, cells), e);
  return part;
}

EvidencePart read_evidence(const std::string& path) {
  const MappedFile file(path);
  return parse_evidence(path, file.bytes());
}

EvidencePart merge_evidence(const std::vector<std::string>& paths) {
  EvidencePart sum;
  std::set<std::string> seen;
  for (std::size_t i = 0; i < paths.size(); ++i) {
    const std::string& path = paths[i];
    EvidencePart part = read_evidence(path);
    for (const std::string& view : part.views)
      if (!seen.insert(view).second)
        throw Error(ErrorCode::kInconsistent, path + ": view '" + view + "' is already in another part",
                    "pass every part once");
    if (i == 0) {
      sum = std::move(part);
      continue;
    }
    if (part.model_hash != sum.model_hash || part.objects != sum.objects ||
        part.evidence.gaussians != sum.evidence.gaussians)
      throw Error(ErrorCode::kInconsistent, path + ": evidence of another model or other objects than " + paths.front(),
                  "merge parts that were made from one scene.json");
    if (part.made_with != sum.made_with)
      throw Error(ErrorCode::kInconsistent,
                  path + ": made with " + part.made_with + ", but " + paths.front() + " with " + sum.made_with,
                  "make all parts from one scene.json and with the same options");
    sum.evidence.add(part.evidence);
    sum.views.insert(sum.views.end(), part.views.begin(), part.views.end());
  }
  return sum;
}

}  // namespace ngs::io
