#pragma once
// The marked views of a run: listed before it starts, and drawn with their strokes for the page.
#include <string>
#include <vector>

#include "shared/run/run.h"

namespace ngs::ngs_tool {

struct StrokeFiles {
  std::string scene;  // scene file with the views
  std::string view;   // view of the strokes; empty: as given in each file
  const std::vector<std::string>& strokes;
};

/// Reads the strokes and returns one line per marked view: its name and its numbers of object and background strokes.
/// `scene` empty: the pictures do not exist yet, so that the files are read without the views. Throws the errors of the
/// readers and kUsage for strokes of no view.
std::string strokes_text(cli::Run& run, const std::string& scene, const std::string& view,
                         const std::vector<std::string>& strokes);

/// Writes the picture of every marked view with its strokes, STEM.png, to the folder, which it replaces.
void write_marked_views(cli::Run& run, const StrokeFiles& files, const std::string& folder);

}  // namespace ngs::ngs_tool
