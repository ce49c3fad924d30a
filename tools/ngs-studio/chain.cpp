#include "chain.h"

#include <algorithm>
#include <cstdio>

#include "ngs/math/median.h"

namespace ngs::studio {
namespace {

using Words = std::vector<std::string>;

Words joined(Words words, const Words& more) {
  words.insert(words.end(), more.begin(), more.end());
  return words;
}

/// Options of ngs-extract for the files of an export.
Words outputs_of(const StateFolder& folder, int object, const ExportChoice& choice) {
  const auto at = [&](const std::string& name) { return folder.of(object, name); };
  const Words halves{"--object-ply",
                     at("object." + choice.format),
                     "--background-ply",
                     at("background." + choice.format),
                     "--labelled",
                     at("labelled.ply"),
                     "-w"};
  if (!choice.fill) return halves;
  return joined({"--background-filled", at("background-filled." + choice.format)}, halves);
}

/// Without labels the whole model is in a ball around everything; the edit then decides.
Words import_words(const std::string& labelled, const std::string& selection) {
  return {"ngs-extract", labelled,   "--keep-sphere", "0,0,0,1e18",   "--import",
          selection,     "--unseen", "background",    "--allow-empty"};
}

}  // namespace

std::vector<Words> export_words(const StateFolder& folder, int object, const ExportChoice& choice) {
  const auto at = [&](const std::string& name) { return folder.of(object, name); };
  Words extract{"ngs-extract", at("flash.ply"), "--unseen", "background", "--scene", at("scene.json")};
  if (!choice.all_pieces) extract = joined(extract, {"--strokes", at("strokes.json")});
  return {{"ngs-variance", at("scene.json"), "-o", at("boundary.ply"), "-w"},
          {"ngs-joint", at("scene.json"), at("boundary.ply"), "--method", "flash", "-o", at("flash.ply"), "-w"},
          joined(extract, outputs_of(folder, object, choice))};
}

std::vector<Words> selection_words(const StateFolder& folder, int object, const std::string& labelled,
                                   const ExportChoice& choice) {
  return {joined(import_words(labelled, folder.of(object, "selection.ply")), outputs_of(folder, object, choice))};
}

Words common_background_words(const StateFolder& folder, const std::string& model, const ExportChoice& choice) {
  return joined(import_words(model, folder.at("objects.ply")),
                {"--background-ply", folder.at("background." + choice.format), "-w"});
}

std::vector<Words> convert_words(const StateFolder& folder, int object, const ExportChoice& choice) {
  const auto at = [&](const std::string& name) { return folder.of(object, "cut/" + name); };
  std::vector<Words> words;
  if (choice.format != "ply")
    for (const std::string side : {"object.", "background."})  // a ball around everything: the whole model
      words.push_back({"ngs-extract", at(side + "ply"), "--keep-sphere", "0,0,0,1e18", "--allow-empty", "--object-ply",
                       at(side + choice.format), "-w"});
  if (choice.fill)
    words.push_back({"ngs-extract", at("labelled.ply"), "--unseen", "background", "--background-filled",
                     at("background-filled." + choice.format), "-w"});
  return words;
}

Words mesh_words(const std::string& folder, const ExportChoice& choice) {
  return {"ngs-mesh",
          folder + "/object." + choice.format,
          "--background",
          folder + "/background." + choice.format,
          "--collider",
          "convex:8",
          "-o",
          folder + "/mesh.glb",
          "-w"};
}

std::vector<Words> refine_words(const StateFolder& folder, int object, const RefineChoice& choice) {
  const auto at = [&](const char* name) { return folder.of(object, name); };
  std::vector<Words> words;
  if (!choice.source.empty()) {
    words.push_back({"ngs-scene", "orbit", choice.source, "-o", at("orbit/scene.json"), "-w"});
    if (!choice.around.empty()) words.back() = joined(words.back(), {"--around", choice.around});
  }
  words.push_back({"ngs", "cut", at("cut.json"), "--strokes", at("marks.json"), "--force", "-o", at("cut"), "-w"});
  const bool quick = choice.quality == kQuickRefine, flash = quick && !choice.source.empty();
  const std::string quality = quick ? "draft" : choice.quality;
  words.back() = joined(words.back(), flash ? Words{"--method", "flash"} : Words{"--quality", quality});
  if (choice.all_pieces) words.back().push_back("--all-pieces");
  return words;
}

namespace {

/// Positions of the selected Gaussians, relative to the cloud's origin.
std::vector<Vec3<double>> selected(const GaussianCloud& cloud, const live::ObjectLabels& labels) {
  std::vector<Vec3<double>> members;
  members.reserve(std::size_t(labels.count));
  for (std::size_t i = 0; i < labels.label.size(); ++i)
    if (labels.label[i] > 0) {
      const float* p = &cloud.position[3 * i];
      members.push_back({double(p[0]), double(p[1]), double(p[2])});
    }
  return members;
}

/// Radius around `centre` that contains the fraction `share` of the members.
double radius_of_share(const std::vector<Vec3<double>>& members, Vec3<double> centre, double share) {
  std::vector<double> distance;
  distance.reserve(members.size());
  for (const Vec3<double>& m : members) distance.push_back(length(m - centre));
  return quantile(std::move(distance), share);
}

Vec3<double> origin_of(const GaussianCloud& cloud) { return {cloud.origin[0], cloud.origin[1], cloud.origin[2]}; }

}  // namespace

std::string ball_around(const GaussianCloud& cloud, const live::ObjectLabels& labels) {
  const std::vector<Vec3<double>> members = selected(cloud, labels);
  if (members.empty()) return {};
  Vec3<double> sum{0, 0, 0};
  for (const Vec3<double>& m : members) sum = sum + m;
  const Vec3<double> centre = (1.0 / double(members.size())) * sum, world = centre + origin_of(cloud);
  constexpr double kShare = 0.97, kMargin = 1.3;  // leaves out distant outliers, includes some surroundings
  const double radius = kMargin * radius_of_share(members, centre, kShare);
  if (!(radius > 0)) return {};
  char text[160];
  std::snprintf(text, sizeof text, "%.6g,%.6g,%.6g,%.6g", world.x, world.y, world.z, radius);
  return text;
}

Focus focus_of(const GaussianCloud& cloud, const live::ObjectLabels& labels) {
  const std::vector<Vec3<double>> members = selected(cloud, labels);
  if (members.empty()) return {};
  const auto median = [&](double Vec3<double>::*axis) {
    std::vector<double> values;
    values.reserve(members.size());
    for (const Vec3<double>& m : members) values.push_back(m.*axis);
    return quantile(std::move(values), 0.5);
  };
  const Vec3<double> centre{median(&Vec3<double>::x), median(&Vec3<double>::y), median(&Vec3<double>::z)};
  constexpr double kShare = 0.8, kMargin = 1.5;  // a first stroke also selects pieces of the wall behind the object
  return {centre + origin_of(cloud), kMargin * radius_of_share(members, centre, kShare)};
}

}  // namespace ngs::studio
