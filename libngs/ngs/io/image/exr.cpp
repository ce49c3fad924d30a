#include "ngs/io/image/exr.h"

#include <ImfChannelList.h>
#include <ImfDoubleAttribute.h>
#include <ImfFloatAttribute.h>
#include <ImfFrameBuffer.h>
#include <ImfHeader.h>
#include <ImfIO.h>
#include <ImfInputFile.h>
#include <ImfIntAttribute.h>
#include <ImfOutputFile.h>
#include <ImfStringAttribute.h>
#include <ImfVersion.h>

#include <algorithm>
#include <cstring>
#include <string_view>

#include "ngs/core/check.h"
#include "ngs/core/error.h"
#include "ngs/io/files/atomic_file.h"
#include "ngs/io/files/byte_reader.h"
#include "ngs/io/files/mapped_file.h"

namespace ngs::io {
namespace {

constexpr std::int64_t kMaxExrPixels = 100'000'000;
constexpr std::int64_t kMaxRowsPerChunk = 256;

class MemoryOut : public Imf::OStream {
 public:
  MemoryOut() : OStream("memory") {}
  void write(const char data[], int n) override {
    const std::size_t end = at_ + std::size_t(n);
    if (bytes_.size() < end) bytes_.resize(end);
    std::memcpy(bytes_.data() + at_, data, std::size_t(n));
    at_ = end;
  }
  std::uint64_t tellp() override { return at_; }
  void seekp(std::uint64_t position) override { at_ = position; }
  const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
  std::size_t at_ = 0;
};

class MemoryIn : public Imf::IStream {
 public:
  explicit MemoryIn(Bytes bytes) : IStream("memory"), bytes_(bytes) {}
  bool read(char data[], int n) override {
    if (n < 0 || at_ > bytes_.size() || std::size_t(n) > bytes_.size() - at_)
      throw std::runtime_error("unexpected end of file");
    std::memcpy(data, bytes_.data() + at_, std::size_t(n));
    at_ += std::size_t(n);
    return at_ < bytes_.size();
  }
  std::uint64_t tellg() override { return at_; }
  void seekg(std::uint64_t position) override { at_ = position; }

 private:
  Bytes bytes_;
  std::size_t at_ = 0;
};

char* base_of(const float* data) { return const_cast<char*>(reinterpret_cast<const char*>(data)); }

void check_attribute_name(const std::string& name) {
  NGS_CHECK(name.rfind("ngs:", 0) == 0, "EXR attribute names start with ngs:, got " + name);
}

void read_attributes(const Imf::Header& header, ExrImage& image) {
  for (auto it = header.begin(); it != header.end(); ++it) {
    const std::string name = it.name();
    if (name.rfind("ngs:", 0) != 0) continue;
    if (const auto* text = dynamic_cast<const Imf::StringAttribute*>(&it.attribute())) image.text[name] = text->value();
    if (const auto* f = dynamic_cast<const Imf::FloatAttribute*>(&it.attribute()))
      image.numbers[name] = double(f->value());
    if (const auto* d = dynamic_cast<const Imf::DoubleAttribute*>(&it.attribute())) image.numbers[name] = d->value();
    if (const auto* i = dynamic_cast<const Imf::IntAttribute*>(&it.attribute())) image.numbers[name] = i->value();
  }
}

struct Packing {
  std::int64_t rows;      // per chunk; the library allocates that many even for a smaller image
  double most_expansion;  // upper bound of float bytes per file byte
};
/// The bounds exceed the expansion measured on constant images (the comments), which compress best, with a margin for
/// partial chunks. Half floats count twice; deflate packs at most 1032 bytes into one.
Packing packing(Imf::Compression compression) {
  switch (compression) {
    case Imf::NO_COMPRESSION: return {1, 4};           // measured: 2.0
    case Imf::RLE_COMPRESSION: return {1, 256};        // 119
    case Imf::ZIPS_COMPRESSION: return {1, 4096};      // 528
    case Imf::ZIP_COMPRESSION:                         // 1750
    case Imf::PXR24_COMPRESSION: return {16, 4096};    // 1572
    case Imf::PIZ_COMPRESSION: return {32, 2048};      // 573
    case Imf::B44_COMPRESSION:                         // 5
    case Imf::B44A_COMPRESSION: return {32, 256};      // 21
    case Imf::DWAA_COMPRESSION: return {32, 1 << 14};  // 5516
    default: return {kMaxRowsPerChunk, 1 << 16};       // DWAB: 21418
  }
}

void check_size(std::int64_t width, std::int64_t height, std::int64_t channels, double most_expansion,
                std::size_t file_bytes) {
  const std::string size = std::to_string(width) + "x" + std::to_string(height) + " px";
  if (width < 1 || height < 1 || width > kMaxExrPixels || height > kMaxExrPixels || width * height > kMaxExrPixels)
    throw std::runtime_error("image of " + size);
  if (double(width) * double(height) * double(channels) * 4.0 > most_expansion * double(file_bytes))
    throw std::runtime_error("header declares " + size + " in " + std::to_string(file_bytes) + " bytes");
}

/// Skips a value as the library does: by its type, as the attribute's size can differ. Stops soon after `size` bytes.
void skip_value(ByteReader& in, const std::string& type, std::size_t size) {
  static const std::map<std::string_view, std::size_t> size_of_type = {{"box2i", 16},
                                                                       {"box2f", 16},
                                                                       {"chromaticities", 32},
                                                                       {"compression", 1},
                                                                       {"deepImageState", 1},
                                                                       {"double", 8},
                                                                       {"envmap", 1},
                                                                       {"float", 4},
                                                                       {"int", 4},
                                                                       {"keycode", 28},
                                                                       {"lineOrder", 1},
                                                                       {"m33f", 36},
                                                                       {"m33d", 72},
                                                                       {"m44f", 64},
                                                                       {"m44d", 128},
                                                                       {"rational", 8},
                                                                       {"tiledesc", 9},
                                                                       {"timecode", 8},
                                                                       {"v2i", 8},
                                                                       {"v2f", 8},
                                                                       {"v2d", 16},
                                                                       {"v3i", 12},
                                                                       {"v3f", 12},
                                                                       {"v3d", 24}};
  constexpr std::size_t kChannelBytes = 16;
  const std::size_t before = in.left();
  if (const auto fixed = size_of_type.find(type); fixed != size_of_type.end()) {
    in.skip(fixed->second);
  } else if (type == "chlist") {  // ended by an empty name
    while (before - in.left() <= size && !in.read_name().empty()) in.skip(kChannelBytes);
  } else if (type == "preview") {
    const auto width = in.read<std::uint32_t>(), height = in.read<std::uint32_t>();
    const bool fits = width <= in.left() && height <= in.left();
    in.skip(fits ? 4 * std::uint64_t(width) * height : std::uint64_t(in.left()) + 1);
  } else if (type == "stringvector") {
    while (before - in.left() < size) in.skip(std::uint64_t(in.read<std::int32_t>()));  // negative sizes fail in skip()
  } else {
    in.skip(size);
  }
}

/// Attributes are name, type, size, value. The library allocates the declared size before it reads the value, and then
/// continues where it stopped reading; that position must agree with the size.
void check_attribute_sizes(ByteReader in, bool multi_part) {
  do {
    while (!in.read_name().empty()) {  // an empty name ends a header
      const std::string type = in.read_name();
      const auto size = in.read<std::int32_t>();
      const std::size_t before = in.left();
      if (size < 0 || std::size_t(size) > before) throw std::runtime_error("file is truncated");
      skip_value(in, type, std::size_t(size));
      if (before - in.left() != std::size_t(size))
        throw std::runtime_error("an attribute of type " + type + " declares " + std::to_string(size) + " bytes");
    }
  } while (multi_part && in.left() > 0 && ByteReader(in).read<std::uint8_t>() != 0);  // ended by an empty header
}

/// Checks the sizes in the header before the library allocates memory for them.
void check_header(Bytes bytes, const std::string& object) {
  ByteReader in(bytes, object);
  if (in.read<std::int32_t>() != Imf::MAGIC) throw std::runtime_error("not an EXR file");
  int version = in.read<std::int32_t>();  // and flags
  MemoryIn stream(bytes);
  stream.seekg(bytes.size() - in.left());
  check_attribute_sizes(in, Imf::isMultiPart(version));
  Imf::Header header;
  header.readFrom(stream, version);
  std::int64_t count = 0;
  for (auto it = header.channels().begin(); it != header.channels().end(); ++it, ++count)
    if (it.channel().xSampling != 1 || it.channel().ySampling != 1) throw std::runtime_error("subsampled channels");
  if (count == 0) throw std::runtime_error("file has no channels");
  const Imath::Box2i window = header.dataWindow();
  const std::int64_t height = std::int64_t(window.max.y) - window.min.y + 1;
  const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1;
  const Packing packed = packing(header.compression());
  const auto check = [&](std::int64_t columns, std::int64_t rows) {
    check_size(columns, rows, count, packed.most_expansion, bytes.size());
  };
  check(width, height);
  check(width, packed.rows);
  if (header.hasTileDescription()) check(header.tileDescription().xSize, header.tileDescription().ySize);
  constexpr std::int64_t kOffsetBytes = 8;
  if (height / kMaxRowsPerChunk * kOffsetBytes > std::int64_t(bytes.size()))
    throw std::runtime_error("file is truncated");
}

ExrImage read_stream(Imf::IStream& stream) {
  Imf::InputFile file(stream);
  if (!file.isComplete()) throw std::runtime_error("file is truncated");
  const Imath::Box2i window = file.header().dataWindow();
  const std::int64_t width = std::int64_t(window.max.x) - window.min.x + 1;
  const std::int64_t height = std::int64_t(window.max.y) - window.min.y + 1;
  ExrImage image{int(width), int(height), {}, {}, {}};
  Imf::FrameBuffer target;
  for (auto it = file.header().channels().begin(); it != file.header().channels().end(); ++it) {
    auto& values = image.channels[it.name()];
    values.resize(std::size_t(width * height));
    const std::size_t row_bytes = std::size_t(width) * sizeof(float);
    target.insert(it.name(), Imf::Slice::Make(Imf::FLOAT, values.data(), window, sizeof(float), row_bytes));
  }
  file.setFrameBuffer(target);
  file.readPixels(window.min.y, window.max.y);
  read_attributes(file.header(), image);
  return image;
}

}  // namespace

void ExrImage::add(const std::vector<std::string>& names, const ImageF& image) {
  if (width_px == 0 && height_px == 0) {
    width_px = image.width_px;
    height_px = image.height_px;
  }
  NGS_CHECK(image.width_px == width_px && image.height_px == height_px && int(names.size()) == image.channels,
            "EXR layers of one file have one size and a name per channel");
  for (std::size_t c = 0; c < names.size(); ++c) {
    auto& values = channels[names[c]];
    values.resize(std::size_t(image.pixels()));
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = image.data[i * names.size() + c];
  }
}

void write_exr(const std::string& path, const ExrImage& image) {
  NGS_CHECK(image.width_px > 0 && image.height_px > 0 && !image.channels.empty(), "EXR needs pixels and channels");
  Imf::Header header(image.width_px, image.height_px);
  header.compression() = Imf::ZIP_COMPRESSION;
  Imf::FrameBuffer source;
  for (const auto& [name, values] : image.channels) {
    NGS_CHECK(values.size() == std::size_t(image.width_px) * std::size_t(image.height_px), "EXR channel size");
    header.channels().insert(name, Imf::Channel(Imf::FLOAT));
    source.insert(name, Imf::Slice(Imf::FLOAT, base_of(values.data()), sizeof(float),
                                   std::size_t(image.width_px) * sizeof(float)));
  }
  for (const auto& [name, value] : image.text) {
    check_attribute_name(name);
    header.insert(name, Imf::StringAttribute(value));
  }
  for (const auto& [name, value] : image.numbers) {
    check_attribute_name(name);
    header.insert(name, Imf::DoubleAttribute(value));
  }
  MemoryOut stream;
  try {
    Imf::OutputFile file(stream, header, 0);
    file.setFrameBuffer(source);
    file.writePixels(image.height_px);
  } catch (const std::exception& e) {
    throw Error(ErrorCode::kEnvironment, path + ": the EXR encoder failed (" + e.what() + "), expected an image");
  }
  write_file(path, stream.bytes());
}

ExrImage parse_exr(Bytes bytes, const std::string& object) {
  try {
    check_header(bytes, object);
    MemoryIn stream(bytes);
    return read_stream(stream);
  } catch (const Error&) {
    throw;
  } catch (const std::exception& e) {
    std::string reason = e.what();
    std::replace(reason.begin(), reason.end(), '\n', ' ');
    throw Error(ErrorCode::kBadInput, object + ": " + reason + ", expected a complete EXR image");
  }
}

ExrImage read_exr(const std::string& path) { return parse_exr(map_regular_file(path).bytes(), path); }

}  // namespace ngs::io
