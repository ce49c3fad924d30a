#include "chain.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace ngs::studio {

std::vector<std::vector<std::string>> export_words(const StateFolder& folder, int object) {
  const auto at = [&](const char* name) { return folder.of(object, name); };
  return {
      {"ngs-variance", at("scene.json"), "-o", at("boundary.ply"), "-w"},
      {"ngs-joint", at("scene.json"), at("boundary.ply"), "--method", "flash", "-o", at("labelled.ply"), "-w"},
      {"ngs-extract", at("labelled.ply"), "--object", at("object.ply"), "--background", at("background.ply"), "-w"}};
}

std::vector<std::vector<std::string>> refine_words(const StateFolder& folder, int object, const RefineChoice& choice) {
  const auto at = [&](const char* name) { return folder.of(object, name); };
  std::vector<std::vector<std::string>> words;
  if (!choice.source.empty()) {
    words.push_back({"ngs-scene", "orbit", choice.source, "-o", at("orbit/scene.json"), "-w"});
    if (!choice.around.empty()) words.back().insert(words.back().end(), {"--around", choice.around});
  }
  words.push_back({"ngs", "cut", at("cut.json"), "--strokes", at("marks.json"), "--quality", choice.quality, "-o",
                   at("cut"), "-w"});
  return words;
}

std::string ball_around(const GaussianCloud& cloud, const live::ObjectLabels& labels) {
  std::vector<Vec3<double>> members;
  Vec3<double> sum{0, 0, 0};
  for (std::size_t i = 0; i < labels.label.size(); ++i)
    if (labels.label[i] > 0) {
      const float* p = &cloud.position[3 * i];
      members.push_back({double(p[0]), double(p[1]), double(p[2])});
      sum = sum + members.back();
    }
  if (members.empty()) return {};
  const Vec3<double> centre = (1.0 / double(members.size())) * sum;
  std::vector<double> distance;
  for (const Vec3<double>& m : members) distance.push_back(std::sqrt(dot(m - centre, m - centre)));
  constexpr double kShare = 0.97, kRoom = 1.3;  // stray Gaussians far away do not count; some of what is about it does
  const auto at = std::ptrdiff_t(kShare * double(distance.size() - 1));
  std::nth_element(distance.begin(), distance.begin() + at, distance.end());
  const double radius = kRoom * distance[std::size_t(at)];
  if (!(radius > 0)) return {};
  char text[160];
  std::snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.6g", centre.x + cloud.origin[0], centre.y + cloud.origin[1],
                centre.z + cloud.origin[2], radius);
  return text;
}

}  // namespace ngs::studio
