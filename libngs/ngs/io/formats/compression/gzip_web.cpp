// The browser inflates (tools/ngs-studio/web/worker.js): what a gzip stream holds lies behind its first two bytes.
#include <algorithm>

#include "ngs/io/formats/compression/gzip.h"
#include "ngs/io/formats/compression/refuse_web.h"

namespace ngs::io {
namespace {

constexpr std::size_t kMark = 2;

}  // namespace

struct GunzipReader::State {
  Bytes left;
};

GunzipReader::GunzipReader(const std::string& name, Bytes stream)
    : name_(name), state_(new State{stream.subspan(std::min(kMark, stream.size()))}) {}

GunzipReader::~GunzipReader() { delete state_; }

void GunzipReader::refuse(int, std::size_t missing) const {
  throw Error(ErrorCode::kBadInput,
              name_ + ": the gzip stream ends " + std::to_string(missing) +
                  " bytes early, expected the size that its header declares",
              "copy or export it again");
}

void GunzipReader::read(std::span<std::uint8_t> bytes) {
  Bytes& left = state_->left;
  if (left.size() < bytes.size()) refuse(0, bytes.size() - left.size());
  std::copy_n(left.begin(), bytes.size(), bytes.begin());
  left = left.subspan(bytes.size());
}

std::vector<std::uint8_t> GunzipReader::read_all(std::size_t) { return {state_->left.begin(), state_->left.end()}; }
void GunzipReader::finish() {}
std::vector<std::uint8_t> gzip(Bytes) { refuse_in_browser("output", "a gzip stream"); }

}  // namespace ngs::io
