#pragma once
// The studio for one model: maps requests to responses (data-schema/studio-protocol.md). Independent of HTTP.
#include <functional>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "fields.h"
#include "ngs/backend/exec.h"
#include "state_folder.h"

namespace ngs::studio {

/// What `work` returns, or the error response for what it throws. Never throws.
Reply reply_of(const std::function<Reply()>& work);

class Studio {
 public:
  /// Reads the model. Throws the errors of the readers.
  Studio(const Exec& exec, StudioPlace place);
  ~Studio();
  Studio(const Studio&) = delete;
  Studio& operator=(const Studio&) = delete;

  /// Never throws; thread-safe.
  Reply answer(const std::string& method, const std::string& path, const std::string& body);
  /// True after POST /api/quit.
  bool has_quit() const;
  /// Response times, as in GET /api/log.
  nlohmann::ordered_json log() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ngs::studio
