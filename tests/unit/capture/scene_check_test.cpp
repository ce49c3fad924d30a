#include "ngs/capture/scene_check.h"

#include <doctest/doctest.h>

#include <algorithm>
#include <cmath>

#include "ngs/capture/view_shares.h"
#include "ngs/core/error.h"
#include "ngs/math/quat.h"
#include "ngs/math/sh.h"
#include "support/checked_capture.h"

namespace ngs {
namespace {

using test::Capture;
using test::thrown_by;
using test::tiny_capture;

}  // namespace

TEST_CASE("a scene whose model matches its photos passes, and the unknown background is fitted") {
  const Capture capture = tiny_capture();
  const SceneCheck result = capture.check();
  CHECK(result.warnings.empty());
  CHECK(result.median_psnr_db > 60);  // the photos are the model
  int compared = 0;
  for (const ViewCheck& view : result.views) {
    CHECK(view.in_front == 1);
    CHECK(view.inside > 0.5);
    REQUIRE(view.masks);
    CHECK(view.masks->coverage[0] > 0.02);
    if (!view.match) continue;
    ++compared;
    if (view.match->covered > 0.99) continue;
    CHECK(view.match->background.y == doctest::Approx(0.9).epsilon(1e-3));
  }
  CHECK(compared == 4);
  CHECK(result.objects[0].views == 6);
}

TEST_CASE("the second filter is tried only if the first does not match the photos well enough") {
  Capture capture = tiny_capture();
  for (std::size_t v = 0; v < capture.photos.size(); ++v) {
    RenderRequest request{.label = {}, .background = {0.2f, 0.9f, 0.4f}};
    const Camera& camera = capture.scene.views[v].camera;
    capture.photos[v] = render({}, capture.cloud, camera, {.blur_px2 = 0.075}, request).colour;
  }
  SceneCheckOptions options;
  const double first_db = capture.check(options).median_fit_db;
  CHECK(first_db > options.min_fit_db + 3);
  CHECK(first_db < 40);
  options.min_fit_db = first_db - 2;
  CHECK(capture.check(options).median_fit_db > 60);  // by the filter of the photos
}

TEST_CASE("the numbers do not depend on the thread count") {
  const Capture capture = tiny_capture();
  const SceneCheck one = capture.check({}, 1), many = capture.check({}, 3);
  CHECK(one.median_psnr_db == many.median_psnr_db);
  CHECK(one.median_inside == many.median_inside);
}

TEST_CASE("common mistakes in pose files are errors that name the mistake") {
  const Capture good = tiny_capture();
  const auto refused = [&](const std::string& hint, const std::function<Camera(Camera)>& spoil) {
    CAPTURE(hint);
    Capture bad = good;
    for (SceneView& view : bad.scene.views) view.camera = spoil(view.camera);
    test::refused([&] { bad.check(); }, ErrorCode::kInconsistent, "", hint);
  };
  refused("poses are camera-to-world:", [](Camera c) {
    const Vec3<double> centre = c.centre();
    c.rotation = transpose(c.rotation);
    c.translation = centre;
    return c;
  });
  refused("camera axes are OpenGL's", [](Camera c) {
    for (int i = 3; i < 9; ++i) c.rotation.m[i] = -c.rotation.m[i];
    c.translation = {c.translation.x, -c.translation.y, -c.translation.z};
    return c;
  });
  refused("the translation is the camera's centre", [](Camera c) {
    c.translation = c.centre();
    return c;
  });
  refused("quaternions are stored as x y z w", [](Camera c) {
    const Vec4<double> q = quaternion_of(c.rotation);  // w x y z
    c.rotation = rotation_matrix(Vec4<double>{q.y, q.z, q.w, q.x});
    return c;
  });
  refused("the cameras' world is 1000 times the model's", [](Camera c) {
    c.translation = 1000.0 * c.translation;
    return c;
  });
  refused("the focal length is twice the right one", [](Camera c) {
    c.fx *= 2;
    c.fy *= 2;
    return c;
  });
  refused("the principal point is wrong", [](Camera c) {
    c.cx = c.cy = 0;
    return c;
  });
}

TEST_CASE("wrong poses without a known mistake are an error without a guess") {
  Capture bad = tiny_capture();
  for (SceneView& view : bad.scene.views) view.camera.translation = 4.0 * view.camera.translation;
  test::refused([&] { bad.check(); }, ErrorCode::kInconsistent, "", "another scene or other poses");
}

TEST_CASE(
    "a splat whose columns hold other values than those of 3DGS is named, also if it fits, and so is a part of one") {
  Capture good = tiny_capture();
  for (std::size_t i = 0; i < good.cloud.usable.size(); ++i) {  // needles in all directions
    good.cloud.log_scale[3 * i] += 1.5f;
    for (std::size_t k = 0; k < 4; ++k) good.cloud.rotation[4 * i + k] = float(1 + (i * (k + 3)) % 7) - 3.5f;
  }
  RenderRequest request{.label = {}, .background = {0.2f, 0.9f, 0.4f}};
  for (std::size_t v = 0; v < good.photos.size(); ++v)
    good.photos[v] = render({}, good.cloud, good.scene.views[v].camera, {}, request).colour;
  const auto said = [&](const std::function<void(GaussianCloud&)>& spoil, double min_fit_db) {
    Capture bad = good;
    spoil(bad.cloud);
    try {
      const std::vector<std::string> warnings = bad.check({.min_fit_db = min_fit_db}).warnings;
      return warnings.empty() ? std::string() : warnings[0];
    } catch (const Error& error) {
      return error.remedy();
    }
  };
  const auto contains = [](const std::string& text, const char* part) { return text.find(part) != std::string::npos; };
  const auto xyzw = [](GaussianCloud& cloud) {
    for (std::size_t i = 0; i < cloud.rotation.size(); i += 4)
      std::rotate(&cloud.rotation[i], &cloud.rotation[i] + 1, &cloud.rotation[i] + 4);
  };
  CHECK(said([](GaussianCloud&) {}, 3).empty());
  CHECK(contains(said(xyzw, -100), "the model explains the photos better if rot_0 to rot_3 of the splat hold x y z w"));
  CHECK(contains(said(xyzw, 30), "it fits if rot_0 to rot_3 of the splat hold x y z w"));
  const auto colours = [](GaussianCloud& cloud) {
    for (float& c : cloud.sh_dc) c = float(colour_of_dc(c));
  };
  CHECK(contains(said(colours, 10), "it fits if f_dc_0 to f_dc_2 of the splat are colours"));
  const auto rescaled = [](GaussianCloud& cloud) {
    for (float& s : cloud.log_scale) s *= 2;
  };
  CHECK(contains(said(rescaled, 30), "it fits if scale_* of the splat are logarithms of variances"));
  const auto opacities = [](GaussianCloud& cloud) {
    for (float& v : cloud.logit_opacity) v = 1 / (1 + std::exp(-v));
  };
  CHECK(contains(said(opacities, 30), "it fits if opacity of the splat is in 0..1, not a logit"));
  const auto part = [](GaussianCloud& cloud) {
    for (std::size_t i = 150; i < cloud.logit_opacity.size(); ++i) cloud.logit_opacity[i] = -20;
  };
  CHECK_MESSAGE(contains(said(part, 8), "of the photos and fits them there: if it is a part of the scene"),
                said(part, 8));
}

TEST_CASE("masks that are boxes, or have noise, are named") {
  Capture capture = tiny_capture();
  const auto change = [&](const std::function<bool(int x, int y, bool was)>& object) {
    for (ViewMasks& masks : capture.masks)
      for (int i = 0; i < masks.width_px * masks.height_px; ++i) {
        float& m = masks.target[0][std::size_t(i)];
        m = object(i % masks.width_px, i / masks.width_px, m > 0.5f) ? 1.f : 0.f;
      }
  };
  CHECK(capture.check().warnings.empty());
  change([](int x, int y, bool was) { return (31 * x + 17 * y) % 41 == 0 ? !was : was; });
  CHECK(capture.check().warnings.at(0).find("of the pixels of its masks differ from all their neighbours: noise") !=
        std::string::npos);
  change([](int x, int y, bool) { return x >= 12 && x < 30 && y >= 8 && y < 24; });
  CHECK(capture.check().warnings.at(0).find("all its masks are upright rectangles") != std::string::npos);
  CHECK(capture.check().warnings.at(0).find("\"boxes\": [[12, 8, 30, 24]]") != std::string::npos);
}

TEST_CASE("objects with the same masks are named") {
  Capture capture = tiny_capture();
  capture.scene.objects.push_back({"again", 2});
  for (ViewMasks& masks : capture.masks) masks.target.push_back(masks.target[0]);
  CHECK(capture.check().warnings.at(0) == "objects " + capture.scene.objects[0].name +
                                              ", again: their masks are the same; to cut one: --object-id " +
                                              capture.scene.objects[0].name);
  capture.masks[2].target[1][0] = 1;
  CHECK(capture.check().warnings.empty());
}

TEST_CASE("photos in other colours than the model's are an error about colours, and --min-fit-db accepts them") {
  Capture other = tiny_capture();
  for (ImageF& photo : other.photos)
    for (float& v : photo.data) v = 0.5f + 0.3f * v;
  const Error error = test::refused([&] { other.check(); }, ErrorCode::kInconsistent, "");
  CHECK(error.remedy().find("the poses fit, the colours do not") == 0);
  CHECK(other.check({.min_fit_db = -100}).median_fit_db < 3);
}

TEST_CASE("photos that are turned, mirrored, of the next views, plain or with exchanged channels are named") {
  const Capture good = tiny_capture();
  const auto refused = [&](const std::string& hint, const std::function<void(std::vector<ImageF>&)>& spoil) {
    CAPTURE(hint);
    Capture bad = good;
    spoil(bad.photos);
    const Error error = thrown_by([&] { bad.check({.min_fit_db = 20}); });  // the next view of the ball is much alike
    CHECK(error.code() == ErrorCode::kInconsistent);
    CHECK_MESSAGE(error.remedy().find(hint) != std::string::npos, error.remedy());
  };
  const auto each = [](const std::function<void(ImageF&, const ImageF&)>& change) {
    return [change](std::vector<ImageF>& photos) {
      for (ImageF& photo : photos) change(photo, ImageF(photo));
    };
  };
  refused("the photos are turned by 180 degrees", each([](ImageF& photo, const ImageF& from) {
            for (std::size_t i = 0; i < from.data.size(); ++i)
              photo.data[i] = from.data[from.data.size() - 3 - i / 3 * 3 + i % 3];
          }));
  refused("the photos are mirrored", each([](ImageF& photo, const ImageF& from) {
            const std::size_t row = 3 * std::size_t(from.width_px);
            for (std::size_t i = 0; i < from.data.size(); ++i)
              photo.data[i] = from.data[i / row * row + row - 3 - i % row / 3 * 3 + i % 3];
          }));
  refused("one colour each", each([](ImageF& photo, const ImageF&) { std::ranges::fill(photo.data, 0.f); }));
  refused("red and blue of the photos are exchanged", each([](ImageF& photo, const ImageF& from) {
            for (std::size_t i = 0; i < from.data.size(); ++i) photo.data[i] = from.data[i / 3 * 3 + 2 - i % 3];
          }));
  refused("those of the next views",
          [](std::vector<ImageF>& photos) { std::rotate(photos.begin(), photos.begin() + 1, photos.end()); });
}

TEST_CASE("one photo that does not match is a warning with the name of its view") {
  Capture capture = tiny_capture();
  for (float& v : capture.photos[2].data) v = 1 - v;
  const SceneCheck result = capture.check({.check_views = 6});
  REQUIRE(result.warnings.size() == 1);
  CHECK(result.warnings[0].find("view v2.png: the model explains its photo only") == 0);
}

TEST_CASE("without photos the fraction of Gaussians in view is checked") {
  Capture capture = tiny_capture();
  SceneCheckOptions options{.check_views = 0};
  CHECK_NOTHROW(capture.check(options));
  for (SceneView& view : capture.scene.views) view.camera.translation.z = -100;
  test::refused([&] { capture.check(options); }, ErrorCode::kInconsistent, "0 % of the Gaussians lie inside");
}

TEST_CASE("a comparison at reduced size keeps model and photo aligned") {
  Capture capture = tiny_capture();
  SceneCheckOptions options;
  options.check_size_px = 24;  // blocks of 2 divide 48 x 36
  const double even = capture.check(options).median_fit_db;
  options.check_size_px = 16;  // blocks of 3 do too
  const double third = capture.check(options).median_fit_db;
  for (SceneView& view : capture.scene.views) view.camera.cx += 2;  // the effect of a shift by less than a block
  CHECK(even > third);
  CHECK(third > 5);
  CHECK(capture.check(options).median_fit_db < third - 1);
}

TEST_CASE("a model without a usable Gaussian is kNothingFound") {
  Capture capture = tiny_capture();
  capture.cloud.usable.assign(capture.cloud.usable.size(), 0);
  CHECK(thrown_by([&] { capture.check(); }).code() == ErrorCode::kNothingFound);
  capture.cloud = {};
  CHECK(thrown_by([&] { capture.check(); }).code() == ErrorCode::kNothingFound);
}

TEST_CASE("for a scene without a model only masks are checked") {
  const Capture capture = tiny_capture();
  const SceneCheck result = check_scene({}, test::Quiet(), {}, {nullptr, capture.scene, capture.loaders()});
  CHECK(result.sampled_gaussians == 0);
  CHECK(result.objects[0].views == 6);
}

TEST_CASE("masks that are all empty or all full are an error, some are not") {
  Capture capture = tiny_capture();
  const auto set = [&](std::size_t view, float value) {
    capture.masks[view].target[0].assign(capture.masks[view].target[0].size(), value);
  };
  set(0, 0);
  CHECK(capture.check().objects[0].empty == 1);
  set(0, 1);
  CHECK(capture.check().warnings.at(0) == "object ball: 1 of 6 masks are full");
  for (std::size_t i = 0; i < 6; ++i) set(i, 0);
  CHECK(std::string(thrown_by([&] { capture.check(); }).what()).find("all its 6 masks are empty") != std::string::npos);
  for (std::size_t i = 0; i < 6; ++i) set(i, 1);
  test::refused([&] { capture.check(); }, ErrorCode::kInconsistent, "", "--mask-invert");
}

TEST_CASE("masks that cover the images' borders are an error, unless declared inverted or allowed") {
  Capture capture = tiny_capture();
  for (ViewMasks& masks : capture.masks)
    for (float& m : masks.target[0]) m = 1 - m;
  test::refused([&] { capture.check(); }, ErrorCode::kInconsistent, "", "use --mask-invert");
  const std::vector<std::string> warnings = capture.check({.check_polarity = false}).warnings;
  CHECK((warnings.size() == 1 && warnings[0].find("use --mask-invert") != std::string::npos));
  capture.scene.mask_invert = true;
  CHECK(capture.check().warnings.at(0).find("leave --mask-invert out") != std::string::npos);
  capture.scene.mask_invert = false;
  capture.scene.mask_mode = MaskMode::kLabel;  // label maps cannot be inverted
  CHECK(capture.check().warnings.at(0).find("--object-id") != std::string::npos);
  CHECK(capture.check().warnings.at(0).find("--mask-invert") == std::string::npos);
}

TEST_CASE("a ring along the borders is the background of an object that fills more than half of the image") {
  Capture capture = tiny_capture();
  for (ViewMasks& masks : capture.masks)
    for (int i = 0; i < masks.width_px * masks.height_px; ++i) {
      const int x = i % masks.width_px, y = i / masks.width_px;
      masks.target[0][std::size_t(i)] = x < 4 || y < 4 || x > masks.width_px - 5 || y > masks.height_px - 5;
    }
  test::refused([&] { capture.check(); }, ErrorCode::kInconsistent, "nearly all borders", "if a frame was drawn");
}

TEST_CASE(
    "an empty or full mask is contradicted if the other masks show something else there, not if the view misses it") {
  Capture capture = tiny_capture();
  const auto clear = [&](std::size_t view) { std::ranges::fill(capture.masks[view].target[0], 0.f); };
  CHECK(capture.check().uniform_masks.views.empty());
  for (const std::size_t lost : {1u, 2u, 4u}) clear(lost);
  const SceneCheck result = capture.check();
  CHECK(result.uniform_masks.contradicted == std::vector<std::size_t>{1, 2, 4});
  CHECK(result.uniform_masks.agreement > 0.8);
  REQUIRE(result.warnings.size() == 1);
  CHECK(result.warnings[0].find("3 of 6 masks are empty where the other masks show the object (") == 0);
  CHECK(capture.check({}, 3).uniform_masks.contradicted == result.uniform_masks.contradicted);
  capture.scene.missing_mask = MissingMask::kEmpty;  // views without a mask mean an empty mask
  CHECK(capture.check().uniform_masks.contradicted.empty());
  capture.scene.missing_mask = MissingMask::kUnknown;
  std::ranges::fill(capture.masks[4].target[0], 1.f);
  const SceneCheck with_full = capture.check();
  CHECK(with_full.uniform_masks.contradicted == std::vector<std::size_t>{1, 2, 4});
  CHECK(with_full.warnings.at(1).find("3 of 6 masks are empty or full where the other masks are not (") == 0);
  Camera& near = capture.scene.views[4].camera;  // its picture shows the ball alone
  near.fx *= 20;
  near.fy *= 20;
  CHECK(capture.check({.check_views = 0}).uniform_masks.contradicted == std::vector<std::size_t>{1, 2});
  near.fx /= 20;
  near.fy /= 20;
  clear(4);
  Camera& away = capture.scene.views[1].camera;  // looks past the object
  away.cx += 10 * away.width_px;
  CHECK(capture.check({.check_views = 0}).uniform_masks.contradicted == std::vector<std::size_t>{2, 4});
}

TEST_CASE("coverage counts known pixels only") {
  Capture capture = tiny_capture();
  ViewMasks& masks = capture.masks[1];
  masks.target[0].assign(masks.target[0].size(), 0.f);
  masks.known.assign(masks.target[0].size(), 0);
  for (std::size_t i = 0; i < 8; ++i) {
    masks.known[i] = 1;
    masks.target[0][i] = i < 2 ? 1.f : 0.f;
  }
  const SceneCheck result = capture.check();
  CHECK(result.views[1].masks->coverage[0] == 0.25);
  CHECK(result.views[1].masks->known == 8.0 / double(masks.known.size()));
}

TEST_CASE("masks of held-out views are never loaded") {
  Capture capture = tiny_capture();
  capture.scene.views[3].split = Split::kHeldOut;
  SceneLoaders loaders = capture.loaders();
  loaders.masks = [&](std::size_t view) {
    CHECK(view != 3);
    return MaskSample{capture.masks[view], {}, false};
  };
  const SceneCheck result = check_scene({}, test::Quiet(), {}, {&capture.cloud, capture.scene, loaders});
  CHECK(result.objects[0].views == 5);
  CHECK_FALSE(result.views[3].masks);
}

TEST_CASE("notes about many masks become one warning, as do JPEG masks") {
  const Capture capture = tiny_capture();
  SceneLoaders loaders = capture.loaders();
  loaders.masks = [&](std::size_t view) {
    return MaskSample{capture.masks[view], {"m" + std::to_string(view) + ": resized"}, true};
  };
  const SceneCheck result = check_scene({}, test::Quiet(), {}, {&capture.cloud, capture.scene, loaders});
  REQUIRE(result.warnings.size() == 2);
  CHECK(result.warnings[0] == "6 masks: JPEG, compression moves the contours (use PNG) (first: mask)");
  CHECK(result.warnings[1] == "6 masks: resized (first: m0)");
}

TEST_CASE("evenly spaced indices are the middles of equal parts, at most n of them") {
  CHECK(evenly_spaced(4, 21) == std::vector<std::size_t>{2, 7, 13, 18});
  CHECK(evenly_spaced(1, 1) == std::vector<std::size_t>{0});
  CHECK(evenly_spaced(5, 3) == std::vector<std::size_t>{0, 1, 2});
  CHECK(evenly_spaced(0, 3).empty());
  CHECK(evenly_spaced(3, 0).empty());
}

}  // namespace ngs
