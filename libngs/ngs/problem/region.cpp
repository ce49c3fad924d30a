#include "ngs/problem/region.h"

#include <bit>
#include <cstdint>
#include <cstring>

#include "ngs/core/check.h"
#include "ngs/scene/mask_threshold.h"

namespace ngs {
namespace {

void mark(const std::vector<LabelColumns>& labels, std::vector<std::uint8_t>& region) {
  for (const LabelColumns& object : labels)
    for (std::size_t i = 0; i < region.size(); ++i) region[i] |= in_region(object, i);
}

bool same_value(float a, float b) { return std::bit_cast<std::uint32_t>(a) == std::bit_cast<std::uint32_t>(b); }

/// True: the rows of one column have the same bits.
bool same_row(const std::vector<float>& a, std::size_t i, const std::vector<float>& b, std::size_t j,
              std::size_t width) {
  return width == 0 || std::memcmp(&a[i * width], &b[j * width], width * sizeof(float)) == 0;
}

bool same_row(const GaussianCloud& a, std::size_t i, const GaussianCloud& b, std::size_t j) {
  return same_row(a.position, i, b.position, j, 3) && same_row(a.rotation, i, b.rotation, j, 4) &&
         same_row(a.log_scale, i, b.log_scale, j, 3) && same_row(a.logit_opacity, i, b.logit_opacity, j, 1) &&
         same_row(a.sh_dc, i, b.sh_dc, j, 3) && same_row(a.sh_rest, i, b.sh_rest, j, std::size_t(a.rest_count()) * 3);
}

}  // namespace

bool in_region(const LabelColumns& object, std::size_t row) {
  return object.prob[row] >= kMinRegionShare || label_is_foreground(object.label[row]) || is_set(object.boundary[row]);
}

std::vector<std::uint8_t> region_of(const std::vector<LabelColumns>& labels) {
  std::vector<std::uint8_t> region(labels.empty() ? 0 : labels.front().prob.size(), 0);
  mark(labels, region);
  return region;
}

std::vector<std::uint8_t> rows_with_foreground_evidence(const std::vector<LabelColumns>& labels) {
  std::vector<std::uint8_t> has_evidence(labels.empty() ? 0 : labels.front().prob.size(), 0);
  for (const LabelColumns& object : labels)
    for (std::size_t i = 0; i < has_evidence.size(); ++i) has_evidence[i] |= object.prob[i] > 0;
  return has_evidence;
}

void restore_outside_regions(const std::vector<LabelColumns>& given, std::vector<LabelColumns>& labels) {
  NGS_CHECK(given.size() == labels.size(), "labels of the same objects");
  std::vector<std::uint8_t> region = region_of(given);
  mark(labels, region);
  for (std::size_t k = 0; k < labels.size(); ++k)
    for (const auto column : kLabelColumns)
      for (std::size_t i = 0; i < region.size(); ++i)
        if (!region[i]) (labels[k].*column)[i] = (given[k].*column)[i];
}

std::int64_t rows_changed(const GaussianCloud& cloud, const std::vector<LabelColumns>& labels,
                          const Solution& solution) {
  std::int64_t changed = 0;
  const bool same_model = solution.cloud.get() == &cloud && solution.source_row.empty();
  for (std::size_t row = 0; row < std::size_t(solution.cloud->size()); ++row) {
    const std::size_t source = solution.source_row.empty() ? row : std::size_t(solution.source_row[row]);
    bool same = same_model || same_row(*solution.cloud, row, cloud, source);
    for (std::size_t k = 0; same && k < labels.size(); ++k)
      for (const auto column : kLabelColumns)
        same &= same_value((solution.labels[k].*column)[row], (labels[k].*column)[source]);
    changed += !same;
  }
  return changed;
}

}  // namespace ngs
