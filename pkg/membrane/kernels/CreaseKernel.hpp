// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "ElementForce.hpp"

namespace membrane {

/// The moments of the creases (7) and what balances them (8).
class CreaseForce : public ArrangedForce<4> {
public:
    CreaseForce(const RestState& rest, const CreaseLaw& law) : rest_(&rest), law_(law) {}

    const char* channel() const override { return "crease"; }
    const char* title() const override { return "the creases"; }
    Exchange exchange() const override { return Exchange::stores; }
    void arrange(const Partition& partition) override;
    GroupEnergy add(int group, const GroupJob& job) override;
    /// Energy [J] of all creases at some places of the nodes [m].
    double energy(const Points& x) const;
    void addTo(LinearForces& to, const Points& x, const Points& v) const override;
    Culprit culprit(const Moment& moment, bool elastic) const override;

private:
    const RestState* rest_;
    CreaseLaw law_;
    Array length_, heightC_, heightD_, sign_; ///< as in CreaseRest
    Array steepestLever_, slopeC_, slopeD_;   ///< its functions

    double energyOf(const Crease& crease, const Points& x) const;
};

} // namespace membrane
