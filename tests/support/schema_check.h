#pragma once
// JSON Schema (draft-07) through valijson.
#include <functional>
#include <nlohmann/json.hpp>
#include <string>

namespace ngs::test {

/// The document that "$ref" names, other than the schema's own.
using SchemaSource = std::function<nlohmann::json(const std::string& reference)>;
/// "../options/TOOL.schema.json", which the schema of a report refers to, from data-schema/.
nlohmann::json committed_schema(const std::string& reference);

/// Empty if `document` satisfies `schema`, else the first violations, one per line.
std::string schema_violations(const nlohmann::json& schema, const nlohmann::json& document,
                              const SchemaSource& source = committed_schema);

}  // namespace ngs::test
