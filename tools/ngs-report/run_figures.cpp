#include "run_figures.h"

#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "shared/page/html.h"

namespace ngs::cli {

double run_seconds(const RunFolder& run) {
  double seconds = 0;
  for (const ToolReport& tool : run.reports) {
    const double wall = number_at(tool.report, {"stages", "wall_s"});
    if (std::isfinite(wall) && !tool.name.starts_with("ngs-eval")) seconds += wall;
  }
  return seconds;
}

std::string method_of(const RunFolder& run) {
  const Json& method = value_at(run.report("ngs-joint"), {"options", "method"});
  return method.is_string() && !method.get<std::string>().empty() ? method.get<std::string>() : "–";
}

std::string method_title(const RunFolder& run) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 8> kTitles = {
      {{"ngs", "NGS"},
       {"ng-gs", "NG-GS"},
       {"flash", "FlashSplat"},
       {"cob", "COB-GS"},
       {"sa3d", "SA3D-GS"},
       {"saga", "SAGA"},
       {"released", "published NG-GS code"},
       {"bce", "cross-entropy of masks"}}};
  std::string name = method_of(run);
  for (const auto& [key, title] : kTitles)
    if (key == name) return std::string(title);
  return name;
}

std::string score_title(std::string_view name) {
  constexpr std::array<std::pair<std::string_view, std::string_view>, 9> kTitles = {
      {{"iou", "IoU"},
       {"accuracy", "accuracy"},
       {"class_accuracy", "class accuracy"},
       {"biou", "B-IoU 2&nbsp;%"},
       {"biou_005", "B-IoU 0.5&nbsp;%"},
       {"biou_1px", "B-IoU 1&nbsp;px"},
       {"biou_3px", "B-IoU 3&nbsp;px"},
       {"biou_5px", "B-IoU 5&nbsp;px"},
       {"contour_f", "contour F"}}};
  for (const auto& [key, title] : kTitles)
    if (key == name) return std::string(title);
  return escaped(name);
}

double mean_over_runs(const std::vector<RunFolder>& runs, std::string_view score) {
  double sum = 0;
  int count = 0;
  for (const RunFolder& run : runs) {
    const double value = number_at(run.metrics, {"mean", score});
    if (std::isfinite(value)) sum += value, ++count;
  }
  return count > 0 ? sum / count : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace ngs::cli
