// L_cont: neighbouring Gaussians of the boundary have similar colours.                                     Eq. (17)
#include "ngs/cut/training/loss_list.h"
#include "ngs/cut/training/loss_term.h"
#include "ngs/cut/training/scene_probe.h"
#include "ngs/ops/losses/loss_cont.h"
#include "ngs/ops/neighbours/knn.h"
#include "ngs/ops/optim/rows.h"
#include "ngs/problem/scene_measures.h"

namespace ngs {
namespace {

class ContinuityTerm final : public LossTerm {
 public:
  std::vector<Effect> effects() const override {
    return {{.name = "cont",
             .help = "use L_cont",
             .saves = "the pass over the neighbours",
             .needs = kJointEffect,
             .heuristic = {"RMS colour difference of neighbours on the boundary, levels", 0.5, kHalfLevel,
                           [](SceneProbe& probe) {
                             return neighbour_rms_levels(probe.boundary_neighbours(), probe.boundary_colours());
                           }}}};
  }
  void declare(OptionSet& options, const OptionGroup& group) override { options.add(*this, group); }
  template <class Self, class Visitor>
  static void describe(Self& self, Visitor&& visit) {
    visit(self.weight_, Field<double>{"lambda_cont", "", "Weight of L_cont (Eq. 20)", 0, 1e6}.of("cont"));
  }
  std::unique_ptr<LossTerm> copy() const override { return std::make_unique<ContinuityTerm>(*this); }

  bool start(const TrainedModel& model) override {
    const BoundarySet& boundary = model.boundary;
    if (boundary.size() < 2 || model.options.at_contours) return false;
    graph_ = nearest_others(model.exec, boundary.positions(), model.rbf.neighbours);
    build_transpose(graph_);
    colour_.resize(boundary.row.size() * 3);
    gradient_.resize(colour_.size());
    for (const std::uint32_t row : boundary.row) {
      const std::optional<std::size_t> place = model.rows.gradient_row(row);
      place_.push_back(place ? std::int32_t(*place) : -1);
    }
    return true;
  }
  void add_on_model(LossStep& step) override {
    const BoundarySet& boundary = step.model.boundary;
    for_each_row(step.model.exec, boundary.size(),
                 RowColours{boundary.row.data(), step.model.cloud.sh_dc.data(), colour_.data()});
    const AddRowColourGradients add{place_.data(), nullptr, step.gaussians.sh_dc.data()};
    const double loss =
        loss_cont(step.model.exec, {graph_, {colour_.data(), boundary.size()}}, weight_, &gradient_, &add);
    step.values.set("cont", weight_, loss);
  }
  void add_to(Resident& resident) override {
    resident.add(graph_.index);
    resident.add(graph_.row_begin);
    resident.add(graph_.edge);
    resident.add(place_);
    resident.add(colour_);
    resident.add(gradient_);
  }

 private:
  double weight_ = 0.1;
  KnnGraph graph_;
  std::vector<std::int32_t> place_;       // [B] rows of the gradients; -1: not trained
  std::vector<float> colour_, gradient_;  // [B, 3]
};

}  // namespace

std::unique_ptr<LossTerm> make_continuity_loss() { return std::make_unique<ContinuityTerm>(); }

}  // namespace ngs
