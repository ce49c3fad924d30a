#pragma once
// ngs-joint --apart i/N and ngs-joint merge: objects of one scene optimised in runs of their own.
#include <string>
#include <vector>

#include "chain.h"

namespace ngs::joint {

/// What a run is about: the whole scene, or shard i of N of the groups of objects that meet.
struct ApartRun {
  Scene scene;                     // with the run's objects
  std::vector<std::uint8_t> held;  // of the model, [N]; empty: nothing is held
  Json groups;                     // names of the objects that meet; of the whole scene
};

/// `shard`: "i/N", or empty for the whole scene. Groups are dealt to the shards in turn. kUsage where there are
/// fewer groups than shards.
ApartRun apart_run(const io::GaussianPly& ply, const Scene& scene, const std::string& shard);

/// What a part follows from beside the model, as one line: the scene's content, the options that differ from their
/// defaults, seed and version. Not --apart itself, nor what says when a run ends early or where it goes on.
std::string part_made_with(const cli::Run& run, const Declared& declared, const Paths& paths);

/// "ngs-joint merge": returns the exit code.
int merge_parts(int argc, char** argv);

}  // namespace ngs::joint
