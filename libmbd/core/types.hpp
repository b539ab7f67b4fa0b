// Fixed-size vectors and matrices, for any scalar.
//
// Every alias is unaligned (Eigen::DontAlign): types that cross the library's boundary must have one
// layout whatever instruction set the caller was built with; unaligned vector loads cost nothing on
// current processors.
#pragma once

#include <Eigen/Core>
#include <Eigen/Geometry>

// Small functions of the kernels: a call in the middle of one spills every register.
#define MBD_INLINE [[gnu::always_inline]] inline

namespace mbd {

using Index = Eigen::Index;

template <class S, int Rows, int Cols>
using Matrix =
    Eigen::Matrix<S, Rows, Cols,
                  Eigen::DontAlign | (Rows == 1 && Cols != 1 ? Eigen::RowMajor : Eigen::ColMajor)>;

template <class S>
using Vector3 = Matrix<S, 3, 1>;
template <class S>
using Vector6 = Matrix<S, 6, 1>;
template <class S>
using Matrix3 = Matrix<S, 3, 3>;
template <class S>
using Matrix6 = Matrix<S, 6, 6>;
template <class S>
using Quaternion = Eigen::Quaternion<S, Eigen::DontAlign>;

// Rows of a vector, a block of a matrix (both column by column), as maps: of one type whatever the size of what they are
// part of. Eigen's own blocks are another type for each, and most of the time to compile a kernel of many sizes.
template <int rows, class V>
MBD_INLINE auto rows_at(V& v, Index first) {
  return Eigen::Map<Matrix<typename V::Scalar, rows, 1>>(v.data() + first);
}
template <int rows, int columns, class M>
MBD_INLINE auto block_at(M& m, Index row, Index column) {
  return Eigen::Map<Matrix<typename M::Scalar, rows, columns>, 0, Eigen::OuterStride<>>(
      m.data() + row + column * m.outerStride(), Eigen::OuterStride<>(m.outerStride()));
}
template <int rows, class V>
MBD_INLINE auto rows_at(const V& v, Index first) {
  return Eigen::Map<const Matrix<typename V::Scalar, rows, 1>>(v.data() + first);
}
template <int rows, int columns, class M>
MBD_INLINE auto block_at(const M& m, Index row, Index column) {
  return Eigen::Map<const Matrix<typename M::Scalar, rows, columns>, 0, Eigen::OuterStride<>>(
      m.data() + row + column * m.outerStride(), Eigen::OuterStride<>(m.outerStride()));
}

using Vec3 = Vector3<double>;
using Vec6 = Vector6<double>;
using Mat3 = Matrix3<double>;
using Mat6 = Matrix6<double>;
using VecX = Eigen::VectorXd;

}  // namespace mbd
