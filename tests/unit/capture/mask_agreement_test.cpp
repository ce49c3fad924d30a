#include "ngs/capture/mask_agreement.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <utility>

#include "support/checked_capture.h"

namespace ngs {
namespace {

using test::Capture;
using Masks = std::vector<ViewMasks>;

MaskAgreement agreement_of(const Capture& capture, int threads = 1) {
  std::vector<std::size_t> views;
  for (std::size_t v = 0; v < capture.scene.views.size(); ++v)
    if (capture.scene.views[v].split == Split::kTrain) views.push_back(v);
  return measure_mask_agreement(Exec{Device::kCpu, threads}, test::Quiet(),
                                {capture.cloud, capture.scene, views, {}, [&](std::size_t view) {
                                   REQUIRE(capture.scene.views[view].split == Split::kTrain);
                                   return capture.masks[view];
                                 }});
}

MaskVerdict verdict_of(const Capture& capture) { return agreement_of(capture).verdict({}); }

/// Pixel (x, y) of every mask is pixel at(x, y) of the right one.
template <class At>
Capture turned(const At& at) {
  Capture capture = test::tiny_capture();
  for (ViewMasks& masks : capture.masks) {
    const std::vector<float> from = masks.target[0];
    for (int y = 0; y < masks.height_px; ++y)
      for (int x = 0; x < masks.width_px; ++x)
        masks.target[0][std::size_t(y * masks.width_px + x)] = from[std::size_t(at(masks, x, y))];
  }
  return capture;
}

/// The capture with cameras that show the ball at other places of the image.
Capture moving_capture(std::size_t views = 6) {
  Capture capture = test::tiny_capture();
  for (std::size_t v = 0; v + 6 < views; ++v) {
    capture.scene.views.push_back(capture.scene.views[v]);
    capture.masks.push_back(capture.masks[v]);
  }
  const int moves_px[] = {-12, 9, -5, 12, 3, -9, 11, -7, 6, -11, 8, -2, -4, 5, 12, -8, 10, 1};
  for (std::size_t v = 0; v < capture.masks.size(); ++v) {
    capture.scene.views[v].camera.cx += moves_px[v];
    ViewMasks& masks = capture.masks[v];
    const std::vector<float> from = std::exchange(masks.target[0], std::vector<float>(masks.target[0].size()));
    for (int y = 0; y < masks.height_px; ++y)
      for (int x = std::max(0, moves_px[v]); x < std::min(masks.width_px, masks.width_px + moves_px[v]); ++x)
        masks.target[0][std::size_t(y * masks.width_px + x)] = from[std::size_t(y * masks.width_px + x - moves_px[v])];
  }
  return capture;
}

/// View v has the mask of view from(v); none if that is no view.
template <class From>
Capture reordered(const From& from, std::size_t views = 6) {
  Capture capture = moving_capture(views);
  const Masks right = capture.masks;
  for (int v = 0; v < int(right.size()); ++v) {
    const int source = from(v);
    if (source < 0 || source >= int(right.size()))
      capture.scene.views[std::size_t(v)].mask_path.clear();
    else
      capture.masks[std::size_t(v)] = right[std::size_t(source)];
  }
  return capture;
}

/// The ball, and a quarter of the wall, as two objects.
Capture two_objects() {
  Capture capture = test::tiny_capture();
  std::vector<float> label(std::size_t(capture.cloud.size()));
  for (std::size_t i = 0; i < label.size(); ++i) label[i] = float(capture.cloud.sh_dc[3 * i] == -1.5f);
  capture.scene.objects = {{"ball", 1}, {"corner", 2}};
  for (std::size_t v = 0; v < capture.masks.size(); ++v) {
    RenderRequest request{.colour = false, .label = {label.data(), capture.cloud.size(), 1}};
    std::vector<float> plane = render({}, capture.cloud, capture.scene.views[v].camera, {}, request).label.data;
    for (float& m : plane) m = m > 0.5f ? 1.f : 0.f;
    capture.masks[v].target.push_back(std::move(plane));
  }
  return capture;
}

}  // namespace

TEST_CASE("right masks fit, with any number of threads, and so do masks of one view") {
  Capture capture = test::tiny_capture();
  const MaskAgreement found = agreement_of(capture), threads = agreement_of(capture, 3);
  CHECK(found.views == 6);
  CHECK(found.given > 0.9);
  CHECK(found.given == threads.given);
  CHECK(found.verdict({}) == MaskVerdict::kFit);
  for (std::size_t v = 1; v < capture.scene.views.size(); ++v) capture.scene.views[v].mask_path.clear();
  CHECK(agreement_of(capture).views == 0);
  CHECK(verdict_of(capture) == MaskVerdict::kFit);
  CHECK(verdict_of(two_objects()) == MaskVerdict::kFit);
  CHECK(verdict_of(moving_capture()) == MaskVerdict::kFit);
}

TEST_CASE("masks that are turned or mirrored are named by the repair that makes them fit") {
  const auto width = [](const ViewMasks& m) { return m.width_px; };
  const std::pair<std::string, Capture> cases[] = {
      {"mirrored", turned([&](const ViewMasks& m, int x, int y) { return y * width(m) + m.width_px - 1 - x; })},
      {"upside down", turned([&](const ViewMasks& m, int x, int y) { return (m.height_px - 1 - y) * width(m) + x; })},
      {"turned by 180 degrees",
       turned([&](const ViewMasks& m, int x, int y) { return (m.height_px - y) * width(m) - 1 - x; })},
      // Turned to the right: the new left column is the old bottom row, squeezed to the size of the photo.
      {"turned by 90 degrees to the right", turned([&](const ViewMasks& m, int x, int y) {
         return (m.height_px - 1 - x * m.height_px / m.width_px) * width(m) + y * m.width_px / m.height_px;
       })},
      {"transposed", turned([&](const ViewMasks& m, int x, int y) {
         return x * m.height_px / m.width_px * width(m) + y * m.width_px / m.height_px;
       })}};
  for (const auto& [of_case, capture] : cases) {
    const std::string mistake = of_case;
    CAPTURE(mistake);
    const MaskAgreement found = agreement_of(capture);
    CAPTURE(found.given);
    REQUIRE(found.verdict({}) == MaskVerdict::kRepairable);
    CHECK(found.repair_that_fits()->repair.mistake == mistake);
    CHECK(found.verdict({.min_mask_agreement = -1}) == MaskVerdict::kFit);
  }
}

TEST_CASE("masks of other views are named by their shift or order, without the masks of held-out views") {
  for (const int shift : {1, -1}) {
    Capture capture = reordered([&](int v) { return v - shift; });
    CAPTURE(shift);
    const MaskAgreement found = agreement_of(capture);
    REQUIRE(found.verdict({}) == MaskVerdict::kRepairable);
    CHECK(found.repair_that_fits()->repair.shift == shift);
    capture.scene.views[3].split = Split::kHeldOut;
    CHECK(agreement_of(capture).views < found.views);
  }
  const MaskAgreement opposite = agreement_of(reordered([](int v) { return 5 - v; }));
  REQUIRE(opposite.repair_that_fits() != nullptr);
  CHECK(opposite.repair_that_fits()->repair.reversed);
  const MaskAgreement half = agreement_of(reordered([](int v) { return 2 * v; }, 18));
  REQUIRE(half.repair_that_fits() != nullptr);
  CHECK(half.repair_that_fits()->repair.stretch == 0.5);
}

TEST_CASE("masks that contradict each other in no usual way are refused below the bound, and taken without one") {
  Capture capture = moving_capture();
  for (std::size_t v = 1; v < capture.masks.size(); v += 2)
    for (float& m : capture.masks[v].target[0]) m = 1 - m;
  const MaskAgreement found = agreement_of(capture);
  CAPTURE(found.given);
  CHECK(found.repair_that_fits() == nullptr);
  CHECK(found.verdict({}) == MaskVerdict::kContradict);
  CHECK(found.verdict({.min_mask_agreement = -1}) == MaskVerdict::kFit);
}

TEST_CASE("single masks that are inverted or mirrored are named with their views, and right ones are not") {
  CHECK(agreement_of(moving_capture()).single.empty());
  Capture capture = moving_capture();
  ViewMasks& mirrored = capture.masks[3];
  for (const std::size_t v : {0, 5})
    for (float& m : capture.masks[v].target[0]) m = 1 - m;
  for (auto row = mirrored.target[0].begin(); row != mirrored.target[0].end(); row += mirrored.width_px)
    std::reverse(row, row + mirrored.width_px);
  const MaskAgreement found = agreement_of(capture);
  CAPTURE(found.given);
  CAPTURE(found.single_after);
  REQUIRE(found.single.size() == 3);
  CHECK(found.single[0].first == 0);
  CHECK(found.single[0].second.mistake == "inverted");
  CHECK(found.single[1].first == 3);
  CHECK(found.single[1].second.mistake == "mirrored");
  CHECK(found.single[2].first == 5);
  for (const std::size_t last : {5, 4}) {  // half of them, most of them: their borders tell which
    capture = moving_capture();
    for (std::size_t v = 0; v < capture.masks.size(); ++v)
      if (v % 2 == 0 || v > last)
        for (float& m : capture.masks[v].target[0]) m = 1 - m;
    CHECK(agreement_of(capture).single.size() == (last == 5 ? 3 : 4));
  }
}

TEST_CASE("single mistakes that cost much are refused, and those of a few masks are not") {
  MaskAgreement found;
  found.views = 16;
  found.single.resize(10);
  found.given = 0.49;
  found.single_after = 0.94;  // bird, masks of every second view inverted
  CHECK(found.verdict({}) == MaskVerdict::kContradict);
  found.given = 0.63;
  found.single_after = 0.84;  // one of six inverted
  CHECK(found.verdict({}) == MaskVerdict::kFit);
}

TEST_CASE("objects whose ids swap from view to view are named, and the objects that keep their ids are not") {
  Capture capture = two_objects();
  capture.scene.objects.push_back({"both", 3});
  for (std::size_t v = 0; v < capture.masks.size(); ++v) {
    auto& planes = capture.masks[v].target;
    planes.push_back(planes[0]);
    for (std::size_t p = 0; p < planes[0].size(); ++p) planes[2][p] = std::max(planes[0][p], planes[1][p]);
    if (v % 2 == 1) std::swap(planes[0], planes[1]);
  }
  const MaskAgreement found = agreement_of(capture);
  CHECK(found.verdict({}) == MaskVerdict::kIdsContradict);
  CHECK(found.low == std::vector<std::size_t>{0, 1});
  CHECK(found.together > 0.9);
}

}  // namespace ngs
