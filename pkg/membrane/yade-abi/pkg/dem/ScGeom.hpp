// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/IGeom.hpp>
#include <core/Interaction.hpp>
#include <core/State.hpp>
#include <pkg/dem/DemXDofGeom.hpp>

namespace yade {

class ScGeom : public GenericSpheresContact {
    Vector3r twist_axis;
    Vector3r orthonormal_axis;
    friend struct abi::Layout<ScGeom>;

public:
    // refR1 and refR2 under another name
    Real &radius1, &radius2;

    ScGeom();
    // A copy's radii would be those of the original.
    ScGeom(const ScGeom&) = delete;
    ScGeom& operator=(const ScGeom&) = delete;
    virtual ~ScGeom();

    // sets normal and what rotate() and shearIncrement() need
    void precompute(const State& state1, const State& state2, const Scene*, const shared_ptr<Interaction>&,
                    const Vector3r& currentNormal, bool isNew, const Vector3r& shift2,
                    bool avoidGranularRatcheting = true);
    Vector3r& rotate(Vector3r& tangent) const;
    Vector3r& rotateNonSpherical(Vector3r& tangent) const;
    const Vector3r& shearIncrement() const { return shearInc; }
    Vector3r getIncidentVel(const State*, const State*, Real dt, const Vector3r& shiftVel, const Vector3r& shift2,
                            bool avoidGranularRatcheting = true) const;
    Vector3r getIncidentVel(const State*, const State*, Real dt, bool avoidGranularRatcheting = true) const;
    Vector3r getRelAngVel(const State*, const State*, Real dt) const;

    Real penetrationDepth;
    Vector3r shearInc;
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

class ScGeom6D : public ScGeom {
public:
    Quaternionr initialOrientation1;
    Quaternionr initialOrientation2;
    Quaternionr twistCreep;
    Real twist;
    Vector3r bending;

    ScGeom6D();
    virtual ~ScGeom6D();
    const Real& getTwist() const { return twist; }
    const Vector3r& getBending() const { return bending; }
    void precomputeRotations(const State&, const State&, bool isNew, bool creep = false);
    void initRotations(const State&, const State&);
    YADE_ABI_SERIALIZABLE
    YADE_ABI_INDEXABLE
};

YADE_ABI_LAYOUT(ScGeom, 192,
                ((twist_axis, 96))((orthonormal_axis, 120))((radius1, 144))((radius2, 152))((penetrationDepth,
                                                                                             160))((shearInc, 168)));
YADE_ABI_LAYOUT(ScGeom6D, 320,
                ((initialOrientation1, 192))((initialOrientation2, 224))((twistCreep, 256))((twist, 288))((bending,
                                                                                                           296)));
YADE_ABI_SAVED(ScGeom)
YADE_ABI_SAVED(ScGeom6D)

} // namespace yade
