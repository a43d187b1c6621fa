// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

// How YADE names the components of its small vectors and matrices in a saved file.

#include <lib/base/Math.hpp>

#include <boost/serialization/is_bitwise_serializable.hpp>
#include <boost/serialization/nvp.hpp>
#include <string>

BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector2r);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector2i);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector3r);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector3i);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector6r);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Vector6i);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Quaternionr);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Se3r);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Matrix3r);
BOOST_IS_BITWISE_SERIALIZABLE(yade::Matrix6r);

namespace boost {
namespace serialization {
// x, y, z up to three components; v0, v1, ... beyond
template <class Archive, class Scalar, int size>
void serialize(Archive& ar, Eigen::Matrix<Scalar, size, 1>& v, const unsigned int) {
    static_assert(size == 2 || size == 3 || size == 6, "YADE saves vectors of 2, 3 and 6 components only");
    static const char* const axes[] = {"x", "y", "z"};
    static const char* const numbers[] = {"v0", "v1", "v2", "v3", "v4", "v5"};
    for (int i = 0; i < size; ++i) ar& make_nvp((size <= 3 ? axes : numbers)[i], v[i]);
}

// mRC with row R and column C, row by row
template <class Archive, int size>
void serialize(Archive& ar, Eigen::Matrix<yade::Real, size, size>& m, const unsigned int) {
    static_assert(size == 3 || size == 6, "YADE saves matrices of 3 x 3 and 6 x 6 only");
    for (int row = 0; row < size; ++row)
        for (int column = 0; column < size; ++column)
            ar& make_nvp(("m" + std::to_string(row) + std::to_string(column)).c_str(), m(row, column));
}

template <class Archive> void serialize(Archive& ar, yade::Quaternionr& q, const unsigned int) {
    ar& make_nvp("w", q.w()) & make_nvp("x", q.x()) & make_nvp("y", q.y()) & make_nvp("z", q.z());
}

template <class Archive> void serialize(Archive& ar, yade::Se3r& se3, const unsigned int) {
    ar& make_nvp("position", se3.position) & make_nvp("orientation", se3.orientation);
}
} // namespace serialization
} // namespace boost
