#include "ngs/io/scene/evidence_file.h"

#include <cstring>
#include <nlohmann/json.hpp>
#include <set>

#include "ngs/core/error.h"
#include "ngs/io/files/safetensors.h"

namespace ngs::io {
namespace {

/// Visits every array of the evidence but the contrasts with its name and shape; E is Evidence or const Evidence.
template <class E, class F>
void for_each_array(E& e, F&& f) {
  const std::vector<std::int64_t> rows{e.gaussians}, cells{e.gaussians, e.objects};
  const auto sums = [&](const std::string& name, auto& s, const std::vector<std::int64_t>& shape) {
    f(name + ".whole", s.whole, shape);
    f(name + ".fraction", s.fraction, shape);
  };
  sums("weight", e.weight, rows);
  sums("object_weight", e.object_weight, cells);
  f(std::string("pixels"), e.pixels, rows);
  f(std::string("object_pixels"), e.object_pixels, cells);
  f(std::string("views"), e.views, rows);
  f(std::string("signal_sum"), e.signal_sum, cells);
  sums("signal_square_sum", e.signal_square_sum, cells);
}

// The file has the sums of the contrasts, [N, K], memory what they lack.
constexpr const char* kContrast = "contrast_sum";

void add_contrasts(const Evidence& e, TensorFile& file) {
  file.add(kContrast, {e.gaussians, e.objects}, e.contrast_lack);
  std::uint8_t* at = file.tensors.back().bytes.data();
  for (std::size_t i = 0; i < std::size_t(e.gaussians); ++i)
    for (std::size_t k = 0; k < std::size_t(e.objects); ++k) {
      const std::uint64_t sum = e.contrast_sum(i, k);
      std::memcpy(at, &sum, sizeof sum);
      at += sizeof sum;
    }
}

/// Its inverse: lack = views - sum, as sum = views - lack.
void set_contrasts(std::vector<std::uint64_t> sum, Evidence& e) {
  e.contrast_lack = std::move(sum);
  for (std::size_t i = 0; i < std::size_t(e.gaussians); ++i)
    for (std::size_t k = 0; k < std::size_t(e.objects); ++k)
      e.contrast_lack[i * std::size_t(e.objects) + k] = e.contrast_sum(i, k);
}

std::vector<std::string> names_in(const TensorFile& file, const std::string& key) {
  const nlohmann::json json = nlohmann::json::parse(file.meta(key), nullptr, false);
  std::vector<std::string> names;
  bool good = json.is_array();
  for (std::size_t i = 0; good && i < json.size(); ++i)
    if ((good = json[i].is_string())) names.push_back(json[i].get<std::string>());
  if (!good)
    throw Error(ErrorCode::kBadInput, file.name + ": metadata '" + key + "' is no list of names",
                "write it again with ngs-variance --partial");
  return names;
}

}  // namespace

void write_evidence(const std::string& path, const EvidencePart& part, StoredPaths stored) {
  TensorFile file;
  for_each_array(part.evidence, [&](const std::string& name, const auto& values,
                                    const std::vector<std::int64_t>& shape) { file.add(name, shape, values); });
  add_contrasts(part.evidence, file);
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
    part.made_with = file.meta("made_with");  // parts of version 0.1 before it have none
  part.objects = names_in(file, "objects");
  part.views = names_in(file, "views");
  part.evidence.gaussians = std::int64_t(file.get<std::uint32_t>("views", {-1}).size());
  part.evidence.objects = int(part.objects.size());
  for_each_array(part.evidence,
                 [&]<class T>(const std::string& name, std::vector<T>& values, const std::vector<std::int64_t>& shape) {
                   values = file.get<T>(name, shape);
                 });
  set_contrasts(file.get<std::uint64_t>(kContrast, {part.evidence.gaussians, part.evidence.objects}), part.evidence);
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
