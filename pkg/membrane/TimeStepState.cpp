// SPDX-License-Identifier: GPL-2.0-or-later
#include "TimeStepState.hpp"
#include "MembraneForceEngine.hpp"
#include "mechanics/Drag.hpp"

namespace yade {

TimeStepState::TimeStepState(const Membrane& membrane, const vector<shared_ptr<State>>& states, Real airDensity) {
    positions.reserve(states.size());
    masses.reserve(states.size());
    for (const auto& state : states) {
        positions.push_back(state->pos);
        // A node held in some directions only counts as free: that bounds the step from below.
        masses.push_back(isHeld(*state) ? 0. : state->mass);
    }
    if (!(airDensity > 0.)) return;
    drag.assign(states.size(), 0.);
    for (const Vector3i& t : membrane.triangles) {
        const Vector3r& corner = positions[t[0]];
        const Vector3r area = (positions[t[1]] - corner).cross(positions[t[2]] - corner);
        for (int k = 0; k < 3; ++k) drag[t[k]] += ::membrane::cornerDragSlope(airDensity, area, states[t[k]]->vel);
    }
}

} // namespace yade
