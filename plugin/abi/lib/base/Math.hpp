// YADE's number types, as Debian's double-precision build of 2023.02a has them.
#pragma once

#if !defined(EIGEN_DONT_VECTORIZE) || !defined(EIGEN_DONT_ALIGN) || !defined(EIGEN_DISABLE_UNALIGNED_ARRAY_ASSERT)
#error "YADE was built without Eigen's alignment: define EIGEN_DONT_VECTORIZE, EIGEN_DONT_ALIGN and EIGEN_DISABLE_UNALIGNED_ARRAY_ASSERT"
#endif

#include <Eigen/Core>
#include <Eigen/Geometry>
#include <boost/enable_shared_from_this.hpp>
#include <boost/shared_ptr.hpp>
#include <boost/weak_ptr.hpp>
#include <limits>
#include <list>
#include <map>
#include <mutex>
#include <stdexcept>
#include <string>
#include <vector>

namespace yade {

using boost::shared_ptr;
using std::string;
using std::vector;

using Real = double;
using Vector2r = Eigen::Matrix<Real, 2, 1>;
using Vector3r = Eigen::Matrix<Real, 3, 1>;
using Vector6r = Eigen::Matrix<Real, 6, 1>;
using Vector2i = Eigen::Matrix<int, 2, 1>;
using Vector3i = Eigen::Matrix<int, 3, 1>;
using Vector6i = Eigen::Matrix<int, 6, 1>;
using Matrix3r = Eigen::Matrix<Real, 3, 3>;
using Matrix6r = Eigen::Matrix<Real, 6, 6>;
using Quaternionr = Eigen::Quaternion<Real>;
using AngleAxisr = Eigen::AngleAxis<Real>;
static_assert(sizeof(Quaternionr) == 32 && alignof(Quaternionr) == 8, "Eigen must be compiled as YADE was");

inline constexpr Real NaN = std::numeric_limits<Real>::quiet_NaN();

/// Position and orientation of a body.
template <class Scalar>
struct Se3 {
	Eigen::Matrix<Scalar, 3, 1> position;
	Eigen::Quaternion<Scalar> orientation;
};
using Se3r = Se3<Real>;

} // namespace yade

#define YADE_CAST static_cast
#define YADE_PTR_CAST ::boost::static_pointer_cast
#define YADE_PTR_DYN_CAST ::boost::dynamic_pointer_cast
