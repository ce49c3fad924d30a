// The page of ngs-report, made from a run of the tools on the tiny scene.
#include <doctest/doctest.h>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <regex>

#include "ngs/io/image/image_file.h"
#include "ngs/scene/camera.h"
#include "support/process.h"
#include "support/skip.h"
#include "support/temp_dir.h"
#include "support/tiny_scene.h"

namespace ngs {
namespace {

namespace fs = std::filesystem;

void run_tool(const std::string& folder, std::vector<std::string> argv) {
  test::succeeded(test::run_tool(std::move(argv), folder));
}

/// A run as pipelines/ngs-gs.sh leaves it, as far as the page is concerned.
std::string made_run(const test::TempDir& dir) {
  const std::string scene = dir.path() + "/scene";
  std::string out = dir.path() + "/a <run> & more";
  fs::create_directories(scene);
  test::write_tiny_scene(scene);
  fs::create_directories(out + "/reports");
  fs::create_directories(out + "/masks");
  fs::copy_file(scene + "/masks/v5.png", out + "/masks/v5.png");
  fs::copy(scene + "/masks", scene + "/gt");
  dir.write("scene/scene.json", std::regex_replace(test::read_bytes(scene + "/scene.json"),
                                                   std::regex("\"(model.ply|images/|masks/)"), "\"../scene/$1"));
  fs::copy_file(scene + "/scene.json", out + "/scene.json");
  run_tool(out, {"ngs-eval", scene + "/masks", scene + "/masks", "--views", "every:6:4", "-q", "-o",
                 "metrics_input.json", "--report", "reports/ngs-eval-input.json"});
  run_tool(out, {"ngs-eval", "masks", scene + "/gt", "-q", "-o", "metrics.json", "--report", "reports/ngs-eval.json"});
  dir.write(
      "a <run> & more/reports/ngs-joint.json",
      R"({"tool":"ngs-joint","version":"0.1.0","options":{"method":"bce","steps":5},"inputs":[],"device":{"name":"cpu","reason":"r"},
                "threads":2,"seed":0,"exit_code":7,"stages":{"name":"ngs-joint","wall_s":2.5,"cpu_s":5,"items":0,"items_per_s":0,
                "max_rss_mib":99,"children":[{"name":"label solve","wall_s":2,"items":40,"items_per_s":20,"max_rss_mib":99}]},
                "result":{"effects":[{"name":"cont","mode":"auto","on":false,"reason":"no gain <measured>","measured":0.1,
                "threshold":0.5,"saving":"time"},{"name":"nerf","mode":"on","on":true,"reason":"always","measured":null,
                "threshold":null,"saving":""}]},
                "warnings":["a \"strange\" <mask>"]})");
  dir.write("a <run> & more/reports/ngs-joint.sh", "ngs-joint scene.json --method bce <x>\n");
  dir.write("a <run> & more/trace.jsonl",
            "{\"step\":1,\"t\":0.1,\"loss\":{\"total\":0.5}}\n{\"step\":2,\"t\":0.2,\"loss\":{\"total\":0.25}}\n");
  return out;
}

TEST_CASE("the object alone has a picture for dark mode and one for light mode") {
  const test::TempDir dir;
  const std::string out = made_run(dir);
  fs::copy_file(dir.path() + "/scene/model.ply", out + "/object.ply");
  run_tool(out, {"ngs-report", ".", "-o", "report.html"});
  const std::string page = test::read_bytes(out + "/report.html");
  const std::size_t dark =
      page.find("<picture><source media=\"(prefers-color-scheme:dark)\" srcset=\"data:image/jpeg;");
  REQUIRE(dark != page.npos);
  CHECK(page.find("class=after", dark) != page.npos);
  CHECK(page.find("the object, cut out") != page.npos);
}

TEST_CASE("the page of a run holds every section, lists warnings and loads nothing external") {
  const test::TempDir dir;
  const std::string out = made_run(dir);
  run_tool(out, {"ngs-report", ".", "-o", "report.html"});
  const std::string page = test::read_bytes(out + "/report.html");

  const auto section_at = [&](const std::string& id) { return page.find("<section id=\"" + id + "\">"); };
  for (const char* id : {"overview", "warnings", "accuracy", "views", "view-scores", "objects", "decisions", "times",
                         "trace", "inputs", "repeat", "tools"}) {
    CAPTURE(id);
    CHECK(section_at(id) != page.npos);
  }
  // All but the result is folded once.
  const std::size_t fold = page.find("<details class=made><summary><b>How it was made</b></summary>");
  REQUIRE(fold != page.npos);
  CHECK(test::occurrences(page, "How it was made") == 1);
  for (const char* id : {"overview", "warnings", "views"}) CHECK(section_at(id) < fold);
  for (const char* id : {"accuracy", "decisions", "times", "inputs", "tools", "given"}) CHECK(section_at(id) > fold);
  CHECK(page.find("a &quot;strange&quot; &lt;mask&gt;") != page.npos);
  CHECK(page.find("time budget used up") != page.npos);
  CHECK(page.find("<th scope=row>cont</th><td>off</td><td>no gain &lt;measured&gt;; saves time</td>") != page.npos);
  CHECK(page.find("<th scope=row>nerf</th><td>on</td><td>on: always</td>") != page.npos);
  CHECK(page.find("<title>a &lt;run&gt; &amp; more") != page.npos);
  CHECK(page.find("input masks, same views") != page.npos);
  CHECK(page.find("prefers-color-scheme:dark") != page.npos);

  CHECK(page.find("ngs-joint scene.json --method bce &lt;x&gt;") != page.npos);
  CHECK(test::occurrences(page, "<figure class=flip>") == 2);  // the object alone; input mask and result
  CHECK(test::occurrences(page, "<input type=checkbox checked aria-label=\"Show ") == 2);
  CHECK(page.find("<span class=of-before>the photo</span><span class=of-after>the object alone</span>") != page.npos);

  // The page opens on the object, before any figure of it, and has the given masks of all views.
  CHECK(page.find("<input type=checkbox checked aria-label=\"Show the object alone\">") <
        page.find("<dl class=tiles>"));
  CHECK(page.find("<dt>method</dt><dd>cross-entropy of masks<small>--method bce</small>") != page.npos);
  CHECK(page.find("<section id=\"given\">") != page.npos);
  CHECK(test::occurrences(page, "under its given mask") == 6);

  SUBCASE("no URL, script or external file occurs") {
    CHECK(page.find("http:") == page.npos);
    CHECK(page.find("https:") == page.npos);
    CHECK(page.find("<script") == page.npos);
    CHECK(page.find("<link") == page.npos);
    CHECK(page.find("@import") == page.npos);
    CHECK(test::occurrences(page, "url(") == 0);
    CHECK(test::occurrences(page, "src=") == test::occurrences(page, "src=\"data:image/jpeg;base64,"));
  }
  SUBCASE("scores of views used in training are marked") {
    CHECK(page.find("used in training") == page.npos);
    fs::copy_file(dir.path() + "/scene/masks/v1.png", out + "/masks/v1.png");
    run_tool(out, {"ngs-eval", "masks", dir.path() + "/scene/masks", "-q", "-w", "-o", "metrics.json"});
    run_tool(out, {"ngs-report", ".", "-o", "trained.html"});
    const std::string trained = test::read_bytes(out + "/trained.html");
    CHECK(trained.find("1 held out, 1 of 2 scored were used in training") != trained.npos);
    CHECK(trained.find("1 of 2 scored views were used in training") != trained.npos);
  }
  SUBCASE("input masks used as truth are not called the truth") {
    CHECK(page.find("no ground truth") == page.npos);
    CHECK(page.find("</svg>truth</label>") != page.npos);
    run_tool(out, {"ngs-eval", "masks", dir.path() + "/scene/masks", "-q", "-w", "-o", "metrics.json", "--report",
                   "reports/ngs-eval.json"});
    run_tool(out, {"ngs-report", ".", "-o", "stand-in.html"});
    const std::string stand_in = test::read_bytes(out + "/stand-in.html");
    CHECK(stand_in.find("<dt>IoU</dt><dd>1.000<small>against input masks, no ground truth") != stand_in.npos);
    CHECK(stand_in.find("</svg>input mask (no ground truth)</label>") != stand_in.npos);
    CHECK(stand_in.find("</svg>truth</label>") == stand_in.npos);
    CHECK(stand_in.find("</svg>input mask</label>") == stand_in.npos);
    CHECK(stand_in.find("the true mask") == stand_in.npos);
    CHECK(stand_in.find("<b>scores</b>") == stand_in.npos);  // no warning
    // As ngs cut writes them for a run by strokes.
    fs::rename(out + "/metrics.json", out + "/agreement.json");
    fs::rename(out + "/reports/ngs-eval.json", out + "/reports/ngs-eval-agreement.json");
    run_tool(out, {"ngs-report", ".", "-o", "agreed.html"});
    CHECK(test::read_bytes(out + "/agreed.html").find("<dt>IoU</dt><dd>1.000<small>against input masks") !=
          std::string::npos);
  }
  SUBCASE("a run by strokes shows the marked views, and a splat that cannot be drawn is a warning") {
    CHECK(section_at("marked") == page.npos);
    fs::create_directory(out + "/marked");
    io::write_png(out + "/marked/v2.png", ImageU8(48, 36, 3));
    dir.write("a <run> & more/object.ply", "no splat");
    run_tool(out, {"ngs-report", ".", "-o", "marked.html"});
    const std::string marked = test::read_bytes(out + "/marked.html");
    CHECK(marked.find("<section id=\"marked\">") < marked.find("<section id=\"views\">"));
    CHECK(marked.find("View v2.png with the strokes") != marked.npos);
    CHECK(marked.find("<li><b>report</b>") != marked.npos);
    CHECK(!fs::exists(out + "/marked-object.html"));
  }
  SUBCASE("the first pictures are of the middle view, or of the next one where the object is whole") {
    for (const char* file : {"/metrics.json", "/metrics_input.json", "/reports/ngs-eval.json"}) fs::remove(out + file);
    fs::copy_file(dir.path() + "/scene/masks/v1.png", out + "/masks/v1.png");
    const auto first_view = [&] {
      run_tool(out, {"ngs-report", ".", "-w", "-o", "whole.html"});
      const std::string whole = test::read_bytes(out + "/whole.html");
      return whole.substr(whole.find("alt=\"View ") + 10, 2);
    };
    CHECK(first_view() == "v5");
    ImageU8 cropped(48, 36, 1);
    std::fill_n(cropped.data.begin(), 96, std::uint8_t(255));
    fs::remove(out + "/masks/v5.png");
    io::write_png(out + "/masks/v5.png", cropped);
    CHECK(first_view() == "v1");
  }
  SUBCASE("a page without scores mentions no scores") {
    CHECK(page.find("The view with the median boundary IoU, or the next one") != page.npos);
    for (const char* file : {"/metrics.json", "/metrics_input.json", "/reports/ngs-eval.json"}) fs::remove(out + file);
    run_tool(out, {"ngs-report", ".", "-o", "unscored.html"});
    const std::string unscored = test::read_bytes(out + "/unscored.html");
    CHECK(unscored.find("The middle view of the list, or the next one") != unscored.npos);
    CHECK(unscored.find("median boundary IoU") == unscored.npos);
  }
  SUBCASE("each image has alt text and the outlines of prediction, truth and input") {
    CHECK(test::occurrences(page, "<img ") >= 2);  // the sheet and a crop
    CHECK(test::occurrences(page, "<img ") ==
          test::occurrences(page, "<img alt=\"View") + test::occurrences(page, "<img alt=\"Crop"));
    for (const char* kind : {"predicted", "truth", "input"}) {
      CAPTURE(kind);
      CHECK(test::occurrences(page, std::string("<g class=") + kind + "><path class=casing d=\"M") >=
            3);  // and the legend
    }
  }
  SUBCASE("the page is small, and has the same bytes for the same run") {
    CHECK(page.size() < 5u << 20);
    run_tool(out, {"ngs-report", ".", "-o", "again.html", "-j", "1"});
    CHECK(test::read_bytes(out + "/again.html") == page);
  }
  SUBCASE("images stop at the budget with a note on the page") {
    run_tool(out, {"ngs-report", ".", "--picture-budget", "0", "-o", "bare.html"});
    const std::string bare = test::read_bytes(out + "/bare.html");
    CHECK(test::occurrences(bare, "<img ") == 0);
    CHECK(bare.find("better views are left out") != bare.npos);
  }
  SUBCASE("a small error is in the centre of its crop") {
    const io::RawMask raw = io::read_mask_raw(out + "/masks/v5.png", io::Palette::kMask);
    REQUIRE(raw.width_px == 48);
    ImageU8 mask(48, raw.height_px, 1);
    for (std::size_t p = 0; p < mask.data.size(); ++p) mask.data[p] = std::uint8_t(raw.data[p]);
    mask.data[20 * 48 + 30] ^= 255;  // in the windows from (14, 4) to (30, 19), where the picture ends
    io::write_png(out + "/masks/v5.png", mask);
    run_tool(out, {"ngs-report", ".", "--crop-side", "17", "-o", "crop.html"});
    CHECK(test::read_bytes(out + "/crop.html").find("17×17 px at (22, 11)") != std::string::npos);
  }
  SUBCASE("wrong pixels are shown by cause if the labelled model exists") {
    CHECK(page.find("<section id=\"errors\">") == page.npos);
    const std::string scene = dir.path() + "/scene";
    run_tool(out, {"ngs-variance", "scene.json", "-o", "labelled.ply", "-q"});
    fs::copy_file(scene + "/masks/v4.png", out + "/masks/v5.png", fs::copy_options::overwrite_existing);
    run_tool(out, {"ngs-eval", "masks", scene + "/masks", "-q", "-w", "-o", "metrics.json", "--report",
                   "reports/ngs-eval.json"});
    run_tool(out, {"ngs-report", ".", "-o", "errors.html", "--atlas", "atlas"});
    const std::string errors = test::read_bytes(out + "/errors.html");
    CHECK(errors.find("<section id=\"errors\">") != errors.npos);
    CHECK(errors.find("Wrong pixels of each view by cause") != errors.npos);
    CHECK(fs::is_regular_file(out + "/atlas/v5.png"));
    CHECK(errors.find("<section id=\"boundary\">") != errors.npos);

    // With forty objects the page shows the worst ones with a note, the atlas shows all.
    using Json = nlohmann::json;
    const auto with_objects = [&](const std::string& file, const Json::json_pointer& where) {
      Json json = Json::parse(test::read_bytes(file));
      Json worst;
      for (const Json& view : json[where])
        if (view["view"] == "v5") worst = view;
      json[where] = Json::array();
      for (int k = 0; k < 40; ++k) {
        worst["object"] = "../part" + std::to_string(k);
        json[where].push_back(worst);
      }
      std::ofstream(file) << json;
    };
    with_objects(out + "/metrics.json", Json::json_pointer("/views"));
    with_objects(out + "/reports/ngs-eval.json", Json::json_pointer("/result/files"));
    run_tool(out, {"ngs-report", ".", "-o", "many.html"});
    CHECK(test::read_bytes(out + "/many.html").find("Wrong pixels of the 32 worst views") != std::string::npos);
    run_tool(out, {"ngs-report", ".", "-o", "many.html", "--atlas", "many", "-w"});
    CHECK(std::distance(fs::directory_iterator(out + "/many"), {}) == 40);
    CHECK(test::read_bytes(out + "/many.html").find("Wrong pixels of each view by cause") != std::string::npos);
    CHECK(test::occurrences(errors, "alt=\"View of the boundary set along") == 3);
  }
  SUBCASE("several runs are compared") {
    fs::copy(out, dir.path() + "/second", fs::copy_options::recursive);
    run_tool(dir.path(), {"ngs-report", out, "second", "-o", "both.html"});
    const std::string both = test::read_bytes(dir.path() + "/both.html");
    CHECK(both.find("mean over runs") != both.npos);
    CHECK(both.find("Boundary IoU against time") != both.npos);
    CHECK(test::occurrences(both, "<details class=run>") == 2);
    CHECK(test::occurrences(both, "<section id=\"run2-views\">") == 1);
    CHECK(test::occurrences(both, "<section id=\"views\">") == 0);
    for (const char* parent : {"x", "y"}) {
      fs::create_directories(dir.path() + "/" + parent);
      fs::copy(out, dir.path() + "/" + parent + "/run", fs::copy_options::recursive);
    }
    run_tool(dir.path(), {"ngs-report", "x/run", "y/run", "-o", "named.html"});
    const std::string named = test::read_bytes(dir.path() + "/named.html");
    CHECK(test::occurrences(named, "<summary><b>y/run</b>") == 1);
  }
}

/// What Chromium says of the page in a frame of the given width: "scroll WIDTH of WIDTH".
std::string widths_in_browser(const test::TempDir& dir, const std::string& page, int width_px) {
  dir.write("frame.html", "<body><iframe id=f width=" + std::to_string(width_px) + " height=800 src=\"" + page +
                              "\"></iframe><script>onload=()=>{const d=f.contentDocument.documentElement;"
                              "document.body.append('scroll '+d.scrollWidth+' of '+d.clientWidth)}</script>");
  const test::ProcessResult result =
      test::run_process({.argv = {"chromium", "--headless", "--no-sandbox", "--disable-gpu",
                                  "--allow-file-access-from-files", "--user-data-dir=" + dir.path() + "/profile",
                                  "--virtual-time-budget=2000", "--dump-dom", "file://" + dir.path() + "/frame.html"},
                         .folder = dir.path()});
  const std::size_t at = result.out.rfind("scroll ");
  return result.exit_code != 0 || at == result.out.npos ? result.err
                                                        : result.out.substr(at, result.out.find('<', at) - at);
}

TEST_CASE("the page needs no sideways scrolling on a phone or a desk") {
  if (!fs::exists("/usr/bin/chromium")) return test::skip("no /usr/bin/chromium");
  const test::TempDir dir;
  const std::string out = made_run(dir);
  run_tool(out, {"ngs-report", ".", "-o", "../page.html"});
  for (const int width : {390, 1280}) {
    const std::string found = widths_in_browser(dir, "page.html", width);
    const std::string inner = found.substr(found.rfind(' ') + 1);
    INFO(width << ": " << found);
    CHECK(found == "scroll " + inner + " of " + inner);
    CHECK(std::abs(std::atoi(inner.c_str()) - width) < 30);
  }
}

}  // namespace
}  // namespace ngs
