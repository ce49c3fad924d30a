#include "gaussian_ids.h"

#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/io/files/mapped_file.h"
#include "ngs/io/ply/gaussian_ply.h"

namespace ngs::cli {
namespace {

/// [N] number of the object, from 1; 0: none.
std::vector<std::uint32_t> ids_of_model(const std::string& path) {
  const io::GaussianPly ply = io::read_gaussian_ply(path, {io::HigherBands::kCheckOnly});
  std::vector<const LabelColumn*> labels;
  for (const io::NamedLabels& object : ply.objects) labels.push_back(&object.columns.label);
  if (labels.empty()) labels.push_back(&ply.labels.label);
  std::vector<std::uint32_t> ids(ply.cloud.size());
  std::vector<float> best(ids.size(), 0.5f);
  for (std::size_t k = 0; k < labels.size(); ++k) {
    if (labels[k]->size() != ids.size())
      throw Error(ErrorCode::kBadInput, path + ": no column ngs_label, expected the labelled PLY of ngs-joint");
    for (std::size_t i = 0; i < ids.size(); ++i)
      if (const float label = (*labels[k])[i]; label > best[i]) {
        best[i] = label;
        ids[i] = std::uint32_t(k + 1);
      }
  }
  return ids;
}

std::vector<std::uint32_t> bare_ids(const std::string& path, std::size_t gaussians) {
  const io::MappedFile file(path);
  const auto bytes = file.bytes();
  if (bytes.size() != gaussians && bytes.size() != 2 * gaussians)
    throw Error(ErrorCode::kInconsistent, path + ": " + std::to_string(bytes.size()) +
                                              " bytes, expected one or two for each of " + std::to_string(gaussians) +
                                              " Gaussians");
  std::vector<std::uint32_t> ids(gaussians);
  const std::size_t width = gaussians > 0 ? bytes.size() / gaussians : 1;
  for (std::size_t i = 0; i < bytes.size(); ++i) ids[i / width] |= std::uint32_t(bytes[i]) << (8 * (i % width));
  return ids;
}

}  // namespace

bool is_model(const std::string& path) { return std::filesystem::path(path).extension() == ".ply"; }

InstanceCounts count_gaussians(const std::string& predicted, const std::string& truth) {
  const std::vector<std::uint32_t> found = ids_of_model(predicted);
  const std::vector<std::uint32_t> right = is_model(truth) ? ids_of_model(truth) : bare_ids(truth, found.size());
  if (right.size() != found.size())
    throw Error(ErrorCode::kInconsistent, predicted + ": " + std::to_string(found.size()) +
                                              " Gaussians, expected those of " + truth + ", " +
                                              std::to_string(right.size()));
  InstanceCounts counts;
  counts.add(found, right);
  return counts;
}

}  // namespace ngs::cli
