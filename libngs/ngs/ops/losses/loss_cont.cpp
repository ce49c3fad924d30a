#include "ngs/ops/losses/loss_cont.h"

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/losses/loss_cont_kernels.h"
#include "ngs/ops/optim/resident.h"

namespace ngs {

double loss_cont(const Exec& exec, const ContinuityInputs& in, double scale, std::vector<float>* gradient,
                 const AddRowColourGradients* add) {
  const KnnGraph& graph = in.graph;
  const Rows<const float, 3> colour = in.colour;
  NGS_CHECK(add == nullptr || gradient != nullptr, "loss_cont: a gradient to add");
  if (gradient) gradient->resize(std::size_t(colour.n) * 3);
  if (graph.neighbours == 0) {
    if (gradient) fill_zero(exec, *gradient);
    return 0;
  }
  NGS_CHECK(graph.queries() == colour.n && graph.points == colour.n, "loss_cont: the graph must have the same points");
  NGS_CHECK(in.weight.empty() || in.weight.size() == graph.index.size(), "one weight per edge, or none");
  const ContinuityGraph<float> view{graph.indices(), graph.row_begin.data(), graph.edge.data(),
                                    in.weight.empty() ? nullptr : in.weight.data(), colour};
  std::vector<float> term(exec.device_ops ? 0 : std::size_t(colour.n));
  const ContinuityForward<float> forward{view, term.data()};
  const ContinuityBackward<float> backward{
      view, float(scale / double(colour.n)), {gradient ? gradient->data() : nullptr, colour.n}};
  if (exec.device_ops)
    return exec.device_ops->loss.continuity(forward, gradient ? &backward : nullptr, add) / double(colour.n);
  for_each_index(exec, colour.n, forward);
  if (gradient) for_each_index(exec, colour.n, backward);
  if (add) for_each_index(exec, colour.n, AddRowColourGradients{add->place, gradient->data(), add->sh_dc});
  double sum = 0;
  for (const float t : term) sum += double(t);
  return sum / double(colour.n);
}

}  // namespace ngs
