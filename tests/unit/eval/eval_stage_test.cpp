#include "ngs/eval/eval_stage.h"

#include <doctest/doctest.h>

namespace ngs {
namespace {

struct Samples {
  std::vector<std::uint16_t> data;
  int width_px, height_px, channels = 1, bits = 8;
  MaskSamples view() const { return {width_px, height_px, channels, bits, data}; }
};

std::vector<PairScore> evaluate(const Samples& predicted, const Samples& truth, const EvalOptions& options = {},
                                const ObjectIds& ids = {}) {
  return evaluate_pair({}, options, ids, {"view", "", predicted.view(), truth.view()});
}

TEST_CASE("a pixel is object at and above the threshold") {
  const Samples mask{{0, 127, 128, 255}, 4, 1};
  CHECK(binarised(mask.view(), kMaskThreshold) == std::vector<std::uint8_t>{0, 0, 1, 1});
  CHECK(binarised(mask.view(), 1) == std::vector<std::uint8_t>{0, 1, 1, 1});
  const Samples deep{{0, 32895, 32896, 65535}, 4, 1, 1, 16};
  CHECK(binarised(deep.view(), 128) == std::vector<std::uint8_t>{0, 0, 1, 1});
}

TEST_CASE("the prediction is resized to the truth by nearest neighbour") {
  const Samples half{{255, 0}, 2, 1}, full{{255, 255, 0, 0, 255, 255, 0, 0}, 4, 2};
  const auto scores = evaluate(half, full);
  REQUIRE(scores.size() == 1);
  CHECK(scores[0].scores.iou == 1);
  CHECK(scores[0].width_px == 4);
  CHECK(scores[0].predicted_width_px == 2);
}

TEST_CASE("an image without pixels is an error") {
  const Samples none{{}, 0, 0}, one{{255}, 1, 1};
  CHECK_THROWS_AS(evaluate(none, one), Error);
  CHECK_THROWS_AS(evaluate(one, none), Error);
  const Samples lying{{255}, 2, 1};  // fewer samples than the size requires
  CHECK_THROWS_AS(evaluate(lying, one), Error);
}

TEST_CASE("label maps are scored for every id that occurs in either of them") {
  EvalOptions options;
  options.label_map = true;
  const Samples predicted{{0, 3, 3, 7}, 4, 1}, truth{{0, 3, 9, 0}, 4, 1};
  const auto scores = evaluate(predicted, truth, options);
  REQUIRE(scores.size() == 3);
  CHECK(scores[0].object == "3");
  CHECK(scores[0].scores.iou == 0.5);
  CHECK(scores[1].object == "7");
  CHECK(scores[1].scores.one_empty);
  CHECK(scores[2].object == "9");
  CHECK(scores[2].scores.iou == 0);

  const auto chosen = evaluate(predicted, truth, options, parse_object_ids({"leaf=3", "12"}));
  REQUIRE(chosen.size() == 1);
  CHECK(chosen[0].object == "leaf");
}

TEST_CASE("a label map of three equal channels has the ids of its grey values, and colours have their own") {
  const Samples grey{{7, 7, 7, 0, 0, 0, 3, 3, 3}, 3, 1, 3}, colours{{7, 7, 7, 0, 0, 0, 3, 1, 2}, 3, 1, 3};
  CHECK(label_ids(grey.view()) == std::vector<std::uint32_t>{7, 0, 3});
  CHECK(label_ids(colours.view()) == std::vector<std::uint32_t>{7 + 256 * 7 + 65536 * 7, 0, 3 + 256 + 65536 * 2});
  const Samples with_alpha{{7, 7, 7, 255, 0, 0, 0, 255}, 2, 1, 4};
  CHECK(label_ids(with_alpha.view()) == std::vector<std::uint32_t>{7, 0});
}

TEST_CASE("the mask of one object is scored against its id in the true label map") {
  EvalOptions options;
  options.label_map = true;
  const Samples predicted{{255, 255, 0, 0}, 4, 1}, truth{{7, 3, 3, 0}, 4, 1}, empty{{0, 0, 0, 0}, 4, 1};
  const auto score = [&](const Samples& mask, std::uint32_t id) {
    return evaluate_pair({}, options, {}, {"view", "ball", mask.view(), truth.view(), id});
  };
  REQUIRE(score(predicted, 3).size() == 1);
  CHECK(score(predicted, 3)[0].scores.iou == doctest::Approx(1.0 / 3));
  CHECK(score(predicted, 3)[0].object == "ball");
  CHECK(score(predicted, 9)[0].scores.one_empty);
  CHECK(score(empty, 9).empty());
}

TEST_CASE("a prediction of 0 and 255 is the mask of the only object to be scored") {
  EvalOptions options;
  options.label_map = true;
  const Samples mask{{255, 255, 0, 0}, 4, 1}, truth{{7, 3, 3, 0}, 4, 1};
  const auto scores = evaluate(mask, truth, options, parse_object_ids({"ball=3"}));
  REQUIRE(scores.size() == 1);
  CHECK(scores[0].object == "ball");
  CHECK(scores[0].scores.iou == doctest::Approx(1.0 / 3));
  CHECK(evaluate(mask, truth, options).size() == 3);  // 3, 7 and 255: all are ids
  const Samples labels{{0, 3, 255, 0}, 4, 1};
  CHECK(evaluate(labels, truth, options, parse_object_ids({"3"}))[0].scores.iou == 0.5);
}

TEST_CASE("void pixels of the true label map are scored for no object") {
  EvalOptions options;
  options.label_map = true;
  const Samples truth{{3, 3, 255, 255, 0, 7}, 6, 1}, predicted{{3, 0, 3, 9, 0, 255}, 6, 1},
      mask{{255, 0, 255, 0, 0, 0}, 6, 1};
  CHECK(evaluate(predicted, truth, options).size() == 4);  // 3, 7, 9 and 255
  options.void_id = 255;
  const auto scores = evaluate(predicted, truth, options);
  REQUIRE(scores.size() == 2);
  CHECK(scores[0].object == "3");  // 9 was predicted for a void pixel only, and 255 is no object
  CHECK(scores[0].scores.iou == 0.5);
  CHECK(scores[0].scores.counts.tn == 2);
  CHECK(scores[0].scores.void_px == 2);
  CHECK(scores[1].object == "7");
  CHECK(scores[1].scores.one_empty);
  const auto one = evaluate(mask, truth, options, parse_object_ids({"ball=3"}));
  REQUIRE(one.size() == 1);
  CHECK(one[0].scores.iou == 0.5);
  CHECK(evaluate(Samples{{0, 0, 255, 255, 0, 0}, 6, 1}, truth, options, parse_object_ids({"9"})).empty());
}

TEST_CASE("255 besides other ids is reported if it is neither void nor an object") {
  EvalOptions options;
  options.label_map = true;
  const Samples usual{{3, 255, 0, 3}, 4, 1}, two_values{{255, 255, 0, 0}, 4, 1};
  const auto told = [&](const Samples& truth, const ObjectIds& ids) {
    return evaluate(usual, truth, options, ids)[0].truth_has_usual_void;
  };
  CHECK(told(usual, {}));
  CHECK(told(usual, {{3, "ball"}}));
  CHECK_FALSE(told(usual, {{255, "table"}}));
  CHECK_FALSE(told(two_values, {}));
  options.void_id = 255;
  CHECK_FALSE(told(usual, {}));
}

TEST_CASE("label map options without label_map are errors, as is an object id that is void") {
  EvalOptions options;
  CHECK_NOTHROW(require_consistent(options));
  options.void_id = 255;
  CHECK_THROWS_AS(require_consistent(options), Error);
  options.label_map = true;
  options.object_id = {"ball=3"};
  CHECK_NOTHROW(require_consistent(options));
  options.object_id = {"ball=3", "rim=255"};
  CHECK_THROWS_AS(require_consistent(options), Error);
}

TEST_CASE("object ids are numbers of at least 1, with or without a name") {
  CHECK_THROWS_AS(parse_object_ids({"a=1", "b=1"}), Error);  // only b would be scored
  CHECK_THROWS_AS(parse_object_ids({"a=1", "a=2"}), Error);  // two objects in one mean
  CHECK(parse_object_ids({"a=b=4", "7"}) == ObjectIds{{4, "a=b"}, {7, "7"}});
  for (const char* text : {"", "0", "x", "a=", "-3", "4294967296"}) {
    CAPTURE(text);
    CHECK_THROWS_AS(parse_object_ids({text}), Error);
  }
}

PairScore pair_of(const char* object, double iou) {
  PairScore pair;
  pair.object = object;
  pair.scores.iou = iou;
  pair.scores.counts.tp = 1;
  return pair;
}

TEST_CASE("the mean is over objects of their means over views, next to the mean over all pairs") {
  const std::vector<PairScore> pairs{pair_of("a", 1), pair_of("a", 1), pair_of("a", 1), pair_of("b", 0)};
  const EvalSummary summary = summarise(pairs);
  CHECK(summary.mean[0] == 0.5);
  CHECK(summary.mean_over_pairs[0] == 0.75);
  REQUIRE(summary.objects.size() == 2);
  CHECK(summary.objects[0].pairs == 3);
  CHECK(summary.objects[0].counts.tp == 3);
}

TEST_CASE("score checks pass at the bound and fail below it and for NaN") {
  const std::map<std::string, double> found{{"iou", 0.9}, {"biou", 0.5}, {"psnr_db", std::nan("")}};
  const auto checks = check_scores("iou=0.9,boundary_iou=0.6,psnr=20", found);
  REQUIRE(checks.size() == 3);
  CHECK(checks[0].passed());
  CHECK_FALSE(checks[1].passed());
  CHECK_FALSE(checks[2].passed());
  CHECK(check_scores("", found).empty());
  for (const char* rule : {"iou", "iou=", "iou=x", "miou=0.9", "iou=0.9,", "=0.5"}) {
    CAPTURE(rule);
    CHECK_THROWS_AS(check_scores(rule, found), Error);
  }
}

}  // namespace
}  // namespace ngs
