#pragma once

#include "contact/shapes/hulls/convex.hpp"
#include "contact/shapes/meshes/triangle_mesh.hpp"

namespace plumb::detail {

/// Lists where a hull is kept off a mesh, as far as the gap `reach` (m): at its corners, over vertices of the
/// mesh, and where edges of both cross. Its middle is at `middle`; see touch_mesh(). In what is listed the
/// hull is a.
ConvexContacts contacts_of(const Convex& hull, Vec3 middle, const TriangleMesh& mesh, double reach);

}  // namespace plumb::detail
