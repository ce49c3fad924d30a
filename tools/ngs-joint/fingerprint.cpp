#include "fingerprint.h"

#include "ngs/io/files/content_hash.h"
#include "shared/checkpoints.h"

namespace ngs::joint {
namespace {

std::string hash(const std::string& path) { return io::content_hash(path).xxh3; }

Json decided(const Decisions& decisions) {
  Json effects = Json::array();
  for (const Json& d : decisions.json())
    if (const std::string name = d["name"]; !belongs_to(name, "contours"))
      effects.push_back(name + (d["on"].get<bool>() ? "=on" : "=off"));
  return effects;
}

}  // namespace

Json known_of_state(const StateSource& source) {
  const RunOptions& o = source.declared.settings.run;
  RasterOptions raster = source.declared.raster;
  OptionSet splat;
  splat.add(raster);
  Json objects = Json::array();
  for (const SceneObject& object : source.scene.objects) objects.push_back(object.name);
  return {{"scene", hash(source.paths.scene)},
          {"boundary", hash(source.paths.boundary)},
          {"masks", cli::masks_hash(source.scene)},
          {"photos", cli::photos_hash(source.scene)},
          {"options", options_text(source.declared.settings)},
          {"raster", splat.to_json()},
          {"effects", decided(source.decisions)},
          {"background", o.background},
          {"objects", objects},
          {"seed", source.run.seed()},
          {"fast_atomics", o.fast_atomics}};
}

std::string fingerprint(Json known, const StateSource& source, const FloaterPlan& floaters, bool reads_field) {
  known["effects"] = decided(source.decisions);
  known["floaters"] = floaters.json();
  known["field"] = reads_field ? hash(source.paths.field) : "";
  return known.dump();
}

}  // namespace ngs::joint
