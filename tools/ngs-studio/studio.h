#pragma once
// The studio over one model: requests in, answers out (data-schema/studio-protocol.md). Knows files and JSON, but
// nothing of HTTP.
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "ngs/backend/exec.h"
#include "reply.h"
#include "state_folder.h"

namespace ngs::studio {

class Studio {
 public:
  /// Reads the model. Errors as the readers'.
  Studio(const Exec& exec, StudioPlace place);
  ~Studio();
  Studio(const Studio&) = delete;
  Studio& operator=(const Studio&) = delete;

  /// Never throws; any thread.
  Reply answer(const std::string& method, const std::string& path, const std::string& body);
  /// POST /api/quit came.
  bool has_quit() const;
  /// Times of the answers, as GET /api/log.
  nlohmann::ordered_json log() const;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace ngs::studio
