#include "support/schema_check.h"

#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

namespace ngs::test {

std::string schema_violations(const nlohmann::json& schema, const nlohmann::json& document) {
  using Adapter = valijson::adapters::NlohmannJsonAdapter;
  valijson::Schema compiled;
  valijson::SchemaParser().populateSchema(Adapter(schema), compiled);
  valijson::ValidationResults results;
  if (valijson::Validator().validate(compiled, Adapter(document), &results)) return {};
  std::string text;
  valijson::ValidationResults::Error error;
  while (results.popError(error)) {
    std::string path;
    for (const std::string& step : error.context) path += step;
    text += path + ": " + error.description + "\n";
  }
  return text;
}

}  // namespace ngs::test
