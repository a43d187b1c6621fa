// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include <lib/base/Math.hpp>

namespace yade {

class MembraneForceEngine;
class Scene;

/// Energies of contacts. One that is stable gives its two bodies together at most what they gave it: its work, from
/// when it begins, is never above 0. Refers to the attributes of a ledger, which are saved with it.
struct ContactBook {
    vector<Vector2i>& pairs; ///< node and other body, of the contacts of the last step, in order
    vector<Real>& works;     ///< of each on both bodies [J], up to half a step after the last one
    vector<Real>& most;      ///< that each has taken [J]
    Real& ended;             ///< sum of the works of contacts that are over [J]
    Real& gain;              ///< given beyond what was taken and may be stored [J], up to now
    Real& taken;             ///< sum of what contacts have taken at most [J]

    /// Books a step, after the integrator's move. The works' leapfrog is that of the ledger.
    /// \param loaded whether contacts that begin may be under load already
    void turnPage(const MembraneForceEngine& forces, Scene& scene, const Vector3r& gravity, bool loaded);
};

} // namespace yade
