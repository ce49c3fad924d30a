#pragma once
// The background with its hole filled (--background-filled, --inpainted), and the added Gaussians alone.
#include <optional>
#include <string>

#include "extractor.h"
#include "inpainted_input.h"
#include "ngs/edit/fill/fill_stage.h"
#include "outputs.h"

namespace ngs::cli {

/// Throws kUsage for --filled with --fill off, and for --inpainted without a scene or an output that it changes;
/// warns about --fill without such an output.
void check_fill_options(Run& run, const FillOptions& options, const Input& inpainted, const Input& scene,
                        const Outputs& out);

class FillOutput {
 public:
  /// Call it after Extractor::decide(). Fills the hole unless the option is off, adds "fill" to the result, and prints
  /// one line. With `inpainted` the added Gaussians are refitted to the pictures.
  FillOutput(Run& run, const Extractor& extractor, FillOptions options, InpaintedPictures* inpainted);

  /// Writes the requested ones of --background-ply, --background-filled and --filled. If nothing was filled, the second
  /// is not written, and a file of an earlier run is removed.
  void write(const Outputs& out) const;

 private:
  void refit(InpaintedPictures& inpainted);
  void report(const FillOptions& options);
  std::vector<std::string> comments() const;
  /// PLY: with the column ngs_filled and the comment ngs-fill.
  void write_rows(const std::string& path, const GaussianCloud& cloud, std::size_t kept) const;

  Run& run_;
  const Extractor& extractor_;
  std::optional<HoleFill> fill_;
  GaussianCloud background_;  // with a fill: without the removed rows, and with the added ones at its end
  std::size_t kept_ = 0;      // its rows that are not added
  Json report_;               // of the comment
};

}  // namespace ngs::cli
