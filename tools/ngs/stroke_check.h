#pragma once
// Checks labels against the strokes of ngs cut.
#include <string>
#include <vector>

#include "ngs/edit/select/stroke_agreement.h"
#include "ngs/edit/select/touched_pieces.h"
#include "ngs/scene/scene.h"
#include "shared/run/run.h"

namespace ngs::ngs_tool {

class StrokeCheck {
 public:
  /// `scene`: a file. Throws like cli::read_prompts() and rasterise().
  StrokeCheck(cli::Run& run, const std::string& scene, const std::string& view,
              const std::vector<std::string>& strokes);

  /// Agreement of these labels [N]; without `all_pieces`, components that no stroke touches are ignored.
  StrokeAgreement of(const GaussianCloud& cloud, const std::vector<float>& label, bool all_pieces) const;

 private:
  struct Marked {
    Camera camera;
    ViewPrompt prompt;
  };
  StrokeAgreement agreement(const GaussianCloud& cloud, std::vector<float> label, bool all_pieces) const;

  cli::Run& run_;
  Scene scene_;
  std::vector<Marked> marked_;
};

/// "0003.png: 87 % of the background stroke at 412,530 is object; 0007.png: ...", three at most.
std::string broken_text(const StrokeAgreement& agreement);

}  // namespace ngs::ngs_tool
