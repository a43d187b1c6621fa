// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <lib/base/Math.hpp>

namespace yade {

/// Copies what a numpy array, or anything else with Python's buffer protocol, holds, without an object for each number.
/// \param values  of Vector3r, Vector3i, Vector2i, Real or int
/// \return false if `given` is something else, or holds another kind of number: to be extracted as any sequence then
/// \throws std::invalid_argument naming `field` if the shape or a number does not fit
template <class T>
bool copyBuffer(const boost::python::object& given, const std::string& field, std::vector<T>& values);

/// The positions that a numpy array (N, 3) or a sequence of vectors holds.
/// \throws std::invalid_argument naming `field` if the shape or a number does not fit
std::vector<Vector3r> pointsFrom(const boost::python::object& given, const std::string& field);

} // namespace yade
