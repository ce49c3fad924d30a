#include "step_files.h"

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "ngs/core/error.h"
#include "ngs/core/parse_number.h"
#include "ngs/io/files/safetensors.h"

namespace ngs::joint {
namespace {

[[noreturn]] void throw_other_run(const std::string& path) {
  throw Error(ErrorCode::kInconsistent, path + ": the checkpoint of a run with other inputs, options or effects",
              "use the same inputs and options, or another --checkpoint folder");
}

/// A checkpoint has more decisions on effects than are known so far: the first ones must agree.
bool begins_with(const Json& effects, const Json& known) {
  return effects.is_array() && effects.size() >= known.size() &&
         std::equal(known.begin(), known.end(), effects.begin());
}

bool has_all(const Json& run, const Json& known) {
  if (!run.is_object()) return false;
  for (const auto& [key, value] : known.items())
    if (!run.contains(key) || !(key == "effects" ? begins_with(run[key], value) : run[key] == value)) return false;
  return true;
}

/// Gaussians that are not trained keep their input values, which need not be finite.
void check_finite(const std::string& path, const StateBlock& block, const std::vector<float>& values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    if (!std::isfinite(values[i]) && (i >= block.values->size() || std::isfinite((*block.values)[i])))
      throw Error(ErrorCode::kBadInput,
                  path + ": '" + block.name + "' has a value that is not finite, expected finite numbers",
                  "delete the checkpoint");
}

std::int64_t step_in(const std::string& path, const std::string& text, std::int64_t planned) {
  std::int64_t step = -1;
  if (!parse_number(text, step) || step < 0 || step > planned)
    throw Error(ErrorCode::kBadInput,
                path + ": 'step' is '" + text + "', expected a whole number from 0 to " + std::to_string(planned),
                "delete the checkpoint");
  return step;
}

}  // namespace

std::string StepFile::path_in(const std::string& folder) {
  return (std::filesystem::path(folder) / "checkpoint.safetensors").generic_string();
}

const std::optional<Json>& StepFile::resumed(const Json& known) {
  if (!previous_ && setup_.resume && std::filesystem::exists(path()))
    previous_ = Json::parse(io::read_safetensors(path()).meta("run"), nullptr, false);
  if (previous_ && !has_all(*previous_, known)) throw_other_run(path());
  return previous_;
}

void StepFile::save(JointTrainer& trainer) {
  io::TensorFile file;
  for (const StateBlock& block : trainer.state())
    file.add(block.name, {std::int64_t(block.values->size())}, *block.values);
  file.metadata["ngs:schema"] = "ngs.checkpoint.1";
  file.metadata["step"] = std::to_string(trainer.steps_done());
  file.metadata["run"] = identity_;
  io::write_safetensors(path(), file);
}

void StepFile::try_save(JointTrainer& trainer) {
  checkpoints_.write_during_run(trainer.steps_done(), [&] { save(trainer); });
}

void StepFile::steps_running(bool begins) {
  if (begins)
    grace_.emplace();
  else
    grace_.reset();
}

bool StepFile::load(JointTrainer& trainer) {
  if (!setup_.resume || !std::filesystem::exists(path())) return false;
  const io::TensorFile file = io::read_safetensors(path());
  if (file.meta("run") != identity_) throw_other_run(path());
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

}  // namespace ngs::joint
