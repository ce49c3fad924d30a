#include "fields.h"

#include <cmath>

#include "ngs/options/strict_json.h"

namespace ngs::studio {
namespace {

constexpr double kMaxCoordinate = 1e9;  // world units
constexpr int kMinSide_px = 16, kMaxSide_px = 4096;
constexpr double kMaxPixels = 4096.0 * 2304.0;

std::string shown(const nlohmann::json& value) {
  std::string text = value.dump(-1, ' ', true, nlohmann::json::error_handler_t::replace);
  if (text.size() > 60) text = text.substr(0, 57) + "...";
  return text;
}

std::string span_of(double least, double most) {
  return shown(nlohmann::json(least)) + " to " + shown(nlohmann::json(most));
}

}  // namespace

Fields::Fields(const nlohmann::json& object, std::string path) : object_(object), path_(std::move(path)) {
  if (!object.is_object()) throw Refusal(400, path_.empty() ? "request" : path_, shown(object), "a JSON object");
}

void Fields::refuse(const std::string& name, const std::string& expected) const {
  throw Refusal(400, path_of(name), has(name) ? shown(object_.at(name)) : "nothing", expected);
}

const nlohmann::json& Fields::member(const std::string& name) {
  read_.insert(name);
  if (!has(name)) refuse(name, "a value");
  return object_.at(name);
}

double Fields::number(const std::string& name, double least, double most) {
  const nlohmann::json& value = member(name);
  const double number = value.is_number() ? value.get<double>() : NAN;
  if (!(number >= least && number <= most)) refuse(name, "a number of " + span_of(least, most));
  return number;
}

int Fields::integer(const std::string& name, int least, int most) {
  const double value = number(name, least, most);
  if (value != std::floor(value)) refuse(name, "a whole number");
  return int(value);
}

bool Fields::boolean(const std::string& name) {
  const nlohmann::json& value = member(name);
  if (!value.is_boolean()) refuse(name, "true or false");
  return value.get<bool>();
}

std::string Fields::text(const std::string& name, std::size_t longest) {
  const nlohmann::json& value = member(name);
  if (!value.is_string() || value.get_ref<const std::string&>().size() > longest)
    refuse(name, "a text of at most " + std::to_string(longest) + " bytes");
  return value.get<std::string>();
}

Vec3<double> Fields::vector(const std::string& name) {
  const nlohmann::json& value = member(name);
  double v[3] = {};
  bool good = value.is_array() && value.size() == 3;
  for (std::size_t k = 0; good && k < 3; ++k) {
    good = value[k].is_number() && std::abs(v[k] = value[k].get<double>()) <= kMaxCoordinate;
  }
  if (!good) refuse(name, "three numbers of at most 1e9");
  return {v[0], v[1], v[2]};
}

void Fields::end() const {
  for (const auto& [name, value] : object_.items())
    if (!read_.contains(name)) throw Refusal(400, path_of(name), shown(value), "a known member");
}

nlohmann::json parse_body(const std::string& body) {
  if (body.empty()) return nlohmann::json::object();
  try {
    return parse_strict_json<nlohmann::json>(body, "request", ErrorCode::kUsage);
  } catch (const Error& e) {
    throw Refusal(400, "request", e.what(), "one JSON object");
  }
}

live::Viewpoint viewpoint_of(Fields camera) {
  live::Viewpoint viewpoint;
  viewpoint.position = camera.vector("position"), viewpoint.look_at = camera.vector("look_at"),
  viewpoint.up = camera.vector("up");
  viewpoint.fov_y_deg = camera.number("fov_y_deg", 1, 150);
  viewpoint.width_px = camera.integer("width", kMinSide_px, kMaxSide_px);
  viewpoint.height_px = camera.integer("height", kMinSide_px, kMaxSide_px);
  if (double(viewpoint.width_px) * viewpoint.height_px > kMaxPixels)
    camera.refuse("height", "at most 4096x2304 px in all");
  camera.end();
  const Vec3<double> line = viewpoint.look_at - viewpoint.position;
  if (!(dot(line, line) > 0)) camera.refuse("look_at", "another point than position");
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
