#pragma once
// Command lines that write the files of an object, as a user would type them.
#include "job.h"
#include "state_folder.h"

namespace ngs::studio {

/// File formats of Export, by the ending of the file.
inline constexpr const char* kFormats[] = {"ply", "compressed.ply", "spz", "sog"};

struct ExportChoice {
  bool all_pieces = false;
  std::string format = "ply";
  bool fill = true;   // also writes background-filled.FORMAT: without the hole behind the object
  bool mesh = false;  // also writes mesh.glb with convex colliders
};
/// Export: writes exactly the Gaussians shown, with ngs-variance, ngs-joint --method flash and ngs-extract. Other
/// labels than those of the strokes, or of Refine, are those of selection.ply: `labelled` is the splat that it was made
/// from.
std::vector<std::vector<std::string>> selection_words(const StateFolder& folder, int object,
                                                      const std::string& labelled, const ExportChoice& choice);
/// The background without any object, from the splat of the session.
std::vector<std::string> common_background_words(const StateFolder& folder, const std::string& model,
                                                 const ExportChoice& choice);
std::vector<std::vector<std::string>> export_words(const StateFolder& folder, int object, const ExportChoice& choice);
/// Export after Refine: converts its object.ply and background.ply, unless the format is ply, and fills the hole.
std::vector<std::vector<std::string>> convert_words(const StateFolder& folder, int object, const ExportChoice& choice);
/// The mesh of the object.FORMAT in a folder, closed where it stands on background.FORMAT.
std::vector<std::string> mesh_words(const std::string& folder, const ExportChoice& choice);

/// The quality of Refine that takes seconds: --method flash for a splat without photos, else --quality draft.
inline constexpr const char* kQuickRefine = "quick";

struct RefineChoice {
  std::string source;  // a splat without views, to be rendered; empty: the scene has views
  std::string around;  // X,Y,Z,R for ngs-scene orbit
  std::string quality = "standard";
  bool all_pieces = false;
};
/// Refine: ngs-scene orbit for a splat without views, then ngs cut over those views and the marked views.
std::vector<std::vector<std::string>> refine_words(const StateFolder& folder, int object, const RefineChoice& choice);

/// A ball.
struct Focus {
  Vec3<double> centre{0, 0, 0};
  double radius = 0;
};

/// "X,Y,Z,R": a ball around the selected Gaussians; empty without a selection.
std::string ball_around(const GaussianCloud& cloud, const live::ObjectLabels& labels);

/// Ball around most selected Gaussians, in world units, without outliers; radius 0 without a selection.
Focus focus_of(const GaussianCloud& cloud, const live::ObjectLabels& labels);

}  // namespace ngs::studio
