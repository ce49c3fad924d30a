#include "ngs/io/image/image_codecs.h"

#include "ngs/core/error.h"

#ifdef NGS_LINKED_CODECS
extern "C" const ngs::io::ImageCodecs ngs_image_codecs;  // codecs/opencv_codecs.cpp
#else
#include <dlfcn.h>

#include <string_view>
#endif

namespace ngs::io {
namespace {

#ifdef NGS_LINKED_CODECS
const ImageCodecs& load() { return ngs_image_codecs; }
#else
const ImageCodecs& load() {
  // Found by its bare name through the executable's run path. Never unloaded.
  void* plugin = dlopen("libngs_codecs.so", RTLD_NOW | RTLD_LOCAL);
  void* entry = plugin != nullptr ? dlsym(plugin, "ngs_image_codecs") : nullptr;
  if (entry == nullptr) {
    const char* reason = dlerror();
    const bool is_limited =
        reason != nullptr && std::string_view(reason).find("failed to map") != std::string_view::npos;
    throw Error(ErrorCode::kEnvironment,
                std::string("libngs_codecs.so: ") + (reason != nullptr ? reason : "cannot be loaded") +
                    ", expected the codecs for pictures",
                is_limited ? "memory is limited: see ulimit -v"
                           : "keep it next to the executables and install OpenCV (pipelines/setup.sh)");
  }
  return *static_cast<const ImageCodecs*>(entry);
}
#endif

}  // namespace

const ImageCodecs& image_codecs() {
  static const ImageCodecs& codecs = load();
  return codecs;
}

}  // namespace ngs::io
