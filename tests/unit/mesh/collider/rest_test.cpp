#include <doctest/doctest.h>

#include "support/skip.h"

#ifdef NGS_WITH_BULLET
#include <btBulletDynamicsCommon.h>

#include <memory>

#include "ngs/mesh/collider/collider.h"
#include "support/mesh_truth.h"

namespace ngs::mesh {
namespace {

/// A world of Bullet with gravity along -z.
class World {
 public:
  World() { world_.setGravity({0, 0, btScalar(-9.81)}); }

  /// A body of convex parts about `centre` of its collider's world; mass 0: it does not move.
  btRigidBody& add(const Collider& collider, Vec3<double> centre, double mass, Vec3<double> place) {
    auto compound = std::make_unique<btCompoundShape>();
    for (const TriangleMesh& part : collider.parts) {
      auto hull = std::make_unique<btConvexHullShape>();
      hull->setMargin(btScalar(0.001));
      for (const Vec3<float>& v : part.vertices)
        hull->addPoint({btScalar(v.x - centre.x), btScalar(v.y - centre.y), btScalar(v.z - centre.z)}, false);
      hull->recalcLocalAabb();
      compound->addChildShape(btTransform::getIdentity(), hull.get());
      shapes_.push_back(std::move(hull));
    }
    return add(std::move(compound), mass, place);
  }
  btRigidBody& add(std::unique_ptr<btCollisionShape> shape, double mass, Vec3<double> place) {
    btVector3 inertia(0, 0, 0);
    if (mass > 0) shape->calculateLocalInertia(btScalar(mass), inertia);
    btRigidBody::btRigidBodyConstructionInfo info(btScalar(mass), nullptr, shape.get(), inertia);
    info.m_startWorldTransform.setIdentity();
    info.m_startWorldTransform.setOrigin({btScalar(place.x), btScalar(place.y), btScalar(place.z)});
    info.m_friction = btScalar(0.8);
    info.m_rollingFriction = btScalar(0.02);
    info.m_spinningFriction = btScalar(0.02);
    bodies_.push_back(std::make_unique<btRigidBody>(info));
    bodies_.back()->setSleepingThresholds(0, 0);  // at rest by itself, not put to sleep
    bodies_.back()->setCcdMotionThreshold(btScalar(0.01));
    bodies_.back()->setCcdSweptSphereRadius(btScalar(0.005));
    world_.addRigidBody(bodies_.back().get());
    shapes_.push_back(std::move(shape));
    return *bodies_.back();
  }
  void run(double seconds) {
    for (int step = 0; step < int(seconds * 240); ++step) world_.stepSimulation(btScalar(1.0 / 240), 0);
  }
  ~World() {
    for (const auto& body : bodies_) world_.removeRigidBody(body.get());
  }

 private:
  btDefaultCollisionConfiguration configuration_;
  btCollisionDispatcher dispatcher_{&configuration_};
  btDbvtBroadphase pairs_;
  btSequentialImpulseConstraintSolver solver_;
  btDiscreteDynamicsWorld world_{&dispatcher_, &pairs_, &solver_, &configuration_};
  std::vector<std::unique_ptr<btCollisionShape>> shapes_;
  std::vector<std::unique_ptr<btRigidBody>> bodies_;
};

double height(const btRigidBody& body) { return double(body.getWorldTransform().getOrigin().z()); }
bool rests(const btRigidBody& body) {
  return body.getLinearVelocity().length() < 0.01 && body.getAngularVelocity().length() < 0.05;
}

Collider parts_of(const char* recipe, const char* object, int cells, int parts) {
  return make_collider({}, test::true_mesh(test::recipe_object(recipe, object), cells), {ColliderKind::kConvex, parts});
}

TEST_CASE("a ball that is dropped on the collider of a table comes to rest on its top, one next to it falls past") {
  const Collider table = parts_of("table", "table", 96, 16);
  World world;
  world.add(table, {}, 0, {});
  const double radius = 0.1;
  btRigidBody& ball = world.add(std::make_unique<btSphereShape>(btScalar(radius)), 1, {0.3, 0.2, 0.5});
  btRigidBody& below = world.add(std::make_unique<btSphereShape>(btScalar(radius)), 1, {0, 0, -0.3});
  world.run(4);
  CHECK(rests(ball));
  CHECK(height(ball) == doctest::Approx(radius).epsilon(0.05));  // the top is at z = 0
  CHECK(height(below) < -10);  // between the legs nothing holds it, as the hull of the table would
}

TEST_CASE("three boxes of the torus-box recipe, stacked by their colliders, rest at their heights") {
  const Collider box = parts_of("torus-box", "box", 48, 4);
  World world;
  world.add(std::make_unique<btBoxShape>(btVector3(5, 5, 1)), 0, {0, 0, -1});
  std::vector<btRigidBody*> boxes;
  const double half = 0.42;
  for (int k = 0; k < 3; ++k)
    boxes.push_back(&world.add(box, {-0.2, 0, 0.42}, 10, {0, 0, half + k * (2 * half + 0.01) + 0.01}));
  world.run(4);
  for (int k = 0; k < 3; ++k) {
    CAPTURE(k);
    CHECK(rests(*boxes[std::size_t(k)]));
    CHECK(height(*boxes[std::size_t(k)]) == doctest::Approx((2 * k + 1) * half).epsilon(0.03));
  }
}

TEST_CASE("a rod falls through the torus of convex parts, and lies on the torus of its hull") {
  const TriangleMesh mesh =
      test::true_mesh(test::recipe_object("table", "item3"), 48);  // a torus that lies at z = 0.035
  const synth::Object torus = test::recipe_object("table", "item3");
  const Vec3<double> centre = torus.solids[0].centre;
  const double hole = torus.solids[0].size.x - torus.solids[0].size.y;
  for (const bool is_hull : {false, true}) {
    CAPTURE(is_hull);
    World world;
    world.add(make_collider({}, mesh, {is_hull ? ColliderKind::kHull : ColliderKind::kConvex, 16}), {}, 0, {});
    btRigidBody& rod = world.add(std::make_unique<btCapsuleShapeZ>(btScalar(0.6 * hole), btScalar(0.2)), 0.1,
                                 {centre.x, centre.y, 0.4});
    world.run(1);
    CHECK((height(rod) < -1) == !is_hull);
  }
}

}  // namespace
}  // namespace ngs::mesh
#else
namespace ngs::mesh {
TEST_CASE("objects rest on colliders in Bullet") { test::skip("Bullet is not installed (libbullet-dev)"); }
}  // namespace ngs::mesh
#endif
