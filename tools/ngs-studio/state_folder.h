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

#include "ngs/interactive/session.h"
#include "ngs/scene/scene.h"
#include "shared/cli/common_flags.h"

namespace ngs::studio {

struct StudioPlace {
  std::string source;                                   // a splat, or a scene.json that names one
  std::string folder;                                   // the session's files
  cli::DeviceChoice device = cli::DeviceChoice::kAuto;  // of the programs that Refine and Export run
  bool exports_selection = false;  // Export writes the Gaussians shown, without the programs that repeat the strokes
};

class StateFolder {
 public:
  /// Creates the folder, or opens that of an earlier session. kUsage for a folder with other files.
  explicit StateFolder(std::string path);

  /// State of an earlier session, with masks; nullopt for a new folder. kBadInput for invalid files and for files of
  /// another model.
  std::optional<live::Marks> load(const std::string& source) const;
  /// Writes studio.json and the masks changed since the last call; removes masks of deleted views.
  void save(const live::Marks& marks, const std::string& source);
  /// Appends a line to visit.jsonl.
  void note(const std::string& line) const;

  /// Writes pictures, scene.json and strokes.json of an object. `like` gives all scene settings except views and
  /// objects.
  void write_scene(const live::Session& session, const live::ObjectMarks& object, const Scene& like) const;
  /// Writes marks.json and cut.json for ngs cut: the views of `base` and the marked views.
  void write_cut(const live::ObjectMarks& object, const Scene& base) const;

  const std::string& path() const { return path_; }
  std::string at(const std::string& name) const { return path_ + "/" + name; }
  std::string of(int object, const std::string& name = {}) const;

 private:
  void save_masks(const live::ObjectMarks& object);

  std::string path_;
  std::map<int, std::map<std::string, std::shared_ptr<const live::MarkedView>>> saved_;  // by object id and view name
};

}  // namespace ngs::studio
