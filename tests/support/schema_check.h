#pragma once
// JSON Schema (draft-07) through valijson.
#include <nlohmann/json.hpp>
#include <string>

namespace ngs::test {

/// Empty if `document` satisfies `schema`, else the first violations, one per line.
std::string schema_violations(const nlohmann::json& schema, const nlohmann::json& document);

}  // namespace ngs::test
