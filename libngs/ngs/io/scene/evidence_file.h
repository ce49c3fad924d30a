#pragma once
// Partial evidence of some views of a scene, to be merged later: a safetensors file with the sums of scene/evidence.h.
// The metadata identify the model (content hash), the objects and the views.
#include <string>
#include <vector>

#include "ngs/io/files/mapped_file.h"
#include "ngs/io/files/relative_path.h"
#include "ngs/scene/evidence.h"

namespace ngs::io {

struct EvidencePart {
  Evidence evidence;
  std::string model_hash;            // of the model's PLY
  std::string scene_path;            // scene.json; stored relative to the file's folder; empty: no path
  std::string made_with;             // all other inputs of the sums, as text: scene content, splat options
  std::vector<std::string> objects;  // names, in column order
  std::vector<std::string> views;    // names of the summed views
};

void write_evidence(const std::string& path, const EvidencePart& part, StoredPaths stored = StoredPaths::kRelative);
/// kBadInput for anything that write_evidence() does not write.
EvidencePart read_evidence(const std::string& path);
EvidencePart parse_evidence(const std::string& path, Bytes bytes);

/// The sum of the parts. kInconsistent if they have different models, objects, scenes or options, or share a view.
EvidencePart merge_evidence(const std::vector<std::string>& paths);

}  // namespace ngs::io
