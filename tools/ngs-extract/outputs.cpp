#include "outputs.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <iterator>

#include "ngs/edit/extract/unseen_surface.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/npy.h"
#include "ngs/io/formats/compression/zip_archive.h"

namespace ngs::cli {
namespace {

// Below this fraction the unseen surface consists of thin gaps between seen parts.
constexpr double kWorthTelling = 0.02;

std::vector<std::uint8_t> seen_of(const LabelColumn& views) {
  std::vector<std::uint8_t> seen(views.size());
  std::ranges::transform(views, seen.begin(), [](float v) { return std::uint8_t(v != 0); });
  return seen;
}

/// Indices of the rows that are not 0.
template <class T>
std::vector<std::int64_t> rows_of(const std::vector<T>& member) {
  std::vector<std::int64_t> rows;
  for (std::size_t i = 0; i < member.size(); ++i)
    if (member[i] != T(0)) rows.push_back(std::int64_t(i));
  return rows;
}

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

NumpyLabels::NumpyLabels(const Extractor& extractor) {
  for (const io::NamedLabels* object : extractor.chosen()) labels_.push_back(object->columns.label.values());
}

void NumpyLabels::write(const std::string& path, const Extractor& extractor) const {
  const std::vector<const io::NamedLabels*> objects = extractor.chosen();
  std::vector<float> labels(extractor.object().size());
  std::vector<std::uint8_t> seen(labels.size());
  std::vector<io::ZipEntry> single;
  for (std::size_t k = 0; k < objects.size(); ++k) {
    const LabelColumns& columns = objects[k]->columns;
    const std::vector<std::uint8_t> seen_here = seen_of(columns.views);
    for (std::size_t i = 0; i < labels.size(); ++i) {
      labels[i] = std::max(labels[i], labels_[k][i]);
      seen[i] |= seen_here[i];
    }
    if (objects.size() == 1) continue;
    const std::string ending = "_" + objects[k]->object + ".npy";
    single.push_back({"labels" + ending, io::npy_of(labels_[k])});
    single.push_back({"seen" + ending, io::npy_of_flags(seen_here)});
    single.push_back({"object" + ending, io::npy_of(rows_of(columns.label.values()))});
  }
  std::vector<io::ZipEntry> entries{{"labels.npy", io::npy_of(labels)},
                                    {"seen.npy", io::npy_of_flags(seen)},
                                    {"object.npy", io::npy_of(rows_of(extractor.object()))}};
  std::ranges::move(single, std::back_inserter(entries));
  const std::vector<std::uint8_t> bytes = io::zip(entries);
  io::write_file(path, {reinterpret_cast<const char*>(bytes.data()), bytes.size()});
}

}  // namespace ngs::cli
