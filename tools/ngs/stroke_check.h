#pragma once
// Whether labels keep to the strokes of a run of ngs cut.
#include <string>
#include <vector>

#include "ngs/scene/scene.h"
#include "ngs/stages/select/stroke_agreement.h"
#include "ngs/stages/select/touched_pieces.h"
#include "shared/run/run.h"

namespace ngs::front {

class StrokeCheck {
 public:
  /// `scene`: a file. Errors as cli::read_prompts() and rasterise().
  StrokeCheck(const cli::Run& run, const std::string& scene, const std::string& view,
              const std::vector<std::string>& strokes);

  /// Of these labels [N], without the pieces that no stroke touches unless `all_pieces`.
  StrokeAgreement of(const GaussianCloud& cloud, std::vector<float> label, bool all_pieces) const;

 private:
  struct Marked {
    Camera camera;
    ViewPrompt prompt;
  };
  Exec exec_;
  Scene scene_;
  std::vector<Marked> marked_;
};

/// "0003.png: 87 % of the red stroke at 412,530 is object; 0007.png: ...", three at most.
std::string broken_text(const StrokeAgreement& agreement);

}  // namespace ngs::front
