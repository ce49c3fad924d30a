// ngs-group: masks of everything, whose ids mean nothing in other views -> label maps with one id per object.
#include "group_scene.h"
#include "shared/tool.h"

int main(int argc, char** argv) {
  using namespace ngs;
  cli::Tool tool("ngs-group", "Find the objects in masks of everything, whose ids mean nothing in other views.",
                 {"ngs-group scene.json --masks masks_all/ -o grouped/", "ngs-group scene.json -o grouped/",
                  "ngs-group scene.json --without-masks -o grouped/"});
  group::Options options;
  tool.options(options.source);
  tool.options(options.groups);
  tool.options(options.objects);
  tool.options(options.raster);
  const cli::Input& scene = tool.input("scene", "scene.json written by ngs-scene");
  const cli::Input& masks = tool.optional_input(
      "--masks", "folder of label maps, one per view, 8 or 16 bit; default: the label maps of the scene");
  const cli::Output& out = tool.output_dir("-o,--output", "folder for masks/, scene.json and objects.json");
  tool.stops_on_request();
  return tool.run(argc, argv,
                  [&](cli::Run& run) { return group::group_scene(run, options, scene.path, masks.path, out.path); });
}
