#include "ngs/io/formats/axes.h"

namespace ngs::io {
namespace {

/// Whether the basis function of each coefficient is odd in x, y and z. Degree 1: y z x; degree 2: xy yz zz xz xx-yy;
/// degree 3: y(3xx-yy) xyz y(4zz-..) z(2zz-..) x(4zz-..) z(xx-yy) x(xx-3yy).
struct Parity {
  bool x, y, z;
};
constexpr Parity kOdd[15] = {{false, true, false}, {false, false, true},  {true, false, false}, {true, true, false},
                             {false, true, true},  {false, false, false}, {true, false, true},  {false, false, false},
                             {false, true, false}, {true, true, true},    {false, true, false}, {false, false, true},
                             {true, false, false}, {false, false, true},  {true, false, false}};

}  // namespace

void reverse_axes(SplatRow& row, const AxisSigns& signs) {
  for (std::size_t a = 0; a < 3; ++a) row.position[a] *= signs[a];
  // The axis of a rotation is a pseudovector: its x changes sign with y and z.
  row.rotation[1] *= signs[1] * signs[2];
  row.rotation[2] *= signs[0] * signs[2];
  row.rotation[3] *= signs[0] * signs[1];
  for (std::size_t k = 0; k < 15; ++k) {
    const float sign = (kOdd[k].x ? signs[0] : 1) * (kOdd[k].y ? signs[1] : 1) * (kOdd[k].z ? signs[2] : 1);
    for (std::size_t c = 0; c < 3; ++c) row.sh_rest[k * 3 + c] *= sign;
  }
}

}  // namespace ngs::io
