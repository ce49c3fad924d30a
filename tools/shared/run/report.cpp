#include "shared/run/report.h"

#include <algorithm>

#include "shared/cli/version.h"

namespace ngs::cli {
namespace {

Json stage_json(const StageNode& node) {
  Json stage = {{"name", node.name},
                {"wall_s", node.wall_s},
                {"cpu_s", node.cpu_s},
                {"items", node.items},
                {"items_per_s", node.wall_s > 0 ? double(node.items) / node.wall_s : 0.0},
                {"max_rss_mib", node.max_rss_mib},
                {"children", Json::array()}};
  for (const StageNode& child : node.children) stage["children"].push_back(stage_json(child));
  return stage;
}

/// "output" of "-o,--output".
std::string long_name(const std::string& flags) { return flags.substr(flags.rfind("--") + 2); }

Json whole_numbers(const Json& result) {
  Json counts = Json::object();
  for (const auto& [name, value] : result.items())
    if (value.is_number_integer()) counts[name] = value;
  return counts;
}

Json object_schema(Json properties, const std::vector<std::string>& optional = {}) {
  Json required = Json::array();
  for (const auto& [name, unused] : properties.items())
    if (std::find(optional.begin(), optional.end(), name) == optional.end()) required.push_back(name);
  return {{"type", "object"},
          {"additionalProperties", false},
          {"required", required},
          {"properties", std::move(properties)}};
}

/// The values that a common flag accepts. The default is left out: for some flags it means that the tool chooses.
Json common_flag_schema(const char* name) {
  CommonFlags flags;
  OptionSet set;
  set.add(flags);
  Json schema = set.property_schema(name);
  schema.erase("default");
  schema.erase("maximum");  // readers of JSON differ beyond 2^53
  return schema;
}

}  // namespace

Json make_report(const ReportData& data) {
  Json inputs = Json::array(), outputs = Json::array();
  for (const ReadInput& input : data.inputs) {
    Json record = {{"name", input.name}, {"path", input.path}, {"bytes", input.bytes}};
    if (!input.xxh3.empty()) record["xxh3"] = input.xxh3;
    inputs.push_back(std::move(record));
  }
  for (const Output& output : data.spec.outputs)
    if (output && !data.spec.writes_nothing())
      outputs.push_back({{"name", long_name(output.flags)}, {"path", data.streams.given(output.path)}});
  StageNode root = data.monitor.root();
  root.name = data.spec.name;
  root.wall_s = data.wall_s;
  root.cpu_s = data.cpu_s;
  for (const StageNode& child : root.children) root.max_rss_mib = std::max(root.max_rss_mib, child.max_rss_mib);

  Json report = {{"tool", data.spec.name},
                 {"version", version_with_commit()},
                 {"options", data.spec.options.to_json()},
                 {"seed", data.flags.seed},
                 {"inputs", std::move(inputs)},
                 {"outputs", std::move(outputs)},
                 {"device",
                  {{"kind", data.device.device == Device::kCuda ? "cuda" : "cpu"},
                   {"name", data.device.name},
                   {"reason", data.device.reason},
                   {"fast_atomics", data.device.sums == DeviceSums::kAtomic}}},
                 {"threads", data.threads},
                 {"isa", isa_name(data.isa)},
                 {"dry_run", data.flags.dry_run},
                 {"exit_code", data.exit_code},
                 {"stages", stage_json(root)},
                 {"counts", whole_numbers(data.result)},
                 {"result", data.result},
                 {"warnings", data.monitor.warnings()}};
  if (data.flags.dry_run || !data.plan.empty()) report["plan"] = data.plan;
  return report;
}

Json report_schema(const Spec& spec) {
  const Json text = {{"type", "string"}}, count = {{"type", "integer"}, {"minimum", 0}};
  const Json seconds = {{"type", "number"}, {"minimum", 0}}, free_object = {{"type", "object"}};
  const auto list_of = [](Json items) { return Json{{"type", "array"}, {"items", std::move(items)}}; };
  const Json hash = {{"type", "string"}, {"pattern", "^[0-9a-f]{32}$"}};
  const Json counts = {{"type", "object"}, {"additionalProperties", {{"type", "integer"}}}};
  std::string file = spec.name + ".schema.json";
  std::ranges::replace(file, ' ', '-');
  // The report has all options; the schema of an options file allows no others, but requires none.
  const Json options = {{"allOf", {{{"$ref", "../options/" + file}}}},
                        {"minProperties", spec.options.entries().size()}};
  const Json stage = object_schema({{"name", text},
                                    {"wall_s", seconds},
                                    {"cpu_s", seconds},
                                    {"items", count},
                                    {"items_per_s", seconds},
                                    {"max_rss_mib", seconds},
                                    {"children", list_of({{"$ref", "#/definitions/stage"}})}});
  Json report = object_schema(
      {{"tool", {{"const", spec.name}}},
       {"version", text},
       {"options", options},
       {"seed", common_flag_schema("seed")},
       {"inputs", list_of(object_schema({{"name", text}, {"path", text}, {"bytes", count}, {"xxh3", hash}}, {"xxh3"}))},
       {"outputs", list_of(object_schema({{"name", text}, {"path", text}}))},
       {"device", object_schema({{"kind", {{"enum", {"cpu", "cuda"}}}},
                                 {"name", text},
                                 {"reason", text},
                                 {"fast_atomics", {{"type", "boolean"}}}})},
       {"threads", common_flag_schema("threads")},
       {"isa", {{"enum", {"portable", "neon", "x86-64-v3", "x86-64-v4"}}}},
       {"dry_run", common_flag_schema("dry_run")},
       {"exit_code", {{"enum", {0, 1, 7, 130, 143}}}},
       {"stages", {{"$ref", "#/definitions/stage"}}},
       {"counts", counts},
       {"result", free_object},
       {"warnings", list_of(text)},
       {"plan", free_object}},
      {"plan"});
  Json schema = {{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", spec.name + " report"}};
  schema.update(report);
  schema["definitions"] = {{"stage", stage}};
  return schema;
}

}  // namespace ngs::cli
