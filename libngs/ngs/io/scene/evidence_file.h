#pragma once
// Evidence of some of a scene's views on disk, to be merged later: a safetensors file with the sums of scene/evidence.h
// and, as metadata, which model (content hash), objects and views they are of.
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/relative_path.h"
#include "ngs/scene/evidence.h"

namespace ngs::io {

struct EvidencePart {
  Evidence evidence;
  std::string model_hash;            // of the PLY the sums are about
  std::string scene_path;            // scene.json; in the file relative to the file's own folder; empty: it has no path
  std::string made_with;             // what else the sums depend on, as text: the scene's content, options of the splat
  std::vector<std::string> objects;  // names, in the order of the columns
  std::vector<std::string> views;    // names of the views summed
};

void write_evidence(const std::string& path, const EvidencePart& part, StoredPaths stored = StoredPaths::kRelative);
/// kBadInput for anything that write_evidence would not have written.
EvidencePart read_evidence(const std::string& path);
EvidencePart parse_evidence(const std::string& path, Bytes bytes);

/// The sum of the parts. kInconsistent where they are of different models or objects, were made from different scenes
/// or with different options, or share a view.
EvidencePart merge_evidence(const std::vector<std::string>& paths);

}  // namespace ngs::io
