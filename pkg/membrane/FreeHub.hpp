// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "MembraneForceEngine.hpp"
#include "SpoolRotation.hpp"
#include <algorithm>

namespace yade {

class FreeHub : public GlobalEngine {
public:
    void action() override;
    void postLoad(FreeHub&);

    bool turns(int node) const { return std::find(nodes.begin(), nodes.end(), node) != nodes.end(); }
    /// Whether it has turned in the present step of a scene.
    bool hasRun(const Scene& in) const { return lastStep_ == in.iter && lastScene_.is(&in); }
    Real totalInertia() const;
    /// Masses [kg] with which the nodes may count as free in the bound of the time step.
    void addTo(vector<Real>& masses) const;
    Real kinetic() const { return 0.5 * totalInertia() * spinBefore * spin; }
    Real angularMomentum() const { return totalInertia() * 0.5 * (spinBefore + spin); }

    // clang-format off
    YADE_CLASS_BASE_DOC_ATTRS_CTOR_PY(FreeHub, GlobalEngine,
        "A rigid hub that turns freely about the z axis: the torque of the membrane on its `nodes`, and of contacts on the facets of its `spool`, changes its spin, "
        "and it carries both with it. The leapfrog of one angle: spin += O.dt torque / totalInertia, angle += O.dt spin, "
        "with the torque at the nodes' present places. Nodes stay on their circles to the last digit, and the angular momentum of hub and membrane changes by outer torques only. "
        "The axis neither moves nor tilts, and its bearing carries the nodes' weight.\n\n"
        "The nodes must be held (blockedDOFs 'xyzXYZ') and nobody else may drive them. Put it after the membrane's engine and NewtonIntegrator, and before MembraneLedger, which finds it by itself: "
        "the hub's energy and angular momentum are then part of the system's.",
        ((shared_ptr<MembraneForceEngine>, forces, , , "The engine of the membrane's forces."))
        ((vector<int>, nodes, , , "Nodes of the membrane that turn with the hub: ids in the mesh."))
        ((shared_ptr<SpoolRotation>, spool, , , "Turns the hub's facets; its angle and angularVelocity are set here. Optional."))
        ((Real, inertia, 0., Attr::triggerPostLoad, "Moment of inertia of the hub about z [kg m²], without that of its nodes, >= 0."))
        ((Real, spin, 0., , "About +z [rad/s]; half a step before the positions, as YADE's velocities."))
        ((Real, angle, 0., Attr::readonly, "By which the hub has turned [rad]."))
        ((Real, spinBefore, 0., Attr::readonly, "spin before the last step [rad/s]; the mean of both belongs to the places that the last step's forces saw."))
        ((Real, torque, 0., Attr::readonly, "On the hub about z in the last step [N m], that of contacts included."))
        ((Real, contactTorque, 0., Attr::readonly, "Of contacts with the facets [N m], in the last step."))
        ((vector<Vector3r>, places, , (Attr::readonly | Attr::hidden), "Places of the nodes [m] at angle 0."))
        ((vector<int>, placed, , (Attr::readonly | Attr::hidden), "The nodes that have those places."))
        ,
        ,
        .add_property("totalInertia", &Guarded<&FreeHub::totalInertia>::call, "Moment of inertia about z [kg m²] of the hub with its nodes.")
        .add_property("kinetic", &Guarded<&FreeHub::kinetic>::call, "Kinetic energy [J] of the hub with its nodes, totalInertia spinBefore spin / 2.")
        .add_property("angularMomentum", &Guarded<&FreeHub::angularMomentum>::call, "About z [N m s], of the hub with its nodes.")
    );
    // clang-format on

private:
    long lastStep_ = -1;
    SceneMark lastScene_;

    void checkNodes() const;
    void begin();
    /// Whether the nodes have places, and not others that stood in `nodes` before.
    bool hasPlaces() const { return placed == nodes && places.size() == nodes.size(); }
    const State& stateOf(int node) const;
    Real contacts() const;
};
REGISTER_SERIALIZABLE(FreeHub);

} // namespace yade
