// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "ElementForce.hpp"

namespace membrane {

/// The springs (3), (6) and the damping (9) of the sides of a membrane: those of the film in their arrangement, and the
/// cables, which are few, one by one. Of a film of plane stress only the cables.
class SideForces : public ArrangedForce<2> {
public:
    /// \param damping c of each side [N s/m], or empty: none
    SideForces(const RestState& rest, std::vector<double> damping) : rest_(&rest), damping_(std::move(damping)) {}

    const char* channel() const override { return "damping"; }
    const char* title() const override { return "damping"; }
    Exchange exchange() const override { return Exchange::loses; }
    void arrange(const Partition& partition) override;
    void widen(int group, int& first, int& last) const override;
    GroupEnergy add(int group, const GroupJob& job) override;
    void addTo(LinearForces& to, const Points& x, const Points& v) const override;
    Culprit culprit(const Moment& moment, bool elastic) const override;
    std::size_t memorySize() const override { return rest_->sides.size(); }
    void appendMemory(std::vector<double>& lengths) const override;
    void setMemory(const double* lengths) override;
    void setMemoryFrom(const Points& x) override;

    /// How many constants of each kind there are.
    std::size_t constantCount() const { return stiffness_.size(); }

private:
    const RestState* rest_;
    std::vector<double> damping_;
    Array stiffness_, restLength_, critical_, coefficient_; ///< as in Side; c [N s/m]; 0 for padding
    /// Where in those four each block's constants begin. Blocks of sides that are all alike share theirs: large meshes
    /// are bound by memory.
    std::vector<int> constants_;
    Array length_;                    ///< of the last step [m]; empty: not kept
    std::vector<int> cables_;         ///< sides that are cables, group by group
    std::vector<int> cableGroups_;    ///< first cable of each group, then their number
    std::vector<double> cableLength_; ///< of the last step [m], parallel to cables

    void arrangeConstants();
    void arrangeCables(const Arrangement<2>& order, const std::vector<int>& cableOf);
    GroupEnergy addFilm(int group, const GroupJob& job);
    void addCable(int i, const GroupJob& job, GroupEnergy& sum);
};

} // namespace membrane
