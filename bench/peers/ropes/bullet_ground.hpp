#pragma once

#include <btBulletDynamicsCommon.h>

#include <memory>

#include "plumb/scene.hpp"

namespace plumb::bench {

/// m/s, as ContactSettings::sleep_speed has it.
inline constexpr double sleep_speed = 0.02;

inline btVector3 to_bullet(const Vec3& v) {
  return {v.x, v.y, v.z};
}
inline Vec3 from_bullet(const btVector3& v) {
  return {v.x(), v.y(), v.z()};
}

/// The scene's mesh as Bullet has it, with a hierarchy of bounding volumes.
class BulletGround {
 public:
  explicit BulletGround(const Scene& scene) {
    const GroundMesh& mesh = scene.meshes.at(0);
    for (const auto& [a, b, c] : mesh.triangles)
      triangles_.addTriangle(to_bullet(mesh.vertices[a]), to_bullet(mesh.vertices[b]),
                             to_bullet(mesh.vertices[c]));
    shape_ = std::make_unique<btBvhTriangleMeshShape>(&triangles_, true);
    // By default triangles are 4 cm thick. plumb's are not.
    shape_->setMargin(0);
  }
  btCollisionShape* shape() const { return shape_.get(); }

 private:
  btTriangleMesh triangles_;
  std::unique_ptr<btBvhTriangleMeshShape> shape_;
};

}  // namespace plumb::bench
