#include "ngs/io/image/image_codecs.h"

#include <dlfcn.h>

#include "ngs/core/error.h"

namespace ngs::io {
namespace {

const ImageCodecs& load() {
  // Found by its bare name through the executable's run path. Never unloaded.
  void* plugin = dlopen("libngs_codecs.so", RTLD_NOW | RTLD_LOCAL);
  void* entry = plugin != nullptr ? dlsym(plugin, "ngs_image_codecs") : nullptr;
  if (entry == nullptr) {
    const char* reason = dlerror();
    throw Error(ErrorCode::kEnvironment,
                std::string("libngs_codecs.so: ") + (reason != nullptr ? reason : "cannot be loaded") +
                    ", expected the codecs for pictures",
                "keep it next to the executables and install OpenCV (pipelines/setup.sh)");
  }
  return *static_cast<const ImageCodecs*>(entry);
}

}  // namespace

const ImageCodecs& image_codecs() {
  static const ImageCodecs& codecs = load();
  return codecs;
}

}  // namespace ngs::io
