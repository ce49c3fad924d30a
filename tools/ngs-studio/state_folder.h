#pragma once
// What lasts of a visit, in a folder of its own:
//
//   studio.json            objects, looks and strokes
//   visit.jsonl            every request that changed something, to be run again by --replay
//   object-1/              of the object with this number
//     masks/0001.png       the mask of each marked view, 0/255
//     images/0001.png      its picture               } written for Refine and Export
//     scene.json           cameras and masks         }
//     strokes.json         strokes, for ngs-mask     }
//     labelled.ply object.ply background.ply         Export
//     orbit/ marks.json cut.json cut/                Refine: ngs cut
#include <map>
#include <optional>
#include <string>

#include "ngs/scene/scene.h"
#include "ngs/stages/live/session.h"

namespace ngs::studio {

struct StudioPlace {
  std::string source;  // a splat, or a scene.json that names one
  std::string folder;  // where all that lasts is kept
};

class StateFolder {
 public:
  /// Makes the folder, or takes one that is ours. kUsage for a folder that holds something else.
  explicit StateFolder(std::string path);

  /// What an earlier visit left, masks included; none: it is new. kBadInput for files that are not ours, or of another
  /// model.
  std::optional<live::Marks> load(const std::string& source) const;
  /// studio.json, and the masks that changed since the last call; those of views that are gone are removed.
  void save(const live::Marks& marks, const std::string& source);
  /// A line of visit.jsonl.
  void note(const std::string& line) const;

  /// Writes pictures, scene.json and strokes.json of an object. `like`: what of a scene is not views or objects.
  void write_scene(const live::Session& session, const live::ObjectMarks& object, const Scene& like) const;
  /// Writes marks.json and cut.json: the views of `base` and the marked ones, for ngs cut.
  void write_cut(const live::ObjectMarks& object, const Scene& base) const;

  const std::string& path() const { return path_; }
  std::string at(const std::string& name) const { return path_ + "/" + name; }
  std::string of(int object, const std::string& name = {}) const;

 private:
  void save_masks(const live::ObjectMarks& object);

  std::string path_;
  std::map<int, std::map<std::string, std::shared_ptr<const live::MarkedView>>> saved_;  // by object and name
};

}  // namespace ngs::studio
