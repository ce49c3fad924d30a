#include "studio.h"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <filesystem>

#include "fields.h"
#include "ngs/core/error.h"
#include "ngs/core/monitor.h"
#include "ngs/io/image/image_file.h"
#include "ngs/io/ply/gaussian_ply.h"
#include "ngs/ops/splat/splat.h"

namespace ngs::studio {
namespace {

ImageU8 to_bytes(const ImageF& image) {
  ImageU8 bytes(image.width_px, image.height_px, image.channels);
  for (std::size_t i = 0; i < bytes.data.size(); ++i)
    bytes.data[i] = std::uint8_t(std::lround(255 * std::clamp(image.data[i], 0.f, 1.f)));
  return bytes;
}

}  // namespace

struct Studio::Impl {
  Exec exec;
  StudioPlace place;
  io::GaussianPly ply;
  live::FirstLook first;
  SplatOptions splat;
  std::atomic<bool> quit = false;

  Reply state() const {
    const auto list = [](Vec3<double> v) { return Json{v.x, v.y, v.z}; };
    return {200, Json{{"version", 1},
                      {"title", std::filesystem::path(place.source).filename().string()},
                      {"gaussians", ply.cloud.size()},
                      {"bounds", {{"centre", list(first.centre)}, {"radius", first.radius}, {"up", list(first.up)}}},
                      {"start", json_of(first.look)},
                      {"views", Json::array()},
                      {"objects", Json::array()},
                      {"active", 0},
                      {"undo", 0},
                      {"redo", 0},
                      {"job", nullptr},
                      {"folder", place.folder},
                      {"commands", Json::array()}}
                     .dump()};
  }

  Reply frame(const std::string& body) {
    const double start = wall_seconds();
    const nlohmann::json parsed = parse_body(body);
    Fields fields(parsed, "");
    live::Look look = look_of(fields.object("camera"));
    if (fields.has("layer")) fields.text("layer", 20);
    if (fields.has("fade")) fields.number("fade", 0, 1);
    if (fields.has("object")) fields.whole("object", 0, 1000);
    if (fields.has("highlight")) fields.truth("highlight");
    if (fields.has("moving") && fields.truth("moving")) look.width_px /= 2, look.height_px /= 2;
    fields.end();
    const RenderedView view = render(exec, ply.cloud, live::camera_of(look), splat, {});
    const std::vector<std::uint8_t> jpeg = io::encode_jpeg(to_bytes(view.colour), 85);
    return {200,
            {jpeg.begin(), jpeg.end()},
            "image/jpeg",
            {{"X-Ngs-Ms", std::to_string(std::lround(1000 * (wall_seconds() - start)))}, {"X-Ngs-Version", "1"}}};
  }

  Reply route(const std::string& method, const std::string& path, const std::string& body) {
    if (method == "GET" && path == "/api/state") return state();
    if (method == "POST" && path == "/api/frame") return frame(body);
    if (method == "POST" && path == "/api/quit") return quit = true, Reply{};
    throw Refusal(404, method + " " + path, "no such thing here", "a request of protocol.md");
  }
};

Studio::Studio(const Exec& exec, StudioPlace place) : impl_(std::make_unique<Impl>()) {
  impl_->exec = exec, impl_->place = std::move(place);
  impl_->ply = io::read_gaussian_ply(impl_->place.source);
  impl_->first = live::first_look(exec, impl_->ply.cloud);
  impl_->splat.compat = impl_->first.compat, impl_->splat.antialiased = impl_->ply.cloud.antialiased;
  impl_->splat = prepared_for(exec, impl_->splat, impl_->ply.cloud);
}
Studio::~Studio() = default;

Reply Studio::answer(const std::string& method, const std::string& path, const std::string& body) {
  try {
    return impl_->route(method, path, body);
  } catch (const Refusal& refusal) {
    return reply_of(refusal);
  } catch (const Error& e) {
    return reply_of({400, "request", e.what(), "another", e.remedy()});
  } catch (const std::bad_alloc&) {
    return reply_of({507, "request", "more memory than there is", "a smaller picture"});
  }
}

bool Studio::has_quit() const { return impl_->quit; }

}  // namespace ngs::studio
