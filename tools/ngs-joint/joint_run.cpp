#include "joint_run.h"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <filesystem>

#include "ngs/io/files/safetensors.h"
#include "ngs/options/name_of.h"
#include "ngs/stages/masks/mask_pair.h"
#include "ngs/stages/fit/photo_refit.h"
#include "ngs/stages/render/render_stage.h"

namespace ngs::joint {
namespace {

std::optional<double> number_before(std::string_view text, std::string_view& rest) {
  double value = 0;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  rest = text.substr(std::size_t(stop - text.data()));
  return value;
}

[[noreturn]] void refuse_other_run(const std::string& path) {
  throw Error(ErrorCode::kInconsistent, path + ": the checkpoint of a run with other inputs, options or effects",
              "use the same inputs and options, or another --checkpoint folder");
}

/// Of effects a run has decided more than are known: the first ones have to be the same.
bool begins_with(const Json& effects, const Json& known) {
  return effects.is_array() && effects.size() >= known.size() && std::equal(known.begin(), known.end(), effects.begin());
}

bool has_all(const Json& run, const Json& known) {
  if (!run.is_object()) return false;
  for (const auto& [key, value] : known.items())
    if (!run.contains(key) || !(key == "effects" ? begins_with(run[key], value) : run[key] == value)) return false;
  return true;
}

/// Gaussians that take no part keep the numbers they came with, finite or not.
void check_finite(const std::string& path, const StateBlock& block, const std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) && (i >= block.values->size() || std::isfinite((*block.values)[i])))
      throw Error(ErrorCode::kBadInput, path + ": '" + block.name + "' has a value that is not finite, expected numbers",
                  "delete the checkpoint");
}

std::int64_t step_in(const std::string& path, const std::string& text, std::int64_t planned) {
  std::int64_t step = -1;
  const auto [stop, error] = std::from_chars(text.data(), text.data() + text.size(), step);
  if (error != std::errc() || stop != text.data() + text.size() || step < 0 || step > planned)
    throw Error(ErrorCode::kBadInput,
                path + ": 'step' is '" + text + "', expected a whole number from 0 to " + std::to_string(planned),
                "delete the checkpoint");
  return step;
}

}  // namespace

std::string method_name(Method method) { return name_of(kMethodNames, method); }

std::optional<double> parse_budget(const std::string& text) {
  if (text.empty()) return std::nullopt;
  std::string_view unit;
  const std::optional<double> value = number_before(text, unit);
  const double seconds = unit == "m" ? 60 : unit == "h" ? 3600 : 1;
  if (!value || !(*value > 0) || !(unit.empty() || unit == "s" || unit == "m" || unit == "h"))
    throw Error(ErrorCode::kUsage, "--time-budget: '" + text + "', expected a time such as 60s, 5m or 1h");
  return *value * seconds;
}

std::optional<Target> parse_target(const std::string& text) {
  if (text.empty()) return std::nullopt;
  const bool boundary = text.starts_with("biou=");
  std::string_view rest = "x";
  std::optional<double> value;
  if (boundary || text.starts_with("iou="))
    value = number_before(std::string_view(text).substr(text.find('=') + 1), rest);
  if (!value || !rest.empty() || *value < 0 || *value > 1)
    throw Error(ErrorCode::kUsage, "--target: '" + text + "', expected biou=X or iou=X with X in [0, 1]");
  return Target{boundary, *value};
}

std::vector<Agreement> training_agreement(const Exec& exec, const Problem& input,
                                          const Solution& result) {
  const std::size_t objects = result.labels.size();
  const LabelChannels channels(result.cloud, result.labels);
  std::vector<Agreement> views;
  for (const std::size_t view : input.views) {
    const ViewMasks masks = input.load_masks(view);
    if (!masks.available) continue;
    const ImageF label = channels.view(exec, input.scene.views[view].camera, input.splat);
    Agreement sum;
    for (std::size_t k = 0; k < objects; ++k) {
      const MaskPair pair(label, masks, k);
      sum.iou += iou(pair.counts(exec)), sum.biou += pair.biou(exec);
    }
    views.push_back({sum.iou / double(objects), sum.biou / double(objects)});
  }
  return views;
}

Agreement mean_agreement(const std::vector<Agreement>& views) {
  Agreement sum;
  for (const Agreement& view : views) sum.iou += view.iou, sum.biou += view.biou;
  const double count = std::max<double>(1, double(views.size()));
  return {sum.iou / count, sum.biou / count};
}

std::string Checkpoint::path_in(const std::string& folder) {
  return (std::filesystem::path(folder) / "checkpoint.safetensors").string();
}

std::optional<FloaterPlan> Checkpoint::floaters_in(const std::string& folder, const Json& known) {
  if (folder.empty() || !std::filesystem::exists(path_in(folder))) return std::nullopt;
  const Json run = Json::parse(io::read_safetensors(path_in(folder)).meta("run"), nullptr, false);
  if (!has_all(run, known)) refuse_other_run(path_in(folder));
  const Json plan = run.value("floaters", Json());
  FloaterPlan kept;
  if (!plan.is_object() || !plan.value("draft", Json()).is_boolean() || !plan.value("refit_epochs", Json()).is_number_integer())
    return std::nullopt;
  kept.draft = plan["draft"];
  const auto epochs = plan["refit_epochs"].get<std::int64_t>();
  if (epochs < 0 || epochs > RefitOptions{}.epochs) return std::nullopt;
  kept.refit_epochs = int(epochs);
  return kept;
}

void Checkpoint::save(JointTrainer& trainer) const {
  io::TensorFile file;
  for (const StateBlock& block : trainer.state())
    file.add(block.name, {std::int64_t(block.values->size())}, *block.values);
  file.metadata["ngs:schema"] = "ngs.checkpoint.1";
  file.metadata["step"] = std::to_string(trainer.steps_done());
  file.metadata["run"] = fingerprint_;
  io::write_safetensors(path(), file);
}

bool Checkpoint::load(JointTrainer& trainer) const {
  if (!std::filesystem::exists(path())) return false;
  const io::TensorFile file = io::read_safetensors(path());
  if (file.meta("run") != fingerprint_) refuse_other_run(path());
  const std::int64_t step = step_in(path(), file.meta("step"), trainer.steps_planned());
  for (const StateBlock& block : trainer.state()) {
    std::vector<float> values = file.get<float>(block.name);
    if (!block.fits(values.size()))
      throw Error(ErrorCode::kBadInput,
                  path() + ": '" + block.name + "' has " + std::to_string(values.size()) + " values, expected " +
                      std::to_string(block.size),
                  "delete the checkpoint");
    check_finite(path(), block, values);
    *block.values = std::move(values);
  }
  trainer.resume_at(step);
  return true;
}

void write_nerf(const std::string& path, const JointTrainer& trainer) {
  io::TensorFile file;
  file.metadata["ngs:schema"] = "ngs.nerf.1";
  if (const JointField* field = trainer.field()) {
    const ParamStore& store = field->parameters();
    for (const ParamBlock& block : store.blocks) file.add(block.name, block.shape, store.value_of(block));
    file.add("boundary_row", {trainer.boundary().size()}, trainer.boundary().row);
    char width[32];  // the shortest text that is this number: a fixed point would lose a small world's width
    file.metadata["width"] = std::string(width, std::to_chars(width, std::end(width), field->width()).ptr);
  }
  io::write_safetensors(path, file);
}

}  // namespace ngs::joint
