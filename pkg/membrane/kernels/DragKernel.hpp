// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "../mechanics/Drag.hpp"
#include "ElementForce.hpp"

namespace membrane {

/// Air drag (10) on the triangles; their corners in ascending order, for drag does not ask which way round they run.
class DragForce : public ArrangedForce<3> {
public:
    /// \param airDensity [kg/m³]
    DragForce(const std::vector<Eigen::Vector3i>& triangles, double airDensity)
        : triangles_(&triangles), airDensity_(airDensity) {}

    const char* channel() const override { return "drag"; }
    const char* title() const override { return "air drag"; }
    Exchange exchange() const override { return Exchange::loses; }
    void arrange(const Partition& partition) override;
    GroupEnergy add(int group, const GroupJob& job) override;
    double viscosity() const override;
    void addTo(LinearForces& to, const Points& x, const Points& v) const override;
    Culprit culprit(const Moment& moment, bool elastic) const override;

private:
    const std::vector<Eigen::Vector3i>* triangles_;
    double airDensity_;

    /// Calls take(node, twice the area times the normal) for each corner.
    template <class Take> void forCorners(const Points& x, const Take& take) const {
        for (const Eigen::Vector3i& t : *triangles_) {
            const Eigen::Vector3d area = doubleArea(x[t[0]], x[t[1]], x[t[2]]);
            for (int k = 0; k < 3; ++k) take(t[k], area);
        }
    }
};

} // namespace membrane
