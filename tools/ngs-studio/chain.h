#pragma once
// Which programs make the files of an object, with the words that a person would type.
#include "job.h"
#include "state_folder.h"

namespace ngs::studio {

/// The Gaussians that are shown, and no others: ngs-variance, ngs-joint --method flash, ngs-extract.
std::vector<std::vector<std::string>> export_words(const StateFolder& folder, int object, bool all_pieces);

struct RefineChoice {
  std::string source;  // a splat to make pictures of; empty: the scene has its own
  std::string around;  // X,Y,Z,R for ngs-scene orbit
  std::string quality = "standard";
  bool all_pieces = false;
};
/// The full method: ngs-scene orbit where there is a splat alone, then ngs cut over its views and the marked ones.
std::vector<std::vector<std::string>> refine_words(const StateFolder& folder, int object, const RefineChoice& choice);

/// A ball.
struct Focus {
  Vec3<double> centre{0, 0, 0};
  double radius = 0;
};

/// "X,Y,Z,R": a ball about what is selected, empty where nothing is.
std::string ball_around(const GaussianCloud& cloud, const live::ObjectLabels& labels);

/// Where most of what is selected lies, in the world; radius 0 where nothing is. Strays far away do not count.
Focus focus_of(const GaussianCloud& cloud, const live::ObjectLabels& labels);

}  // namespace ngs::studio
