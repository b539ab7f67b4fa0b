// Shape functions of elements of a section and their integration.
#pragma once

#include <Eigen/Core>
#include <deque>
#include <vector>

#include "libmbd/section/mesh.hpp"

namespace mbd::section {

// Tables of a kind of element, at its integration points: full Gauss (order + 1)^2; on triangles of degree 2,
// 5 and, from order 3, 2 order.
struct ShapeTable {
  int nodes = 0;
  std::vector<double> weights;
  Eigen::MatrixXd n;       // (point, node)
  Eigen::MatrixXd d1, d2;  // derivatives along xi and eta
};

// Of a kind; kept, so that a second call is a look-up. Throws Error for a kind that is not there. Not for several
// threads at once: `cache` belongs to the caller.
class ShapeTables {
 public:
  const ShapeTable& of(Shape shape, int order);

 private:
  struct Entry {
    Shape shape;
    int order;
    ShapeTable table;
  };
  std::deque<Entry> entries_;  // references stay
};

int nodes_of(Shape shape, int order);

// Own coordinates (xi, eta) of the nodes of such an element, by rows.
Eigen::MatrixX2d node_places(Shape shape, int order);

// Shape functions at one place: columns n, d/dxi, d/deta.
Eigen::MatrixX3d shape_functions(Shape shape, int order, double xi, double eta);

}  // namespace mbd::section
