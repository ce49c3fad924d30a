#pragma once
// Interface of the terms of the loss that a trainer minimises: L = Σ weight · term.                            Eq. (20)
// A term brings its switch with its heuristic, its options, its columns of trace and report, and its gradient. To add
// one, write a class in a new file and add a line each to loss_list.h and .cpp.
#include <algorithm>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ngs/core/check.h"
#include "ngs/core/monitor.h"
#include "ngs/cut/training/effect.h"
#include "ngs/cut/training/joint_options.h"
#include "ngs/cut/training/view_cache.h"
#include "ngs/ops/optim/resident.h"
#include "ngs/ops/splat/step_tiles.h"
#include "ngs/options/option_set.h"
#include "ngs/problem/trained_rows.h"
#include "ngs/scene/boundary_set.h"
#include "ngs/scene/query_field.h"

namespace ngs {

/// The unweighted terms of a step, and their weighted sum.
struct LossValues {
  double total = 0;
  std::vector<std::pair<std::string_view, double>> terms = {};  // by column; 0: not evaluated

  double operator[](std::string_view column) const {
    return std::ranges::find(terms, column, &std::pair<std::string_view, double>::first)->second;
  }
  void set(std::string_view column, double weight, double value) {
    std::ranges::find(terms, column, &std::pair<std::string_view, double>::first)->second = value;
    total += weight * value;
  }
};

/// ∂L/∂(the rendered images of a step). A term takes the image that it needs, then writes or adds to it.
class ImageGradients {
 public:
  explicit ImageGradients(const Exec& exec) : exec_(exec), results_(exec) {}

  /// For a term that overwrites all values; no other term may have taken the image before.
  ImageF& overwritten(ImageF ViewGradients::*image);
  /// For a term that adds: zero when it is first taken.
  ImageF& added(ImageF ViewGradients::*image);
  void label_moves_geometry(bool moves) { gradients_.label_moves_geometry = moves; }

  void begin(const RenderedView& rendered);
  /// Images that no term has taken are empty, but for a rendered colour.
  const ViewGradients& end();

 private:
  bool is_taken(ImageF ViewGradients::*image) const { return std::ranges::find(taken_, image) != taken_.end(); }

  const Exec& exec_;
  const RenderedView* rendered_ = nullptr;
  ViewGradients gradients_;
  std::vector<ImageF ViewGradients::*> taken_;
  ResidentResults results_;  // gradients_
};

/// The model in training, with its current values. Outlives its terms.
struct TrainedModel {
  Exec exec;
  Monitor& monitor;
  const JointOptions options;
  const SampleOptions sample;
  const RbfOptions rbf;
  const Problem& input;
  const QueryField* field;  // query points of the initial model; null: sampled
  GaussianCloud cloud;
  TrainedRows rows;
  BoundarySet boundary = {};  // of the initial model
};

struct LossStep {
  const TrainedModel& model;
  std::int64_t number;           // from 0
  std::size_t view;              // of the scene
  double shown;                  // share of the view inside its camera; scales terms to means over uncropped views
  const ViewCache::View& given;  // photo and masks
  const RenderedView& rendered;
  ImageGradients& images;
  CloudGradients& gaussians;  // of the trained rows, after the backward pass of the rendering
  LossValues values;          // receives the terms
  // [H, W, 1], >= 0. Of the photometric loss in steps that leave out tiles, and of the mask loss; null: 1
  const ImageF* pixel_weight = nullptr;
  const StepTiles* tiles = nullptr;  // null: all are rendered
};

/// A named array that changes between steps, for checkpoints.
struct StateBlock {
  std::string name;
  std::vector<float>* values;
  std::size_t size;           // required number of values
  bool may_be_empty = false;  // true for moments, which are empty before the first step
  bool fits(std::size_t count) const { return count == size || (may_be_empty && count == 0); }
};
inline void add_moments(const std::string& name, AdamMoments& moments, std::size_t size,
                        std::vector<StateBlock>& blocks) {
  blocks.push_back({name + ".m", &moments.m, size, true});
  blocks.push_back({name + ".v", &moments.v, size, true});
}

class LossTerm {
 public:
  virtual ~LossTerm() = default;
  /// First the switch of the term, then those of its parts. A term that is off is not evaluated.
  virtual std::vector<Effect> effects() const = 0;
  /// Names of its values in trace and report.
  virtual std::vector<std::string_view> columns() const { return {effects().front().name}; }
  virtual void declare(OptionSet&, const OptionGroup&) {}
  /// A term with the same options, for one trainer; only it gets the following calls.
  virtual std::unique_ptr<LossTerm> copy() const = 0;

  /// Called before the first step. False: there is nothing to evaluate, and no other call follows. With
  /// JointOptions::at_contours the views are windows, and tiles far from contours may be left out of a step: a term
  /// that needs whole views returns false.
  virtual bool start(const TrainedModel&) { return true; }
  /// Requests images besides the labels.
  virtual void request(RenderRequest&) const {}
  /// Evaluates a term of the rendered images and adds `weight` times its gradient to theirs.
  virtual void add_on_view(LossStep&) {}
  /// Evaluates a term of the model and adds `weight` times its gradient. Called from the last term to the first.
  virtual void add_on_model(LossStep&) {}

  // For terms that have arrays of their own.

  /// Adds all arrays of a step that are not made by ResidentResults.
  virtual void add_to(Resident&) {}
  /// Called when positions, shapes and colours of the model have changed.
  virtual void follow_model(const Exec&, const Resident&) {}
  /// Takes step `number` (from 1) of its parameters; `decay` multiplies their rates.
  virtual void update(std::int64_t /*number*/, double /*decay*/) {}
  virtual void add_state(std::vector<StateBlock>&) {}
};

}  // namespace ngs
