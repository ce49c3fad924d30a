#include "unseen_output.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ngs/edit/extract/unseen_surface.h"

namespace ngs::cli {
namespace {

// Below this fraction the unseen surface consists of thin gaps between seen parts.
constexpr double kWorthTelling = 0.02;

}  // namespace

void report_unseen_surface(Run& run, const Extractor& extractor, const Scene& scene) {
  const std::vector<std::uint8_t>& object = extractor.object();
  if (std::ranges::find(object, 1) == object.end()) return;
  std::vector<Camera> cameras;
  for (const SceneView& view : scene.views) cameras.push_back(view.camera);
  const UnseenSurface found = unseen_surface(run.exec(), run.monitor(), {extractor.cloud(), object, cameras});
  const orbit::Vec d = found.direction;
  run.result()["unseen_surface"] = {{"share", found.share}, {"worst", found.worst}, {"worst_from", {d.x, d.y, d.z}}};
  if (found.share < kWorthTelling) return;
  char text[200];
  std::snprintf(
      text, sizeof text,
      "the object: no view sees %.0f %% of its outer surface; from the direction (%.2f, %.2f, %.2f) %.0f %%\n",
      100 * found.share, d.x, d.y, d.z, 100 * found.worst);
  run.text(text);
}

}  // namespace ngs::cli
