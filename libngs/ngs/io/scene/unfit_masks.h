#pragma once
// Files that look like masks and fit no view.
#include <string>
#include <vector>

#include "ngs/scene/scene.h"

namespace ngs::io {

/// The .json files that may annotate photos, sorted: of `given`, a folder or a file; if it is empty, of the other
/// folders and of annotations/ in `base`, and those in `base` whose names suggest it.
std::vector<std::string> annotation_files(const std::string& given, const std::string& base,
                                          const std::vector<std::string>& folders);

/// What was found, and what to do with it; empty: no such files. `folder` and its sub-folders are searched; or it is a
/// file.
struct UnfitMasks {
  std::string found, remedy;
};
UnfitMasks unfit_masks(const std::string& folder, const std::vector<SceneView>& views);

/// masks/ in `base` or, for the output of a trainer, next to the photos elsewhere; empty: none. A file or a lost link
/// of this name becomes `unfit`.
std::string usual_masks(const std::string& base, const std::string& photos, UnfitMasks& unfit);

/// Removes the paths of masks that the source of the cameras names and that are no files.
UnfitMasks leave_out_lost_masks(std::vector<SceneView>& views);

/// Pictures with masks drawn on them, in a folder beside folders of masks, are no object: removes these names of
/// sub-folders of `folder` from `objects`, with a note.
void leave_out_pictures(const std::string& folder, const std::vector<SceneView>& views,
                        std::vector<std::string>& objects, std::vector<std::string>& notes);

/// A note on views in which an object of several has no mask: they count as views without masks (masks.h).
std::string incomplete_masks(const Scene& scene);

/// Whether the name of a folder suggests masks.
bool is_called_like_masks(const std::string& lower_name);

/// Folders below `base`, at most three deep, that hold pictures called like views, except `photos`, truth, and results
/// of ngs: those whose name suggests masks, with folders of objects or without; others whose pictures have few values.
struct MaskFolders {
  std::vector<std::string> by_name, by_look;
};
MaskFolders mask_folders_below(const std::string& base, const std::string& photos, const std::vector<SceneView>& views);

/// A file of annotations in another format, a folder labels/ of text, or a film, an array, an archive or a TIFF in
/// `base` that is called like masks; empty: none.
std::string file_of_all_masks(const std::string& base);

}  // namespace ngs::io
