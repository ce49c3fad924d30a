#include "unused.h"

#include <algorithm>
#include <map>

#include "shared/unused.h"

namespace ngs::joint {
namespace {

class Unused {
 public:
  void flag(const std::string& flag) { text_ += (text_.empty() ? "" : ", ") + flag; }
  void file(const char* name, const std::string& path) {
    if (!path.empty()) flag(name);
  }
  /// The options of a group that differ from their defaults, but for the `used` ones.
  template <class Options>
  void group(Options options, std::initializer_list<std::string_view> used = {}) {
    for (const auto& [name, value] : cli::changed_options(options))
      if (std::find(used.begin(), used.end(), name) == used.end()) flag(option_flag(name));
  }
  const std::string& text() const { return text_; }

 private:
  std::string text_;
};

bool mends(const std::string& entry) {
  const std::string_view name = std::string_view(entry).substr(0, entry.find('='));
  return name == "all" || std::ranges::find(kMendingEffects, name) != std::end(kMendingEffects);
}

void of_the_paper(const Settings& settings, const Paths& paths, Unused& unused) {
  unused.file("--field", paths.field), unused.file("--nerf", paths.nerf), unused.file("--trace", paths.trace);
  unused.group(settings.run, {"method", "background", "objects", "explain", "fast_atomics"});
  unused.group(settings.joint, {"effect", "quality"});
  const auto& effects = settings.joint.effect;
  if (settings.joint.quality != JointOptions{}.quality && mode_of("floaters", effects) != EffectMode::kOn)
    unused.flag("--quality");  // it says how thoroughly floaters are searched
  for (const std::string& entry : effects)
    if (!mends(entry)) unused.flag("--effect " + entry);
  unused.group(settings.edge), unused.group(settings.sample), unused.group(settings.rbf);
}

/// Of which effect an option is, where that is not its group's.
struct OptionOf {
  std::string_view option, effect;
};
constexpr OptionOf kOptionsOf[] = {
    {"hash_levels", "nerf"},        {"hash_features", "nerf"},  {"hash_log2_table", "nerf"}, {"hash_base", "nerf"},
    {"hash_finest", "nerf"},        {"mlp_hidden", "nerf"},     {"mlp_layers", "nerf"},      {"direction_degree", "nerf"},
    {"rate_hash", "nerf"},          {"rate_mlp", "nerf"},       {"rate_feature", "nerf"},    {"width", "nerf"},
    {"width_factor", "nerf"},       {"weight_opacity", "align"}, {"weight_variance", "variance"}, {"excess_variance", "variance"},
    {"lambda_smooth", "smooth"},    {"smooth_points", "smooth"}, {"smooth_step", "smooth"},  {"lambda_cont", "cont"},
    {"lambda_mask", "mask"},        {"mask_loss", "mask"},      {"photometric_weight", "photometric"}, {"steps", "joint"},
    {"start_steps", "joint"},       {"rate_scale", "joint"},    {"rate_literal", "joint"},   {"checkpoint", "joint"},
    {"checkpoint_every", "joint"},  {"resume", "joint"}};
/// What steps and iterations of edges both listen to.
constexpr std::string_view kOfAnyTraining[] = {"lambda_mask", "mask_loss", "photometric_weight", "rate_label", "rate_decay"};

/// Collects, by the effect whose absence makes it so, what is given in vain.
class InVain {
 public:
  explicit InVain(const Decisions& decisions) : decisions_(decisions) {}

  template <class Options>
  void group(const Options& options, std::string_view effect = {}) {
    const bool trains = decisions_.on("joint") || decisions_.on("contours");
    for (const auto& [name, value] : cli::changed_options(options)) {
      const auto own = std::ranges::find(kOptionsOf, name, &OptionOf::option);
      const std::string_view of = own == std::end(kOptionsOf) ? effect : own->effect;
      if (!of.empty() && !decisions_.on(of))
        flags_[of].push_back(option_flag(name));
      else if (!trains && std::ranges::find(kOfAnyTraining, name) != std::end(kOfAnyTraining))
        flags_["joint"].push_back(option_flag(name));
    }
  }
  void warn(cli::Run& run) const {
    for (const auto& [effect, flags] : flags_) cli::warn_unused(run, flags, "with " + std::string(effect) + "=off");
  }

 private:
  const Decisions& decisions_;
  std::map<std::string_view, std::vector<std::string>> flags_;
};

}  // namespace

void warn_unused(cli::Run& run, const Declared& declared, const Decisions& decisions) {
  const Settings& s = declared.settings;
  InVain vain(decisions);
  vain.group(s.run), vain.group(s.joint), vain.group(s.rbf);
  vain.group(s.sample, "nerf"), vain.group(s.edge, "contours");
  vain.warn(run);
}

std::string unused_flags(const Declared& declared, const Paths& paths) {
  Unused unused;
  const Method method = declared.settings.run.method;
  if (method != Method::kPaper) of_the_paper(declared.settings, paths, unused);
  const MethodOptions& o = declared.methods;
  if (method != Method::kFlash) unused.group(o.flash);
  if (method != Method::kSa3d) unused.group(o.sa3d);
  if (method != Method::kBce) unused.group(o.bce);
  if (method != Method::kCob && method != Method::kReleased) unused.group(o.cob);  // released is cob and more
  if (method != Method::kSaga) unused.group(o.saga);
  if (method != Method::kReleased) unused.group(o.released);
  return unused.text();
}

}  // namespace ngs::joint
