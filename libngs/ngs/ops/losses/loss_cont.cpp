#include "ngs/ops/losses/loss_cont.h"

#include "ngs/backend/for_each.h"
#include "ngs/core/check.h"
#include "ngs/ops/device/device_ops.h"
#include "ngs/ops/losses/loss_cont_kernels.h"

namespace ngs {

double loss_cont(const Exec& exec, const ContinuityInputs& in, double scale, std::vector<float>* gradient) {
  const KnnGraph& graph = in.graph;
  const Rows<const float, 3> colour = in.colour;
  if (gradient) gradient->assign(std::size_t(colour.n) * 3, 0.f);
  if (graph.neighbours == 0) return 0;
  NGS_CHECK(graph.queries() == colour.n && graph.points == colour.n, "loss_cont: the graph must have the same points");
  NGS_CHECK(in.weight.empty() || in.weight.size() == graph.index.size(), "one weight per edge, or none");
  const ContinuityGraph<float> view{graph.indices(), graph.row_begin.data(), graph.edge.data(),
                                    in.weight.empty() ? nullptr : in.weight.data(), colour};
  std::vector<float> term(exec.device_ops ? 0 : std::size_t(colour.n));
  const ContinuityForward<float> forward{view, term.data()};
  const ContinuityBackward<float> backward{
      view, float(scale / double(colour.n)), {gradient ? gradient->data() : nullptr, colour.n}};
  if (exec.device_ops)
    return exec.device_ops->loss.continuity(forward, gradient ? &backward : nullptr) / double(colour.n);
  for_each_index(exec, colour.n, forward);
  if (gradient) for_each_index(exec, colour.n, backward);
  double sum = 0;
  for (const float t : term) sum += double(t);
  return sum / double(colour.n);
}

}  // namespace ngs
