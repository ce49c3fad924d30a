#pragma once
// What ngs cut works on, from its command line.
#include <set>
#include <string>
#include <vector>

namespace ngs::ngs_tool {

/// A splat without photos, a capture, or a scene.json.
enum class SourceKind { kSplat, kCapture, kScene };

struct CutInputs {
  std::string source;  // as given on the command line
  SourceKind kind = SourceKind::kSplat;
  std::vector<std::string> strokes;       // prompt files and folders, as for ngs-mask --prompts
  std::string model, masks, truth;        // empty: from the capture
  std::string given_masks, given_truth;   // of these, as given on the command line
  std::string images, world_transform;    // of a capture; empty: from the capture, none
  std::vector<std::string> import_words;  // other options for ngs-scene import
  std::vector<std::string> all_words;     // all given options
  std::set<std::string> own_flags;        // of ngs cut
  std::string out;                        // the output folder
  bool has_renders = false;               // all images are renders of the splat, or will be
  bool renders_capture = false;           // kSplat: `source` has the cameras of the renders, `model` is the splat
  std::string splat() const {             // with has_renders
    return kind == SourceKind::kSplat && !renders_capture ? source : model;
  }
};

/// Detects the kind: a folder, transforms.json, cameras.json or poses_bounds.npy is a capture, a JSON file with
/// "ngs_scene" a scene, everything else a splat, whose reader reports errors. Throws kBadInput if the path does not
/// exist.
SourceKind kind_of(const std::string& path);

/// The splat of a capture of which no photo is there and, unless the object is `marked` by strokes, no mask: pictures
/// can be rendered from its cameras. `model`: the splat as given, or empty. Empty: there are photos or masks, no splat,
/// or the capture is unreadable, which its import reports.
std::string splat_without_photos(const std::string& capture, const std::string& model, bool marked);

/// False for an empty path and for one that cannot be read.
bool exists(const std::string& path);

/// Throws kBadInput, with a list of the files found, if the capture has no splat.
void require_model_in(const std::string& path);

}  // namespace ngs::ngs_tool
