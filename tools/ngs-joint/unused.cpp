#include "unused.h"

#include <algorithm>

#include "shared/changed_options.h"

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
  unused.group(settings.run, {"method", "background", "objects", "apart", "explain", "fast_atomics"});
  unused.group(settings.joint, {"effect", "quality"});
  const auto& effects = settings.joint.effect;
  if (settings.joint.quality != JointOptions{}.quality && mode_of("floaters", effects) != EffectMode::kOn)
    unused.flag("--quality");  // it says how thoroughly floaters are searched
  for (const std::string& entry : effects)
    if (!mends(entry)) unused.flag("--effect " + entry);
  unused.group(settings.edge), unused.group(settings.sample), unused.group(settings.rbf);
}

}  // namespace

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
