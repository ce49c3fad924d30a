#pragma once
// Validates JSON against a JSON Schema (draft-07) with valijson.
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace ngs::test {

/// Loads the document to which "$ref" refers, if it is not the schema itself.
using SchemaSource = std::function<nlohmann::json(const std::string& reference)>;
/// Empty if `document` satisfies `schema`, else the first violations, one per line. `source` is needed by a report's
/// schema, which refers to "../options/TOOL.schema.json".
std::string schema_violations(const nlohmann::json& schema, const nlohmann::json& document,
                              const SchemaSource& source = {});

}  // namespace ngs::test
