#include "ngs/make/synth/synth_messy.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>

#include "ngs/make/synth/synth_dice.h"

namespace ngs::synth {
namespace {

using V = Vec3<double>;
constexpr double kTurn = 2 * std::numbers::pi;
constexpr double kCell = 0.34;                    // side of a place; what stands there keeps kSlack from its sides
constexpr double kSlack = 0.01;                   // world: at most this far from the middle of its place
constexpr double kBoard = 0.015;                  // half thickness of table top and shelves
constexpr double kTable = 0.72;                   // height of the table top
constexpr double kShelves[] = {0.06, 0.5, 0.94};  // heights of the shelves; 0.41 free above each

/// Solids relative to the middle of their place, z from the surface below.
struct Shape {
  const char* kind;
  std::vector<Solid> solids;
};

Solid upright_box(V middle, V half) { return box(middle, kUpright, half, std::min({half.x, half.y, half.z, 0.012})); }

Shape ball(Dice& dice) {
  const double r = dice.uniform(0.06, 0.12);
  return {"ball", {sphere({0, 0, r}, r)}};
}
Shape carton(Dice& dice) {
  const V half{dice.uniform(0.05, 0.1), dice.uniform(0.05, 0.1), dice.uniform(0.05, 0.15)};
  return {"carton", {box({0, 0, half.z}, turned_about_z(dice.uniform(0, kTurn)), half, 0.012)}};
}
Shape can(Dice& dice) {
  const double r = dice.uniform(0.05, 0.1), half = dice.uniform(0.06, 0.16);
  return {"can", {cylinder({0, 0, half}, kUpright, r, half)}};
}
Shape ring(Dice& dice) {
  const double tube = dice.uniform(0.02, 0.035);
  return {"ring", {torus({0, 0, tube}, kUpright, dice.uniform(0.08, 0.11), tube)}};
}
Shape mug(Dice& dice) {
  const double r = dice.uniform(0.06, 0.08), half = dice.uniform(0.07, 0.1), turn = dice.uniform(0, kTurn);
  const V side{std::cos(turn), std::sin(turn), 0};
  return {"mug",
          {cylinder({0, 0, half}, kUpright, r, half),
           torus(r * side + V{0, 0, half}, frame_with_z({-side.y, side.x, 0}), 0.045, 0.014)}};
}
/// Concave: two boards at a right angle.
Shape bracket(Dice& dice) {
  const double length = dice.uniform(0.07, 0.1), height = dice.uniform(0.08, 0.14), turn = dice.uniform(0, kTurn);
  const Mat3<double> to_local = turned_about_z(turn);
  const V back = transpose(to_local) * V{0.03 - length, 0, height};
  return {"bracket",
          {box({0, 0, 0.025}, to_local, {length, 0.06, 0.025}, 0.01), box(back, to_local, {0.03, 0.06, height}, 0.01)}};
}
/// Thin: a foot, a pole of 2 cm and a shade.
Shape lamp(Dice& dice) {
  const double pole = dice.uniform(0.35, 0.5), shade = dice.uniform(0.07, 0.1);
  return {"lamp",
          {cylinder({0, 0, 0.012}, kUpright, 0.08, 0.012), capsule({0, 0, 0.02}, {0, 0, pole}, 0.011),
           cylinder({0, 0, pole + 0.05}, kUpright, shade, 0.06)}};
}
/// Thin and concave: a seat on four legs.
Shape stool(Dice& dice) {
  const double seat = dice.uniform(0.3, 0.42), splay = dice.uniform(0.1, 0.13);
  Shape shape{"stool", {cylinder({0, 0, seat}, kUpright, 0.13, 0.02)}};
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      shape.solids.push_back(capsule({0.8 * splay * x, 0.8 * splay * y, 0.014}, {0.06 * x, 0.06 * y, seat}, 0.014));
  return shape;
}
/// Thin: pointed leaves from a pot.
Shape plant(Dice& dice) {
  Shape shape{"plant", {cylinder({0, 0, 0.07}, kUpright, 0.07, 0.07)}};
  const int leaves = 5 + dice.index(4);
  for (int i = 0; i < leaves; ++i) {
    const double around = kTurn * i / leaves, rise = dice.uniform(0.8, 1.2), half = dice.uniform(0.09, 0.11);
    const V x{std::cos(around) * std::cos(rise), std::sin(around) * std::cos(rise), std::sin(rise)};
    const V y{-std::sin(around), std::cos(around), 0}, z = cross(x, y);
    shape.solids.push_back(
        blade(V{0, 0, 0.13} + half * x, {{x.x, x.y, x.z, y.x, y.y, y.z, z.x, z.y, z.z}}, {half, 0.025, 0.006}));
  }
  return shape;
}

Shape low_shape(Dice& dice) {
  constexpr Shape (*kLow[])(Dice&) = {ball, carton, can, ring, mug, bracket};
  return kLow[dice.index(6)](dice);
}

struct Place {
  V base;
  bool is_low;  // a shelf is above it
};

/// Fills places with groups of objects until there are enough.
class Filler {
 public:
  Filler(std::vector<Object>& objects, int count, Dice& dice) : objects_(objects), count_(count), dice_(dice) {}
  bool is_done() const { return int(objects_.size()) >= count_; }

  void fill(const Place& place) {
    const V base = place.base + V{dice_.uniform(-kSlack, kSlack), dice_.uniform(-kSlack, kSlack), 0};
    const int draw = dice_.index(8);
    if (draw == 0 || draw == 1) return stack(base);
    if (draw == 2) return crate(base);
    if (draw == 3) return row(base);
    constexpr Shape (*kTall[])(Dice&) = {lamp, stool, plant};
    if (draw <= 5 && !place.is_low) return add(kTall[dice_.index(3)](dice_), base);
    add(low_shape(dice_), base);
  }

 private:
  void add(Shape shape, V base) {
    Texture texture{Pattern(dice_.index(4)), bright(dice_), {}, dice_.uniform(3, 5), 0.1, 0};
    texture.colour_b = V{1.25, 1.25, 1.25} - texture.colour_a;
    if (!objects_.empty() && dice_.index(4) == 0)  // the colours of another one
      texture = objects_[std::size_t(dice_.index(int(objects_.size())))].texture;
    add(std::move(shape), base, texture);
  }
  void add(Shape shape, V base, Texture texture) {
    if (is_done()) return;
    const auto number = objects_.size() + 1;
    texture.seed = std::uint32_t(200 + number);
    for (Solid& solid : shape.solids) solid.centre = solid.centre + base;
    objects_.push_back({shape.kind + ("-" + std::to_string(number)), std::move(shape.solids), texture});
  }

  /// Two or three on each other, narrower upwards.
  void stack(V base) {
    double width = 0.11;
    for (int left = 2 + dice_.index(2); left > 0; --left, width -= 0.025) {
      const double half = dice_.uniform(0.035, 0.06);
      const V middle{0, 0, half};
      if (dice_.index(3) == 0)
        add({"drum", {cylinder(middle, kUpright, width, half)}}, base);
      else
        add({"block", {box(middle, turned_about_z(dice_.uniform(0, kTurn)), {width, 0.9 * width, half}, 0.012)}}, base);
      base.z += 2 * half;
    }
  }

  /// An open crate with two things in it, which touch its floor and each other.
  void crate(V base) {
    constexpr double kHalf = 0.14, kWall = 0.006, kHeight = 0.06;
    Shape shape{"crate", {upright_box({0, 0, kWall}, {kHalf, kHalf, kWall})}};
    for (const double side : {-1.0, 1.0}) {
      shape.solids.push_back(upright_box({side * (kHalf - kWall), 0, kHeight}, {kWall, kHalf, kHeight}));
      shape.solids.push_back(upright_box({0, side * (kHalf - kWall), kHeight}, {kHalf, kWall, kHeight}));
    }
    add(std::move(shape), base);
    const double r = dice_.uniform(0.045, 0.06), other = dice_.uniform(0.045, 0.06);
    const V floor = base + V{0, dice_.uniform(-0.05, 0.05), 2 * kWall};
    add({"ball", {sphere({-r, 0, r}, r)}}, floor);
    if (dice_.index(2) == 0) return add({"ball", {sphere({2 * std::sqrt(r * other) - r, 0, other}, other)}}, floor);
    const double half = dice_.uniform(0.06, 0.12);
    add({"can", {cylinder({other, 0, half}, kUpright, other, half)}}, floor);
  }

  /// Two of one kind and colour that touch, as books or bottles in a row.
  void row(V base) {
    Texture texture{Pattern(dice_.index(4)), bright(dice_), {0.9, 0.9, 0.85}, dice_.uniform(3, 5), 0.1, 0};
    const bool books = dice_.index(2) == 0;
    const double r = books ? dice_.uniform(0.025, 0.05) : dice_.uniform(0.045, 0.07), half = dice_.uniform(0.09, 0.13);
    for (const double side : {-1.0, 1.0}) {
      const V middle{side * r, 0, half};
      if (books)
        add({"book", {upright_box(middle, {r, 0.09, half})}}, base, texture);
      else
        add({"bottle", {cylinder(middle, kUpright, r, half), capsule(middle, middle + V{0, 0, half + 0.05}, 0.018)}},
            base, texture);
    }
  }

  std::vector<Object>& objects_;
  int count_;
  Dice& dice_;
};

struct Furniture {
  V middle;           // on the floor
  int columns, rows;  // of places on it
  double half_x() const { return 0.5 * kCell * columns + 0.02; }
  double half_y() const { return 0.5 * kCell * rows + 0.02; }
  bool is_over(double x, double y) const {
    return std::abs(x - middle.x) < half_x() + 0.5 * kCell && std::abs(y - middle.y) < half_y() + 0.5 * kCell;
  }
};

void add_boards(Object& object, const Furniture& f, std::initializer_list<double> heights) {
  double top = 0;
  for (const double z : heights) {
    object.solids.push_back(upright_box(f.middle + V{0, 0, z - kBoard}, {f.half_x(), f.half_y(), kBoard}));
    top = std::max(top, z);
  }
  constexpr double kPost = 0.01;  // narrower than the margin around the places
  for (const double x : {-1.0, 1.0})
    for (const double y : {-1.0, 1.0})
      object.solids.push_back(upright_box(f.middle + V{x * (f.half_x() - kPost), y * (f.half_y() - kPost), 0.5 * top},
                                          {kPost, kPost, 0.5 * top}));
}

void add_places(const Furniture& f, double z, bool is_low, std::vector<Place>& places) {
  for (int row = 0; row < f.rows; ++row)
    for (int column = 0; column < f.columns; ++column)
      places.push_back(
          {f.middle + V{kCell * (column - 0.5 * (f.columns - 1)), kCell * (row - 0.5 * (f.rows - 1)), z}, is_low});
}

void shuffle(std::vector<Place>& places, Dice& dice) {
  for (std::size_t i = places.size(); i > 1; --i) std::swap(places[i - 1], places[std::size_t(dice.index(int(i)))]);
}

}  // namespace

void messy_room(AnalyticScene& scene, int count, std::uint64_t seed) {
  Dice dice(seed);
  const double size = std::sqrt(count / 25.0);
  const auto at_least_two = [&](double n) { return std::max(2, int(std::lround(n * size))); };
  Furniture table{{}, at_least_two(4), at_least_two(3)}, rack{{}, at_least_two(4), 1};
  table.middle.y = -table.half_y() - 0.1;
  rack.middle.y = 0.5 * table.half_y() + 0.3;
  std::vector<Place> on[3];  // table, rack, floor
  add_places(table, kTable, false, on[0]);
  for (const double z : kShelves) add_places(rack, z, true, on[1]);
  const int half = int(std::ceil(2 * table.half_y() / kCell)) + 1;
  for (int y = -half; y <= half; ++y)
    for (int x = -half; x <= half; ++x)
      if (!table.is_over(kCell * x, kCell * y) && !rack.is_over(kCell * x, kCell * y))
        on[2].push_back({{kCell * x, kCell * y, 0}, false});
  for (std::vector<Place>& places : on) shuffle(places, dice);

  scene.objects.clear();
  Filler filler(scene.objects, count, dice);
  while (!filler.is_done()) {
    constexpr double kUpTo[] = {0.4, 0.65};  // shares of table and rack
    const double draw = dice.uniform(0, 1);
    std::size_t k = draw < kUpTo[0] ? 0 : draw < kUpTo[1] ? 1 : 2;
    for (int tries = 0; on[k].empty() && tries < 2; ++tries) k = (k + 1) % 3;
    filler.fill(on[k].back());
    on[k].pop_back();
  }
  Object table_top{"table", {}, {Pattern::kMarble, {0.5, 0.33, 0.2}, {0.68, 0.48, 0.3}, 2.5, 0.08, 9}};
  Object shelves{"rack", {}, {Pattern::kStripes, {0.62, 0.6, 0.55}, {0.72, 0.7, 0.66}, 2.5, 0.06, 10}};
  table_top.is_furniture = shelves.is_furniture = true;
  add_boards(table_top, table, {kTable});
  add_boards(shelves, rack, {kShelves[0], kShelves[1], kShelves[2]});
  scene.objects.push_back(table_top);
  scene.objects.push_back(shelves);
  scene.focus = {0, 0, 0.45};
  scene.rig_radius = 1.1 + 1.05 * kCell * half;
}

}  // namespace ngs::synth
