#pragma once
// The work of ngs-extract between reading the labelled model and writing its parts.
#include <string>
#include <vector>

#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/stages/extract/extract_stage.h"
#include "ngs/stages/select/region.h"
#include "ngs/stages/select/touched_pieces.h"
#include "shared/run/run.h"

namespace ngs::cli {

struct SelectOptions {
  std::vector<std::string> select;
  bool activated = false;
  std::string view;

  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.select, Text{"select", "NAME", "an object to extract from a model with several; default: all of them"});
    visit(self.activated,
          Flag{"activated",
               "the input's scale_* are lengths, its opacity 0 to 1, as some programs save them: convert "
               "both to logarithms and logits; without labels and region all of the model is the object"});
    visit(self.view, Text{"view", "NAME", "the picture that the strokes are on; default: as each file says"});
  }

  io::ReadOptions reading() const {
    return {.encoding = activated ? io::ValueEncoding::kActivated : io::ValueEncoding::kTrained};
  }
};

class Extractor {
 public:
  /// kBadInput if the model has no labels and `region` asks for nothing, kUsage if one of `select` names no object.
  /// None: all objects.
  Extractor(Run& run, io::GaussianPly ply, const ExtractOptions& options, const RegionOptions& region,
            const SelectOptions& select);

  /// Labels and ngs_fixed of the selected object from a hand-edited splat.
  void import(const std::string& path);
  /// Every object's label becomes 0 or 1, those of the selected objects 0 outside the region; counts go into the
  /// result. kNothingFound if the object is empty.
  void decide();

  /// After decide(): of the object only the connected pieces that these strokes touch stay; says what was left out.
  void keep_touched(const std::vector<StrokeWeights>& strokes);

  const GaussianCloud& cloud() const { return ply_.cloud; }
  const std::vector<std::uint8_t>& object() const { return keep_; }  // [N], after decide()
  /// Labels of the objects that are extracted, in the order of the model; every column filled.
  std::vector<const io::NamedLabels*> chosen() const;

  /// In the format that the path's extension names.
  void write_object(const std::string& path) const;
  void write_background(const std::string& path) const;
  void write_labelled(const std::string& path, bool with_state) const;

 private:
  void restrict_to_region();
  /// Says which share of what the shapes leave goes with --drop-below-plane.
  void tell_what_the_plane_takes(const RegionSelection& found);
  void restrict_to(std::vector<std::uint8_t> keep);
  void tell_what_is_odd(std::int64_t kept);
  void write(const std::string& path, const std::vector<std::uint8_t>& keep) const;

  Run& run_;
  const ExtractOptions& options_;
  const RegionOptions& region_;
  bool takes_all_;  // a model without labels is the object as a whole: it is converted
  io::GaussianPly ply_;
  std::vector<io::NamedLabels> objects_;
  std::vector<std::size_t> chosen_;
  std::vector<std::uint8_t> keep_;
};

}  // namespace ngs::cli
