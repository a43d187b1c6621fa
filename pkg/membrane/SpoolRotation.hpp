// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <core/PartialEngine.hpp>

namespace yade {

class SpoolRotation : public PartialEngine {
public:
    void action() override;
    void postLoad(SpoolRotation&);

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(SpoolRotation, PartialEngine,
        "Turns the facets of a spool about the z axis. Where a facet is matters only while something may touch it: as long as all bodies of "
        "`touching` are farther than `reach` from the axis, the facets are brought to their places only every `restPeriod` steps and at the end of a run. NewtonIntegrator must "
        "not move them: its mask must have no bit of theirs. Put it before the collider.",
        ((Real, angularVelocity, 0., , "About +z [rad/s]."))
        ((vector<int>, touching, , , "Ids of the bodies that may touch the spool."))
        ((Real, reach, 0., , "Distance from the z axis [m] below which one of them may touch it: the spool's radius, the body's and a margin for one step."))
        ((Real, sweep, 1e-3, Attr::triggerPostLoad, "Way [m] that a facet may move before the collider looks again, > 0: half its verletDist."))
        ((int, restPeriod, 1000, Attr::triggerPostLoad, "Steps between two turns of a spool that nothing may touch, > 0."))
        ((Real, angle, 0., Attr::readonly, "By which the spool has turned [rad]."))
        ((Real, facetAngle, 0., Attr::readonly, "By which the facets have been turned [rad]."))
        ((Real, sortedAngle, 0., (Attr::readonly | Attr::hidden), "facetAngle [rad] when the collider was last sent for."))
        ,
        ,
    );
    // clang-format on

private:
    bool mayTouch() const;
    void turnFacets(Real to);
};
REGISTER_SERIALIZABLE(SpoolRotation);

} // namespace yade
