#pragma once
// Selects the object in a labelled model and writes the parts.
#include <optional>
#include <string>
#include <vector>

#include "ngs/edit/extract/extract_stage.h"
#include "ngs/edit/select/region.h"
#include "ngs/edit/select/touched_pieces.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "shared/run/run.h"
#include "shared/scene/prompt_input.h"

namespace ngs::cli {

struct SelectOptions {
  std::vector<std::string> object;
  bool activated = false;
  std::string view;
  double unit = 1;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.object, Text{"object", "NAME", "Use only this object of several; default: all of them"});
    visit(self.activated, Flag{"activated",
                               "Input has activated values (scale_* as lengths, opacity in [0, 1]): convert them to "
                               "logarithms and logits; without labels and region the whole model is the object"});
    visit(self.view, Text{"view", "NAME", "Picture that the strokes belong to; default: the name in each file"});
    visit(self.unit, Field<double>{"unit", "m", "Length of a unit, for all formats but PLY", 1e-9, 1e9});
  }

  io::ReadOptions reading() const {
    return {.encoding = activated ? io::ValueEncoding::kActivated : io::ValueEncoding::kTrained};
  }
};

class Extractor {
 public:
  /// Throws kBadInput if the model has no labels and `region` is empty, kUsage if a name in `select.object` is no
  /// object. Without names all objects are meant.
  Extractor(Run& run, io::GaussianPly ply, const ExtractOptions& options, const RegionOptions& region,
            const SelectOptions& select);

  /// Imports labels and ngs_fixed of the selected object from a hand-edited splat.
  void import(const std::string& path);
  /// Rounds every object's label to 0 or 1, and sets those of the selected objects to 0 outside the region; adds counts
  /// to the result. Throws kNothingFound if the object is empty.
  void decide();

  /// After decide(): keeps only the object's connected components that these strokes touch, and reports the others.
  void keep_touched(const std::vector<ViewSums>& strokes);

  const GaussianCloud& cloud() const { return ply_.cloud; }
  const io::GaussianPly& model() const { return ply_; }
  const std::vector<std::uint8_t>& object() const { return keep_; }  // [N], after decide()
  /// Labels of the extracted objects, in the order of the model; every column is filled.
  std::vector<const io::NamedLabels*> chosen() const;

  /// Rows with keep[i] != 0, all if it is empty, in the format of the extension, by --up and --unit. `edited`: as in
  /// io::PartOfModel.
  void write(const std::string& path, const std::vector<std::uint8_t>& keep,
             const GaussianCloud* edited = nullptr) const;
  void write_background(const std::string& path) const;
  void write_labelled(const std::string& path, bool with_state) const;

 private:
  void restrict_to_region();
  /// Reports the fraction of Gaussians inside the shapes that --drop-below-plane removes.
  void report_plane_selection(const RegionSelection& found);
  void restrict_to(std::vector<std::uint8_t> keep);
  void warn_of_unusual_result(std::int64_t kept);

  Run& run_;
  const ExtractOptions& options_;
  const RegionOptions& region_;
  double unit_;
  bool whole_model_;  // the model has no labels and is the object as a whole
  io::GaussianPly ply_;
  std::vector<io::NamedLabels> objects_;
  std::vector<std::size_t> chosen_;
  std::vector<std::uint8_t> keep_;
};

/// Throws kUsage for strokes without a scene.
void check_strokes(Run& run, const Inputs& strokes, const Input& scene);

/// For every stroke on the object: the rendering weights of the Gaussians under it.
std::vector<ViewSums> stroke_weights_of(const Run& run, const Scene& scene, const Marks& marks,
                                        const GaussianCloud& cloud);

}  // namespace ngs::cli
