#pragma once
// ngs cut --quality flash: strokes -> object.ply by one process that reads the model once (stages/live/ball_cut.h).
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "shared/run/run.h"

namespace ngs::front {

struct FlashInputs {
  std::string model, scene;  // files; the scene has the cameras and the pictures that were marked
  std::string around;        // "X,Y,Z,R"; empty: all of the model
  std::string view;          // that the strokes are of; empty: as each says
  std::vector<std::string> strokes;
  std::string out;  // folder
};

struct FlashFigures {
  std::int64_t object = 0, background = 0, in_ball = 0;  // Gaussians
  std::size_t views = 0, segmented = 0;                  // of these, with a mask of their own
  double wall_s = 0;                                     // with reading and writing
};

/// Writes object.ply, background.ply, labelled.ply and masks/STEM.png of all cameras. Nothing where a signal asked to
/// stop.
std::optional<FlashFigures> flash_cut(cli::Run& run, const FlashInputs& inputs);

/// --max-views of ngs-scene orbit for it, where `views` are wanted to begin with (0: as many as are usual).
std::string most_flash_views(int views);

}  // namespace ngs::front
