// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once

#include <core/Body.hpp>
#include <pkg/common/FieldApplier.hpp>

namespace yade {

// Leapfrog of all bodies that share a bit with mask, or of all if mask <= 0.
class NewtonIntegrator : public FieldApplier {
    bool syncEnsured;
    bool cellChanged;
    int homoDeform;
    bool bodySelected;
    Matrix3r dVelGrad;
    Vector3r dSpin;
    friend struct abi::Layout<NewtonIntegrator>;

public:
    bool densityScaling;
    Real updatingDispFactor;
    vector<Real> threadMaxVelocitySq;
    Real damping;
    Vector3r gravity;
    // with bounds: 2 if a body has left the bounds for which the collider has looked, else 0.5
    Real maxVelocitySq;
    bool exactAsphericalRot;
#if YADE_ABI_RELEASE >= 202502
    int rotAlgorithm; // an enumeration of YADE's
    int normalizeEvery;
    int niterOmelyan1998;
#endif
    Matrix3r prevVelGrad;
    Vector3r prevCellSize;
    bool warnNoForceReset;
    int nonviscDampIx;
    bool kinSplit;
    bool dampGravity;
    int kinEnergyIx;
    int kinEnergyTransIx;
    int kinEnergyRotIx;
    int mask;

    NewtonIntegrator();
    virtual ~NewtonIntegrator();
    void action() override;
    YADE_ABI_SERIALIZABLE
};

#if YADE_ABI_RELEASE >= 202502
YADE_ABI_LAYOUT(
    NewtonIntegrator, 440,
    ((syncEnsured, 108))((cellChanged, 109))((homoDeform, 112))((bodySelected, 116))((dVelGrad, 120))((dSpin, 192))(
        (densityScaling, 216))((updatingDispFactor, 224))((threadMaxVelocitySq, 232))((damping, 256))((gravity, 264))(
        (maxVelocitySq, 288))((exactAsphericalRot, 296))((rotAlgorithm, 300))((normalizeEvery, 304))(
        (niterOmelyan1998, 308))((prevVelGrad, 312))((prevCellSize, 384))((warnNoForceReset,
                                                                           408))((nonviscDampIx, 412))((kinSplit, 416))(
        (dampGravity, 417))((kinEnergyIx, 420))((kinEnergyTransIx, 424))((kinEnergyRotIx, 428))((mask, 432)));
#else
YADE_ABI_LAYOUT(NewtonIntegrator, 432,
                ((syncEnsured, 108))((cellChanged, 109))((homoDeform, 112))((bodySelected, 116))((dVelGrad, 120))(
                    (dSpin, 192))((densityScaling, 216))((updatingDispFactor, 224))((threadMaxVelocitySq, 232))((
                    damping, 256))((gravity, 264))((maxVelocitySq, 288))((exactAsphericalRot, 296))((prevVelGrad, 304))(
                    (prevCellSize, 376))((warnNoForceReset, 400))((nonviscDampIx, 404))((kinSplit, 408))(
                    (dampGravity, 409))((kinEnergyIx, 412))((kinEnergyTransIx, 416))((kinEnergyRotIx, 420))((mask,
                                                                                                             424)));
#endif
YADE_ABI_SAVED(NewtonIntegrator)

} // namespace yade
