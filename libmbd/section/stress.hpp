// Stresses and strains at the points of a section, from its resultants: what the central solutions (analysis.hpp) say besides D.
//
// At a point, in the axes L T N of its ply, [LL TT NN TN LN LT] = (6 x 6) [N1 Q2 Q3 M1 M2 M3], the resultants about
// x2 = x3 = 0. Shear strains are 2 e_TN, 2 e_LN, 2 e_LT. Left out, as in the central solutions: loads and inertia that act
// along the line (resultants change as forces at the ends make them change), and what dies out near ends of a beam.
// Stresses are those of the finite elements, not averaged between plies.
#pragma once

#include <functional>
#include <optional>
#include <vector>

#include "libmbd/section/analysis.hpp"
#include "libmbd/section/mesh.hpp"
#include "libmbd/section/shape_functions.hpp"

namespace mbd::section {

// Of unit resultants at a point. Strain in 1/N, 1/(N m); stress in 1/m^2, 1/m^3.
struct Influence {
  Mat6 strain, stress;
  Mat3 axes;  // L T N there, as columns along b1 b2 b3
};

// A point of an element by its own coordinates.
struct ElementPoint {
  int element = 0;
  double xi = 0.0, eta = 0.0;
};

class StressField {
 public:
  // `analysis` is that of this mesh with this curvature.
  StressField(Mesh mesh, const Vec3& curvature, const Analysis& analysis);

  const Mesh& mesh() const { return mesh_; }
  Influence at(const ElementPoint& point) const;
  // Displacement by warping along b1 b2 b3, in the gauge of the analysis [m/N, m/(N m)].
  Eigen::Matrix<double, 3, 6> warping(const ElementPoint& point) const;
  Point position(const ElementPoint& point) const;

  // f(element, place [m], influence) at the nodes of all elements, as each sees them. In the order of the elements.
  using Visit = std::function<void(int element, const Point& at, const Influence& influence)>;
  void each_node(const Visit& f) const;
  // The same at integration points, with the area that each stands for [m^2].
  using VisitArea =
      std::function<void(int element, const Point& at, const Influence&, double area)>;
  void each_integration_point(const VisitArea& f) const;

  // Elements that a point of the section lies in, or on the edge of: where edges meet there are several. Where there is none, as
  // beside an edge that is curved, the one it lies beyond by no more than 1e-3 of its size. Empty: outside.
  std::vector<ElementPoint> find(const Point& point) const;

  // Influence at a point of one ply: mean of elements of the same ply that meet there. Throws Error where the point lies
  // outside, or where plies meet, between which stresses jump.
  struct At {
    Influence influence;
    int element = 0;  // one of them, which says material and ply
  };
  At recover(const Point& point) const;

 private:
  // Shape functions of a kind of element at its nodes and integration points.
  struct Kind {
    Shape shape;
    int order;
    std::vector<Eigen::MatrixX3d> nodes, points;
    std::vector<double> weights;
  };
  const Kind& kind_of(const Element& element) const;
  // Of an element's nodes: places, and unknowns [w; w'] by rows, 6 central solutions times 3 components.
  struct Gathered {
    Eigen::MatrixX2d x;
    Eigen::MatrixXd w, dw;
  };
  Gathered gather(const Element& element) const;
  Influence influence(const Element& element, const Gathered& of, const Eigen::MatrixX3d& shapes,
                      double* determinant = nullptr) const;
  std::optional<ElementPoint> locate(int element, const Point& point, double beyond) const;

  Mesh mesh_;
  Vec3 k_;
  Eigen::MatrixXd w_, dw_;  // warping and its derivative along the line
  Mat6 g_;
  std::vector<Kind> kinds_;
};

}  // namespace mbd::section
