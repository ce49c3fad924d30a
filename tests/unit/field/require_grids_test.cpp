#include <doctest/doctest.h>

#include <cmath>
#include <functional>

#include "ngs/core/error.h"
#include "ngs/field/joint_field.h"
#include "support/error_code.h"

namespace ngs {
namespace {

/// Two views of 1 x 2 rays with two samples, and one view without rays.
QueryField sampled() {
  QueryField field;
  field.origin = {1, 2, 3};
  for (const char* name : {"a", "b", "c"}) field.views.push_back({name, {}, 1, 2, 2, 3.0});
  for (const std::int32_t view : {0, 2})
    for (std::int32_t slot = 0; slot < 4; ++slot) {
      field.view.push_back(view), field.slot.push_back(slot), field.depth.push_back(2 + 0.1f * float(slot % 2));
      field.position.insert(field.position.end(), {0, 0, 1}), field.uv.insert(field.uv.end(), {4, 5});
    }
  return field;
}

GaussianCloud cloud() {
  GaussianCloud cloud;
  cloud.origin = {1, 2, 3};
  return cloud;
}

void rejected(const std::function<void(QueryField&)>& spoil, ErrorCode code, const char* what) {
  CAPTURE(what);
  QueryField field = sampled();
  spoil(field);
  const Error e = test::thrown_by([&] { require_grids(field, cloud(), "f.ply"); });
  CHECK(e.code() == code);
  CHECK(std::string(e.what()).find(what) != std::string::npos);
}

}  // namespace

TEST_CASE("require_grids accepts a field of ngs-sample, and rejects missing columns, another order or another origin") {
  CHECK_NOTHROW(require_grids(sampled(), cloud(), "f.ply"));
  rejected([](QueryField& f) { f.uv.clear(); }, ErrorCode::kBadInput, "f.ply: no columns u v");
  rejected([](QueryField& f) { f.depth.clear(); }, ErrorCode::kBadInput, "f.ply: no columns depth");
  rejected([](QueryField& f) { f.view.clear(); }, ErrorCode::kBadInput, "f.ply: no columns view");
  rejected([](QueryField& f) { f.slot.clear(); }, ErrorCode::kBadInput, "f.ply: no columns slot");
  rejected([](QueryField& f) { f.origin[1] = 0; }, ErrorCode::kInconsistent, "another origin");
  rejected([](QueryField& f) { std::swap(f.slot[4], f.slot[5]); }, ErrorCode::kBadInput, "row 4 is slot 1 of view 2");
  rejected([](QueryField& f) { std::swap_ranges(f.view.begin(), f.view.begin() + 4, f.view.begin() + 4); },
           ErrorCode::kBadInput, "row 4 is slot 0 of view 0");
  rejected([](QueryField& f) { f.depth[3] = NAN; }, ErrorCode::kBadInput, "row 3 has no pixel or no depth");
  rejected([](QueryField& f) { f.uv[9] = INFINITY; }, ErrorCode::kBadInput, "row 4 has no pixel or no depth");
}

}  // namespace ngs
