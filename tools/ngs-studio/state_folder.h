#pragma once
// Files of a session, in one folder:
//
//   studio.json            objects, looks and strokes
//   visit.jsonl            every request that changed the state, for --replay
//   object-1/              one folder per object id
//     masks/0001.png       the mask of each marked view, 0/255
//     images/0001.png      its picture               } written for Refine and Export
//     scene.json           cameras and masks         }
//     strokes.json         strokes, for ngs-mask     }
//     selection.ply        the selected Gaussians, if other than those of the strokes or of Refine
//     labelled.ply object.ply background.ply         Export
//   background.ply         Export of several objects: without any of them
//     orbit/ marks.json cut.json cut/                Refine: ngs cut
#include <map>
#include <optional>
#include <string>

#include "ngs/interactive/marks.h"
#include "ngs/interactive/session.h"
#include "ngs/scene/scene.h"
#include "requests.h"
#include "shared/cli/common_flags.h"
#include "shared/run/paths.h"

namespace ngs::studio {

struct StudioPlace {
  std::string source;                                   // a splat, or a scene.json that names one
  std::string folder;                                   // the session's files
  cli::DeviceChoice device = cli::DeviceChoice::kAuto;  // of the programs that Refine and Export run
  // as in a web page: Export writes the Gaussians shown itself, and visit.jsonl for the installed studio
  bool without_programs = false;
};

class StateFolder {
 public:
  /// Creates the folder, or opens that of an earlier session. kUsage for a folder with other files; kEnvironment for
  /// that of a session that still runs.
  explicit StateFolder(std::string path);

  /// State of an earlier session, with masks; nullopt for a new folder. kBadInput: files invalid or of another model.
  std::optional<live::Marks> load(const std::string& source) const;
  /// Writes studio.json and the masks changed since the last call; removes masks of deleted views.
  void save(const live::Marks& marks, const std::string& source);
  void note(const std::string& line) const;

  /// Writes pictures, scene.json and strokes.json of an object. `like`: all scene settings but views and objects.
  void write_scene(const live::Session& session, const live::ObjectMarks& object, const Scene& like) const;
  /// Writes marks.json and cut.json for ngs cut: the views of `base` and the marked views.
  void write_cut(const live::ObjectMarks& object, const Scene& base) const;

  const std::string& path() const { return path_; }
  std::string at(const std::string& name) const { return path_ + "/" + name; }
  std::string of(int object, const std::string& name = {}) const;

 private:
  void save_masks(const live::ObjectMarks& object);

  std::string path_;
  std::optional<cli::FolderLock> lock_;
  std::map<int, std::map<std::string, std::shared_ptr<const live::MarkedView>>> saved_;  // by object id and view name
};

// JSON of a session: studio.json, strokes for ngs-mask, and masks converted to strokes.

/// {"ngs_studio": 1, "source", "active", "next_id", "objects": [{"id", "name", "colour", "next_view",
///  "views": [{"name", "look": Camera, "strokes": [{"label", "radius_px", "points"}]}]}]}; of an object also
/// "edits", "hidden", "locked" and "keeps_dropped", if it has them
Json json_of(const live::Marks& marks, const std::string& source);
/// Inverse of json_of, without masks. Error(kBadInput) for invalid JSON and for another source.
live::Marks marks_of(const nlohmann::json& root, const std::string& source);

/// "#rrggbb".
std::string colour_of(const io::JsonReader& reader, const std::string& key);

/// A list of at least one pixel [x, y].
std::vector<std::array<double, 2>> points_of(const io::JsonReader& reader, const std::string& key);
/// Member "strokes" of a request and of studio.json.
std::vector<PromptStroke> strokes_of(const io::JsonReader& request);
Json json_of(const std::vector<PromptStroke>& strokes);

/// Prompts of ngs-mask (data-schema/prompts.schema.json): the strokes of each view.
Json strokes_json(const live::ObjectMarks& object);
/// Prompts from the masks: one stroke per run of pixels, except in a band along the contour, which is segmented again.
Json marks_json(const live::ObjectMarks& object);
/// Name of a marked view in cut.json: "marked-0001.png".
std::string marked_name(const live::MarkedView& view);

}  // namespace ngs::studio
