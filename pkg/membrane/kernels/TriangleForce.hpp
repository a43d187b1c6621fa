// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "../mechanics/Triangle.hpp"
#include "BlockTransfer.hpp"
#include "ElementForce.hpp"

namespace membrane {

/// A force on triangles that does not ask which way round they run: their corners are in ascending order.
class TriangleForce : public ArrangedForce<3> {
public:
    explicit TriangleForce(const std::vector<Eigen::Vector3i>& triangles) : triangles_(&triangles) {}

    void arrange(const Partition& partition) override {
        std::vector<std::array<int, 3>> corners;
        corners.reserve(triangles_->size());
        for (const Eigen::Vector3i& t : *triangles_) {
            corners.push_back({t[0], t[1], t[2]});
            std::sort(corners.back().begin(), corners.back().end());
        }
        order_ = membrane::arrange<3>(corners, partition);
    }

protected:
    const std::vector<Eigen::Vector3i>* triangles_;

    /// Calls take(triangle, twice its area times its normal [m²]).
    template <class Take> void forTriangles(const Points& x, const Take& take) const {
        for (const Eigen::Vector3i& t : *triangles_) take(t, doubleArea(x[t[0]], x[t[1]], x[t[2]]));
    }
};

/// What the triangles of a block have at each of their corners, beginning with the block's first.
struct OfCorners {
    Components a, b, c;
};

/// \param room to gather it in, where nodes do not follow one another
inline OfCorners ofCorners(const Arrangement<3>& order, const Block& block, const Components& from,
                           BlockVectors (&room)[3]) {
    const auto corner = [&](int k) { return cornerOf(block, order.node[k].data() + block.begin, from, room[k]); };
    return {corner(0), corner(1), corner(2)};
}

} // namespace membrane
