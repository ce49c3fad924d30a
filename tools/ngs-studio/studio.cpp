#include "studio.h"

#include <atomic>
#include <mutex>

#include "desk.h"
#include "ngs/core/error.h"

namespace ngs::studio {
namespace {

Refusal refusal_of(const Error& e) {
  const std::string what = e.what();
  const std::size_t colon = what.find(": "), expected = what.find(", expected ");
  const std::string found = colon == what.npos ? what : what.substr(colon + 2, expected - colon - 2);
  const int status = e.code() == ErrorCode::kUsage ? 409 : e.code() == ErrorCode::kBadInput ? 400 : 500;
  return {status, colon == what.npos ? "request" : what.substr(0, colon), found,
          expected == what.npos ? "" : what.substr(expected + 11), e.remedy()};
}

using Change = Json (Desk::*)(const io::JsonReader&);
struct Route {
  const char* path;
  Change change;
};
constexpr Route kChanges[] = {
    {"/api/strokes", &Desk::strokes}, {"/api/undo", &Desk::undo},     {"/api/redo", &Desk::redo},
    {"/api/objects", &Desk::objects}, {"/api/refine", &Desk::refine}, {"/api/export", &Desk::export_files},
    {"/api/forget", &Desk::forget},   {"/api/edit", &Desk::edit},     {"/api/keep", &Desk::keep}};

}  // namespace

struct Studio::Impl {
  Impl(const Exec& exec, StudioPlace place) : desk(exec, std::move(place)) {}

  Desk desk;
  std::mutex writing;  // serialises changes; frames do not wait for it
  std::atomic<bool> quit = false;

  Reply change(Change what, const std::string& path, const nlohmann::json& body) {
    const std::lock_guard lock(writing);
    const Json answer = (desk.*what)(io::JsonReader(body, ""));
    desk.note(path, body);
    const bool is_job = path == "/api/refine" || path == "/api/export";
    return {is_job ? 202 : 200, answer.dump()};
  }

  Reply get(const std::string& path) {
    if (path == "/api/state") return {200, desk.state().dump()};
    if (path == "/api/job") return {200, desk.job_json().dump()};
    if (path == "/api/log") return {200, desk.log().dump()};
    throw Refusal(404, "GET " + path, "unknown path", "a request of data-schema/studio-protocol.md");
  }

  Reply post(const std::string& path, const std::string& body) {
    const nlohmann::json parsed = parse_body(body);
    const io::JsonReader request(parsed, "");
    for (const Route& route : kChanges)
      if (path == route.path) return change(route.change, path, parsed);
    if (path == "/api/frame") return desk.frame(request);
    if (path == "/api/download") return desk.download(request);
    if (path == "/api/before") return {200, desk.before(request).dump()};
    if (path == "/api/cancel") return request.refuse_unknown_keys(), Reply{200, desk.cancel().dump()};
    if (path == "/api/quit") return request.refuse_unknown_keys(), quit = true, Reply{};
    throw Refusal(404, "POST " + path, "unknown path", "a request of data-schema/studio-protocol.md");
  }
};

Studio::Studio(const Exec& exec, StudioPlace place) : impl_(std::make_unique<Impl>(exec, std::move(place))) {}
Studio::~Studio() = default;

Reply Studio::answer(const std::string& method, const std::string& path, const std::string& body) {
  return reply_of([&] { return method == "GET" ? impl_->get(path) : impl_->post(path, body); });
}

Reply reply_of(const std::function<Reply()>& work) {
  try {
    return work();
  } catch (const Refusal& refusal) {
    return reply_of(refusal);
  } catch (const Error& e) {
    return reply_of(refusal_of(e));
  } catch (const std::bad_alloc&) {
    return reply_of({507, "request", "out of memory", "a smaller picture"});
  } catch (const std::exception& e) {
    return reply_of({500, "request", e.what(), "no internal error", "please report this"});
  }
}

bool Studio::has_quit() const { return impl_->quit; }
nlohmann::ordered_json Studio::log() const { return impl_->desk.log(); }

}  // namespace ngs::studio
