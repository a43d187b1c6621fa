// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <abi/Abi.hpp>

#ifndef EIGEN_DONT_PARALLELIZE
#define EIGEN_DONT_PARALLELIZE
#endif
#include <Eigen/Core>
#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>

#include <boost/lexical_cast.hpp>
#include <boost/python.hpp>
#include <boost/shared_ptr.hpp>

#include <cassert>
#include <cmath>
#include <iomanip>
#include <iostream>
#include <limits>
#include <stdexcept>
#include <string>
#include <typeinfo>
#include <utility>
#include <vector>

#ifndef FOREACH
#define FOREACH(variable, range) for (variable : range)
#endif
#ifndef YADE_CAST
#define YADE_CAST static_cast
#endif
#ifndef YADE_PTR_CAST
#define YADE_PTR_CAST ::boost::static_pointer_cast
#endif
#ifndef YADE_PTR_DYN_CAST
#define YADE_PTR_DYN_CAST ::boost::dynamic_pointer_cast
#endif

namespace yade {

namespace math {
using Real = double;

// Callers write math::sqrt(x), so that another Real would find its own.
using std::abs;
using std::acos;
using std::asin;
using std::atan;
using std::atan2;
using std::cbrt;
using std::ceil;
using std::cos;
using std::cosh;
using std::exp;
using std::fabs;
using std::floor;
using std::fmod;
using std::hypot;
using std::isfinite;
using std::isinf;
using std::isnan;
using std::log;
using std::max;
using std::min;
using std::pow;
using std::round;
using std::sin;
using std::sinh;
using std::sqrt;
using std::tan;
using std::tanh;
} // namespace math

using math::Real;

using boost::shared_ptr;
using std::cerr;
using std::cout;
using std::endl;
using std::invalid_argument;
using std::ios;
using std::ios_base;
using std::logic_error;
using std::make_pair;
using std::pair;
using std::runtime_error;
using std::setfill;
using std::setprecision;
using std::setw;
using std::string;
using std::swap;
using std::type_info;
using std::vector;

template <typename Scalar> using Vector2 = Eigen::Matrix<Scalar, 2, 1>;
template <typename Scalar> using Vector3 = Eigen::Matrix<Scalar, 3, 1>;
template <typename Scalar> using Vector6 = Eigen::Matrix<Scalar, 6, 1>;
template <typename Scalar> using Matrix3 = Eigen::Matrix<Scalar, 3, 3>;
template <typename Scalar> using Matrix6 = Eigen::Matrix<Scalar, 6, 6>;

using Vector2i = Vector2<int>;
using Vector3i = Vector3<int>;
using Vector6i = Vector6<int>;
using Vector2r = Vector2<Real>;
using Vector3r = Vector3<Real>;
using Vector6r = Vector6<Real>;
using VectorXr = Eigen::Matrix<Real, Eigen::Dynamic, 1>;
using Matrix3r = Matrix3<Real>;
using Matrix6r = Matrix6<Real>;
using MatrixXr = Eigen::Matrix<Real, Eigen::Dynamic, Eigen::Dynamic>;
using Quaternionr = Eigen::Quaternion<Real>;
using AngleAxisr = Eigen::AngleAxis<Real>;

template <class Scalar> class Se3 {
public:
    Vector3<Scalar> position;
    Eigen::Quaternion<Scalar> orientation;

    Se3() = default;
    Se3(Vector3<Scalar> p, Eigen::Quaternion<Scalar> q) : position(p), orientation(q) {}
};
using Se3r = Se3<Real>;

const Real NaN = std::numeric_limits<Real>::quiet_NaN();

using mask_t = int;

YADE_ABI_LAYOUT(Vector3r, 24, );
YADE_ABI_LAYOUT(Vector3i, 12, );
YADE_ABI_LAYOUT(Matrix3r, 72, );
YADE_ABI_LAYOUT(Quaternionr, 32, );
YADE_ABI_LAYOUT(Se3r, 56, ((position, 0))((orientation, 24)));
static_assert(alignof(Quaternionr) == 8 && alignof(Matrix3r) == 8, "compile with -DEIGEN_DONT_ALIGN, as YADE was");
YADE_ABI_LAYOUT(shared_ptr<void>, 16, );
YADE_ABI_LAYOUT(string, 32, );
YADE_ABI_LAYOUT(vector<int>, 24, );

} // namespace yade

#include <abi/MathSerialization.hpp>
