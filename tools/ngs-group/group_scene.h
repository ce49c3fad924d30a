#pragma once
// The run of ngs-group, with the options of its command line.
#include <string>

#include "ngs/cut/groups/grouped_objects.h"
#include "ngs/render/render_options.h"
#include "shared/run/run.h"

namespace ngs::group {

struct SourceOptions {
  bool without_masks = false;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.without_masks,
          Flag{"without_masks", "Use no masks: objects are what shape and colours set apart in the splat"});
  }
};

struct Options {
  SourceOptions source;
  GroupOptions groups;
  ObjectOptions objects;
  RasterOptions raster;
};

/// Reads the scene and its masks (those of the folder `masks`, if one is named), and writes into `folder`. Returns the
/// exit code.
int group_scene(cli::Run& run, const Options& options, const std::string& scene_path, const std::string& masks,
                const std::string& folder);

}  // namespace ngs::group
