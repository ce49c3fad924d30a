#include "support/schema_check.h"

#include <memory>
#include <valijson/adapters/nlohmann_json_adapter.hpp>
#include <valijson/schema.hpp>
#include <valijson/schema_parser.hpp>
#include <valijson/validator.hpp>

namespace ngs::test {

std::string schema_violations(const nlohmann::json& schema, const nlohmann::json& document,
                              const SchemaSource& source) {
  using Adapter = valijson::adapters::NlohmannJsonAdapter;
  const auto fetch = [&](const std::string& reference) {
    return std::make_unique<nlohmann::json>(source(reference)).release();
  };
  const auto release = [](const nlohmann::json* fetched) { std::default_delete<const nlohmann::json>()(fetched); };
  valijson::Schema compiled;
  valijson::SchemaParser().populateSchema(Adapter(schema), compiled, fetch, release);
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
