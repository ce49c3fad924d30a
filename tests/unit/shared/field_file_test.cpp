#include "shared/scene/field_file.h"

#include <doctest/doctest.h>

#include "ngs/io/files/safetensors.h"
#include "support/temp_dir.h"

namespace ngs {
namespace {

FieldShape small_shape() {
  FieldShape shape;
  shape.hash = {3, 2, 6, 4, 16, true};
  shape.box = {{0.5f, -1, 2}, {0.25f, 0.25f, 0.25f}};
  shape.hidden = 16, shape.layers = 1, shape.direction_degree = 1, shape.features = 5, shape.concatenate = true;
  shape.objects = 4, shape.width = 1.0 / 3, shape.neighbours = 2, shape.boundary = 3;
  return shape;
}

BoundarySet three() {
  BoundarySet b;
  b.row = {1, 5, 8}, b.position = {0, 0, 1, 1, 0, 2, 0, 1, 3}, b.origin = {1e6, 0, -3};
  return b;
}

std::string written(const test::TempDir& dir) {
  SampleOptions sample;
  sample.depth_samples = 6, sample.depth_span = 0.07, sample.window = WindowCentre::kMean;
  std::string path = dir.file("field.safetensors");
  const JointField field(small_shape(), FieldOptions{}, 9);
  cli::write_field(path, &field, three(), sample);
  return path;
}

}  // namespace

TEST_CASE("field file: what was written comes back, every bit") {
  const test::TempDir dir;
  const FieldModel read = cli::read_field(written(dir));
  const JointField field(small_shape(), FieldOptions{}, 9);
  CHECK(read.field.parameters().values == field.parameters().values);
  CHECK(read.field.shape().width == small_shape().width);
  CHECK(read.field.shape().concatenate);
  CHECK(read.field.shape().hash.smoothstep);
  CHECK(read.field.shape().objects == 4);
  CHECK(read.field.shape().box.inv_extent.x == 0.25f);
  CHECK(read.boundary.position == three().position);
  CHECK(read.boundary.origin == three().origin);
  CHECK(read.sample.depth_samples == 6);
  CHECK(read.sample.depth_span == 0.07);
  CHECK(read.sample.window == WindowCentre::kMean);
}

TEST_CASE("field file: sizes that no option allows and numbers that are none are refused") {
  const test::TempDir dir;
  const std::string path = written(dir);
  const auto refuses = [&](const std::string& key, const std::string& value) {
    CAPTURE(key);
    CAPTURE(value);
    io::TensorFile file = io::read_safetensors(path);
    file.metadata[key] = value;
    const std::string other = dir.file("other.safetensors");
    io::write_safetensors(other, file);
    CHECK_THROWS_AS(cli::read_field(other), Error);
  };
  refuses("hash_log2_table", "60"), refuses("hidden", "1000000"), refuses("objects", "-1"), refuses("width", "nan");
  refuses("width", "0"), refuses("features", "2"), refuses("hash_features", "3"), refuses("layers", "two");
  refuses("hash_finest", "2"), refuses("ngs:schema", "ngs.nerf.9"), refuses("hidden", "32");
}

TEST_CASE("field file: a value that is not finite is refused") {
  const test::TempDir dir;
  io::TensorFile file = io::read_safetensors(written(dir));
  for (io::Tensor& tensor : file.tensors)
    if (tensor.name == "feature") std::fill(tensor.bytes.begin(), tensor.bytes.begin() + 4, std::uint8_t(0xff));
  const std::string other = dir.file("other.safetensors");
  io::write_safetensors(other, file);
  CHECK_THROWS_AS(cli::read_field(other), Error);
}

TEST_CASE("field file: a run without a boundary leaves a file that holds no field") {
  const test::TempDir dir;
  const std::string path = dir.file("field.safetensors");
  cli::write_field(path, nullptr, {}, {});
  CHECK_THROWS_AS(cli::read_field(path), Error);
}

}  // namespace ngs
