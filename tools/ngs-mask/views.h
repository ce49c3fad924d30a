#pragma once
// The views at the size that is segmented, and what becomes of them.
#include <map>

#include "ngs/scene/gaussian_cloud.h"
#include "ngs/stages/mask_spread.h"
#include "shared/tool.h"

namespace ngs::cli {

class MaskViews {
 public:
  /// Reads the headers of the photos: each view is segmented at up to `detail` times the camera's size.
  MaskViews(const Scene& scene, int detail);

  const std::vector<Camera>& cameras() const { return cameras_; }
  const std::vector<bool>& has_photo() const { return has_photo_; }
  /// Largest size of a view over the scene's working size.
  double scale() const { return scale_; }
  ImageU8 photo(std::size_t view) const;

  /// Files of a run that does not come to report() are removed again.
  ~MaskViews();
  MaskViews(const MaskViews&) = delete;
  MaskViews& operator=(const MaskViews&) = delete;

  void write(Run& run, std::size_t view, const SpreadView& result, const std::string& masks,
             const std::string& soft);
  Json plan(const GaussianCloud& cloud, int passes) const;
  /// All is written: table, warnings and the counts of the report.
  void report(Run& run);

 private:
  const Scene& scene_;
  int detail_;
  std::vector<std::string> file_names_;  // [views] of the masks
  double scale_ = 1;
  std::vector<Camera> cameras_;
  std::vector<bool> has_photo_;
  struct Outcome {
    MaskSource source;
    double agreement, known, coverage;
  };
  std::map<std::size_t, Outcome> outcome_;
  std::vector<std::string> written_;
};

}  // namespace ngs::cli
