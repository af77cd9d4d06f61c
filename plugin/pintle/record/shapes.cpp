#include <pintle/record/json.h>
#include <pintle/record/shapes.h>

#include <BulletCollision/CollisionShapes/btBoxShape.h>
#include <BulletCollision/CollisionShapes/btCapsuleShape.h>
#include <BulletCollision/CollisionShapes/btCompoundShape.h>
#include <BulletCollision/CollisionShapes/btConcaveShape.h>
#include <BulletCollision/CollisionShapes/btConeShape.h>
#include <BulletCollision/CollisionShapes/btConvexShape.h>
#include <BulletCollision/CollisionShapes/btCylinderShape.h>
#include <BulletCollision/CollisionShapes/btPolyhedralConvexShape.h>
#include <BulletCollision/CollisionShapes/btShapeHull.h>
#include <BulletCollision/CollisionShapes/btSphereShape.h>
#include <BulletCollision/CollisionShapes/btStaticPlaneShape.h>
#include <LinearMath/btConvexHullComputer.h>

#include <cmath>
#include <map>
#include <vector>

namespace pintle {
inline namespace PINTLE_PRECISION {
namespace record {
namespace {

constexpr int max_triangles = 20000;  // of one mesh: more than a page can show many of

std::string mesh(const std::vector<float>& points, const std::vector<float>& triangles) {
  Json shape('{');
  shape.text("kind", "mesh").raw("points", base64(points));
  return shape.raw("triangles", base64(triangles)).str();
}

void append(const btVector3& v, std::vector<float>& to) {
  to.push_back(float(v.x()));
  to.push_back(float(v.y()));
  to.push_back(float(v.z()));
}

std::string around(const btCollisionShape& shape) {
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  const btVector3 half = (high - low) / 2, middle = (high + low) / 2;
  // A box without an end, or none at all, is not drawn.
  if (!(half.length() < btScalar(1e6))) return Json('{').text("kind", "none").str();
  return Json('{').text("kind", "box").vector("half", half).vector("at", middle).str();
}

// The faces of the convex hull of points, as fans.
std::string hull(const btVector3* points, int count) {
  btConvexHullComputer computer;
  computer.compute(&points[0].x(), int(sizeof(btVector3)), count, 0, 0);
  std::vector<float> vertices, triangles;
  for (int i = 0; i < computer.vertices.size(); ++i) append(computer.vertices[i], vertices);
  for (int i = 0; i < computer.faces.size(); ++i) {
    const btConvexHullComputer::Edge* const first = &computer.edges[computer.faces[i]];
    const int apex = first->getSourceVertex();
    for (const auto* edge = first->getNextEdgeOfFace(); edge->getTargetVertex() != apex;
         edge = edge->getNextEdgeOfFace()) {
      for (const int vertex : {apex, edge->getSourceVertex(), edge->getTargetVertex()})
        triangles.push_back(float(vertex));
    }
  }
  return mesh(vertices, triangles);
}

std::string convex(const btConvexShape& shape) {
  std::vector<btVector3> points;
  if (shape.isPolyhedral()) {
    const auto& polyhedron = static_cast<const btPolyhedralConvexShape&>(shape);
    points.resize(std::size_t(polyhedron.getNumVertices()));
    for (int i = 0; i < int(points.size()); ++i) polyhedron.getVertex(i, points[std::size_t(i)]);
  } else {
    btShapeHull sampled(&shape);
    if (sampled.buildHull(0)) {
      points.assign(sampled.getVertexPointer(), sampled.getVertexPointer() + sampled.numVertices());
    }
  }
  if (points.size() < 4) return around(shape);
  return hull(points.data(), int(points.size()));
}

// Vertices that triangles share are written once.
class Triangles : public btTriangleCallback {
 public:
  void processTriangle(btVector3* triangle, int, int) override {
    if (indices.size() >= 3 * std::size_t(max_triangles)) {
      too_many = true;
      return;
    }
    for (int i = 0; i < 3; ++i) {
      std::vector<float> key;
      append(triangle[i], key);
      const auto found = m_index.emplace(key, m_index.size());
      if (found.second) points.insert(points.end(), key.begin(), key.end());
      indices.push_back(float(found.first->second));
    }
  }

  std::vector<float> points, indices;
  bool too_many = false;

 private:
  std::map<std::vector<float>, std::size_t> m_index;
};

std::string concave(const btConcaveShape& shape) {
  btVector3 low, high;
  shape.getAabb(btTransform::getIdentity(), low, high);
  Triangles triangles;
  shape.processAllTriangles(&triangles, low, high);
  if (triangles.too_many || triangles.indices.empty()) return around(shape);
  return mesh(triangles.points, triangles.indices);
}

std::string compound(const btCompoundShape& shape) {
  Json parts('[');
  for (int i = 0; i < shape.getNumChildShapes(); ++i) {
    Json part('{');
    part.transform("pose", shape.getChildTransform(i));
    parts.item(part.raw("shape", describeShape(*shape.getChildShape(i))).str());
  }
  return Json('{').text("kind", "compound").raw("parts", parts.str()).str();
}

std::string upright(const char* kind, double radius, double half_height, int axis) {
  Json shape('{');
  shape.text("kind", kind).number("radius", radius).number("half", half_height);
  return shape.number("axis", axis).str();
}

}  // namespace

std::string describeShape(const btCollisionShape& shape) {
  switch (shape.getShapeType()) {
    case BOX_SHAPE_PROXYTYPE:
      return Json('{')
          .text("kind", "box")
          .vector("half", static_cast<const btBoxShape&>(shape).getHalfExtentsWithMargin())
          .str();
    case SPHERE_SHAPE_PROXYTYPE:
      return Json('{')
          .text("kind", "sphere")
          .number("radius", double(static_cast<const btSphereShape&>(shape).getRadius()))
          .str();
    case CAPSULE_SHAPE_PROXYTYPE: {
      const auto& capsule = static_cast<const btCapsuleShape&>(shape);
      return upright("capsule", double(capsule.getRadius()), double(capsule.getHalfHeight()),
                     capsule.getUpAxis());
    }
    case CYLINDER_SHAPE_PROXYTYPE: {
      const auto& cylinder = static_cast<const btCylinderShape&>(shape);
      const int axis = cylinder.getUpAxis();
      return upright("cylinder", double(cylinder.getRadius()),
                     double(cylinder.getHalfExtentsWithMargin()[axis]), axis);
    }
    case CONE_SHAPE_PROXYTYPE: {
      const auto& cone = static_cast<const btConeShape&>(shape);
      return upright("cone", double(cone.getRadius()), double(cone.getHeight()) / 2,
                     cone.getConeUpIndex());
    }
    case STATIC_PLANE_PROXYTYPE: {
      const auto& plane = static_cast<const btStaticPlaneShape&>(shape);
      return Json('{')
          .text("kind", "plane")
          .vector("normal", plane.getPlaneNormal())
          .number("constant", double(plane.getPlaneConstant()))
          .str();
    }
    case COMPOUND_SHAPE_PROXYTYPE: return compound(static_cast<const btCompoundShape&>(shape));
    default: break;
  }
  if (shape.isConvex()) return convex(static_cast<const btConvexShape&>(shape));
  if (shape.isConcave()) return concave(static_cast<const btConcaveShape&>(shape));
  return around(shape);
}

}  // namespace record
}  // namespace PINTLE_PRECISION
}  // namespace pintle
