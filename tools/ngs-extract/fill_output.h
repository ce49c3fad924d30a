#pragma once
// The background with its hole filled (--fill), and the added Gaussians alone.
#include <optional>
#include <string>

#include "extractor.h"
#include "ngs/stages/fill/fill_stage.h"
#include "outputs.h"

namespace ngs::cli {

/// Throws kUsage for --filled without --fill; warns about --fill without an output that it changes.
void check_fill_options(Run& run, const FillOptions& options, const Outputs& out);

class FillOutput {
 public:
  /// Call it after Extractor::decide(). Fills the hole unless the option is off, adds "fill" to the result, and prints
  /// one line.
  FillOutput(Run& run, const Extractor& extractor, const FillOptions& options);

  /// Writes the requested ones of --background-ply and --filled.
  void write(const Outputs& out) const;

 private:
  /// The background; with --fill without the removed rows, and with the added ones at its end. PLY: with the column
  /// ngs_filled and the comment ngs-fill.
  void write_background(const std::string& path) const;
  std::vector<std::string> comments() const;
  void write_rows(const std::string& path, const GaussianCloud& cloud, std::size_t kept) const;

  Run& run_;
  const Extractor& extractor_;
  std::optional<HoleFill> fill_;
  Json report_;  // of the comment
};

}  // namespace ngs::cli
