// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "../mechanics/FilmTriangle.hpp"
#include "TriangleForce.hpp"

namespace membrane {

/// The film as one of plane stress and tension field, in place of springs: see FilmLaw.
class FilmForce : public TriangleForce {
public:
    /// \param nodes rest positions [m]
    FilmForce(const Points& nodes, const std::vector<Eigen::Vector3i>& triangles, const FilmLaw& law)
        : TriangleForce(triangles), nodes_(&nodes), law_(law) {}

    const char* channel() const override { return "damping"; }
    const char* title() const override { return "damping"; }
    Exchange exchange() const override { return Exchange::loses; }
    void arrange(const Partition& partition) override;
    GroupEnergy add(int group, const GroupJob& job) override;
    void addTo(LinearForces& to, const Points& x, const Points& v) const override;
    Culprit culprit(const Moment& moment, bool elastic) const override;
    std::size_t memorySize() const override { return 3 * triangles_->size(); }
    void appendMemory(std::vector<double>& grown) const override;
    void setMemory(const double* grown) override;
    void setMemoryFrom(const Points& x) override;

private:
    const Points* nodes_;
    FilmLaw law_;
    Array square_[3], trace_[3], normal_[3], shear_[3], area_; ///< as in FilmRest; area 0 for padding
    Array grown_[3];                                           ///< l² - L² of the sides in the last step [m²]

    FilmRest restOf(const Eigen::Vector3i& triangle) const;
    /// Corners of a triangle in the order of the arrangement.
    static Eigen::Vector3i sorted(Eigen::Vector3i triangle);
};

} // namespace membrane
