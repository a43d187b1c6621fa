// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "TriangleForce.hpp"

namespace membrane {

/// Air drag (10) on the triangles.
class DragForce : public TriangleForce {
public:
    /// \param airDensity [kg/m³]
    DragForce(const std::vector<Eigen::Vector3i>& triangles, double airDensity)
        : TriangleForce(triangles), airDensity_(airDensity) {}

    const char* channel() const override { return "drag"; }
    const char* title() const override { return "air drag"; }
    Exchange exchange() const override { return Exchange::loses; }
    GroupEnergy add(int group, const GroupJob& job) override;
    double viscosity() const override;
    void addTo(LinearForces& to, const Points& x, const Points& v) const override;
    Culprit culprit(const Moment& moment, bool elastic) const override;

private:
    double airDensity_;
};

} // namespace membrane
