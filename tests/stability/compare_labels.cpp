// compare_labels A.ply B.ply: differences between the labels of two labelled copies of one model. Used by float64.sh: A
// is from the float build, B from the double build.
#include <algorithm>
#include <cmath>
#include <cstdio>

#include "ngs/io/ply/gaussian_ply.h"

int main(int count, char** arguments) {
  if (count != 3) return 2;
  const ngs::io::GaussianPly a = ngs::io::read_gaussian_ply(arguments[1]), b = ngs::io::read_gaussian_ply(arguments[2]);
  const std::vector<float>&p = a.labels.label, &q = b.labels.label;
  if (p.empty() || p.size() != q.size()) return 3;
  std::size_t seen = 0, differ = 0, boundary = 0;
  double change = 0, margin = 0, square = 0;
  for (std::size_t i = 0; i < p.size(); ++i) {
    boundary += a.labels.boundary[i] != b.labels.boundary[i];
    if (!(a.labels.views[i] > 0) || !(b.labels.views[i] > 0)) continue;
    const double d = std::abs(double(p[i]) - double(q[i]));
    ++seen, change = std::max(change, d), square += d * d;
    if ((p[i] > 0.5f) == (q[i] > 0.5f)) continue;
    ++differ, margin = std::max(margin, std::abs(double(q[i]) - 0.5));
  }
  std::printf("Gaussians seen %zu; labels that differ %zu (%.4f %%); widest double margin of these %.3g\n", seen,
              differ, 100.0 * double(differ) / double(std::max<std::size_t>(seen, 1)), margin);
  std::printf("largest change of a label %.3g, RMS %.3g; in one boundary set only %zu\n", change,
              std::sqrt(square / double(std::max<std::size_t>(seen, 1))), boundary);
}
