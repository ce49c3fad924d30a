#include "ngs/stages/live/object_evidence.h"

#include <algorithm>

#include "ngs/backend/for_each.h"
#include "ngs/stages/boundary/variance_stage.h"

namespace ngs::live {

ObjectEvidence::ObjectEvidence(std::int64_t gaussians) {
  weight_.resize(std::size_t(gaussians)), inside_.resize(std::size_t(gaussians));
}

void ObjectEvidence::add(const MarkedView& view) {
  for (std::size_t v = 0; v < view.seen->row.size(); ++v) weight_.add(view.seen->row[v], view.seen->weight[v]);
  for (std::size_t v = 0; v < view.inside.row.size(); ++v) inside_.add(view.inside.row[v], view.inside.weight[v]);
}

void ObjectEvidence::remove(const MarkedView& view) {
  for (std::size_t v = 0; v < view.seen->row.size(); ++v) weight_.subtract(view.seen->row[v], view.seen->weight[v]);
  for (std::size_t v = 0; v < view.inside.row.size(); ++v) inside_.subtract(view.inside.row[v], view.inside.weight[v]);
}

double ObjectEvidence::share(std::size_t gaussian) const {
  return is_seen(gaussian) ? inside_.value(gaussian) / weight_.value(gaussian) : 0.0;
}

ObjectLabels labels_of(const Exec& exec, const ObjectEvidence& evidence) {
  const VarianceOptions rule;
  constexpr std::int64_t kChunk = 1 << 14;
  const auto n = std::int64_t(evidence.gaussians());
  ObjectLabels out{std::vector<float>(std::size_t(n)), std::vector<std::uint8_t>(std::size_t(n)), 0};
  std::vector<std::int64_t> count(std::size_t((n + kChunk - 1) / kChunk));
  for_each_task(exec, std::ssize(count), [&](std::int64_t chunk) {
    for (std::int64_t i = chunk * kChunk; i < std::min(n, (chunk + 1) * kChunk); ++i) {
      const auto row = std::size_t(i);
      const double share = evidence.share(row);
      const bool object = double(float(share)) > rule.label_threshold;  // the columns of files are float
      out.label[row] = float(object), out.boundary[row] = 4 * share * (1 - share) > rule.tau;
      count[std::size_t(chunk)] += object;
    }
  });
  for (const std::int64_t c : count) out.count += c;
  return out;
}

}  // namespace ngs::live
