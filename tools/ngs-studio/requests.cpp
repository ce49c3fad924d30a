#include "requests.h"

#include <algorithm>
#include <cmath>

#include "ngs/core/error.h"

namespace ngs::studio {
namespace {

constexpr double kMaxCoordinate = 1e9;  // world units
constexpr int kMinSide_px = 16, kMaxSide_px = 4096;
constexpr double kMaxPixels = 4096.0 * 2304.0;

}  // namespace

nlohmann::json parse_body(const std::string& body) {
  nlohmann::json request = body.empty() ? nlohmann::json::object() : io::parse_json(body, "request");
  if (!request.is_object()) throw Error(ErrorCode::kBadInput, "request: another value, expected one JSON object");
  return request;
}

Vec3<double> vector_of(const io::JsonReader& reader, const std::string& key) {
  const std::vector<double> v = reader.matrix(key, 3, 0);
  if (std::ranges::any_of(v, [](double x) { return std::abs(x) > kMaxCoordinate; }))
    reader.fail(key, "three numbers of at most 1e9");
  return vec3(v.data());
}

live::Viewpoint viewpoint_of(const io::JsonReader& camera) {
  live::Viewpoint viewpoint;
  viewpoint.position = vector_of(camera, "position");
  viewpoint.look_at = vector_of(camera, "look_at");
  viewpoint.up = vector_of(camera, "up");
  viewpoint.fov_y_deg = camera.number("fov_y_deg", 1, 150);
  viewpoint.width_px = int(camera.integer("width", kMinSide_px, kMaxSide_px));
  viewpoint.height_px = int(camera.integer("height", kMinSide_px, kMaxSide_px));
  if (double(viewpoint.width_px) * viewpoint.height_px > kMaxPixels)
    camera.fail("height", "at most 4096x2304 px in all");
  camera.refuse_unknown_keys();
  const Vec3<double> line = viewpoint.look_at - viewpoint.position;
  if (!(dot(line, line) > 0)) camera.fail("look_at", "another point than position");
  return viewpoint;
}

Json json_of(const live::Viewpoint& viewpoint) {
  const auto list = [](Vec3<double> v) { return Json{v.x, v.y, v.z}; };
  return {
      {"position", list(viewpoint.position)}, {"look_at", list(viewpoint.look_at)}, {"up", list(viewpoint.up)},
      {"fov_y_deg", viewpoint.fov_y_deg},     {"width", viewpoint.width_px},        {"height", viewpoint.height_px}};
}

Refusal::Refusal(int http_status, std::string object_name, std::string value_found, std::string value_expected,
                 std::string remedy_text)
    : std::runtime_error(object_name + ": " + value_found + ", expected " + value_expected),
      status(http_status),
      object(std::move(object_name)),
      found(std::move(value_found)),
      expected(std::move(value_expected)),
      remedy(std::move(remedy_text)) {}

Reply reply_of(const Refusal& refusal) {
  const nlohmann::ordered_json error{
      {"object", refusal.object}, {"found", refusal.found}, {"expected", refusal.expected}, {"remedy", refusal.remedy}};
  // Messages quote the request, which need not be valid UTF-8.
  return {refusal.status,
          nlohmann::ordered_json{{"error", error}}.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace)};
}

}  // namespace ngs::studio
