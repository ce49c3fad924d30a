#include "ngs/io/formats/compression/gzip.h"

#include <zlib.h>
#include <zstd.h>

#include <algorithm>
#include <limits>
#include <memory>

#include "ngs/core/check.h"
#include "ngs/core/error.h"

namespace ngs::io {
namespace {

constexpr int kGzipWindow = 15 + 16;  // zlib's windowBits: largest window, gzip wrapper

uInt at_most_uint(std::size_t n) { return uInt(std::min(n, std::size_t(std::numeric_limits<uInt>::max()))); }

}  // namespace

struct GunzipReader::State {
  z_stream stream{};
  std::size_t left = 0;  // input bytes not yet passed to zlib
  bool ended = false;    // the stream ended with a correct checksum
};

GunzipReader::GunzipReader(const std::string& name, Bytes stream) : name_(name), state_(nullptr) {
  auto state = std::make_unique<State>();
  state->stream.next_in = const_cast<Bytef*>(stream.data());
  state->left = stream.size();
  if (inflateInit2(&state->stream, kGzipWindow) != Z_OK) throw std::bad_alloc();
  state_ = state.release();
}

GunzipReader::~GunzipReader() {
  inflateEnd(&state_->stream);
  delete state_;
}

/// One call of zlib; writes from `done` to the end of `to` at most, and advances `done`.
int GunzipReader::inflate_some(std::span<std::uint8_t> to, std::size_t& done) {
  z_stream& stream = state_->stream;
  if (stream.avail_in == 0) {
    stream.avail_in = at_most_uint(state_->left);
    state_->left -= stream.avail_in;
  }
  const uInt room = at_most_uint(to.size() - done);
  stream.next_out = to.data() + done;
  stream.avail_out = room;
  const int status = inflate(&stream, Z_NO_FLUSH);
  done += room - stream.avail_out;
  const bool stuck = status == Z_OK && stream.avail_out == room && state_->left == 0;
  return stuck ? Z_BUF_ERROR : status;
}

void GunzipReader::refuse(int status, std::size_t missing) const {
  if (status == Z_MEM_ERROR) throw std::bad_alloc();
  const bool ended = status == Z_STREAM_END || status == Z_BUF_ERROR;
  throw Error(ErrorCode::kBadInput,
              name_ + (ended ? ": the gzip stream ends " + std::to_string(missing) +
                                   " bytes early, expected the size that its header declares"
                             : std::string(": a damaged gzip stream, expected one that can be inflated")),
              "copy or export it again");
}

void GunzipReader::read(std::span<std::uint8_t> bytes) {
  for (std::size_t done = 0; done < bytes.size();) {
    const int status = inflate_some(bytes, done);
    if (status == Z_STREAM_END) state_->ended = true;
    if (done < bytes.size() && status != Z_OK) refuse(status, bytes.size() - done);
  }
}

std::vector<std::uint8_t> GunzipReader::read_all(std::size_t max_bytes) {
  std::vector<std::uint8_t> bytes(std::size_t(1) << 20);
  for (std::size_t done = 0; !state_->ended;) {
    if (done == bytes.size()) bytes.resize(2 * done);
    const int status = inflate_some(bytes, done);
    state_->ended = status == Z_STREAM_END;
    if (!state_->ended && status != Z_OK) refuse(status, 1);
    if (done > max_bytes)
      throw Error(ErrorCode::kBadInput,
                  name_ + ": unpacks to more than " + std::to_string(max_bytes) + " bytes, expected at most that many",
                  "the file is damaged or hostile: copy or export it again");
    if (state_->ended) bytes.resize(done);
  }
  return bytes;
}

void GunzipReader::finish() {
  std::vector<std::uint8_t> ignored(std::size_t(1) << 20);
  std::size_t done = 0;
  while (!state_->ended) {
    const int status = inflate_some(ignored, done);
    if (status == Z_STREAM_END) return;
    if (status != Z_OK) refuse(status, 1);
    if (done == ignored.size())
      throw Error(ErrorCode::kBadInput,
                  name_ +
                      ": more than 1 MiB after the data that the header declares, expected "
                      "the end of the file",
                  "copy or export it again");
  }
}

std::vector<std::uint8_t> gzip(Bytes bytes) {
  z_stream stream{};
  if (deflateInit2(&stream, Z_DEFAULT_COMPRESSION, Z_DEFLATED, kGzipWindow, 9, Z_DEFAULT_STRATEGY) != Z_OK)
    throw std::bad_alloc();
  const std::unique_ptr<z_stream, int (*)(z_stream*)> ended(&stream, deflateEnd);
  std::vector<std::uint8_t> out, piece(std::size_t(1) << 18);
  stream.next_in = const_cast<Bytef*>(bytes.data());
  std::size_t left = bytes.size();
  int status = Z_OK;
  while (status != Z_STREAM_END) {
    if (stream.avail_in == 0) {
      stream.avail_in = at_most_uint(left);
      left -= stream.avail_in;
    }
    stream.next_out = piece.data();
    stream.avail_out = uInt(piece.size());
    status = deflate(&stream, left == 0 ? Z_FINISH : Z_NO_FLUSH);
    NGS_CHECK(status == Z_OK || status == Z_STREAM_END, "deflate has input and room");
    out.insert(out.end(), piece.begin(), piece.end() - std::ptrdiff_t(stream.avail_out));
  }
  constexpr std::size_t kSystem = 9;  // of the header: zlib writes another number on Windows
  out.at(kSystem) = 3;
  return out;
}

void unzstd(const std::string& object, Bytes frames, std::span<std::uint8_t> out) {
  const std::size_t size = ZSTD_decompress(out.data(), out.size(), frames.data(), frames.size());
  if (ZSTD_isError(size) == 0 && size == out.size()) return;
  const std::string found = ZSTD_isError(size) != 0 ? std::string("a zstd stream that is damaged or too long (") +
                                                          ZSTD_getErrorName(size) + ")"
                                                    : "a zstd stream of " + std::to_string(size) + " bytes";
  throw Error(ErrorCode::kBadInput, object + ": " + found + ", expected " + std::to_string(out.size()) + " bytes",
              "copy or export it again");
}

}  // namespace ngs::io
