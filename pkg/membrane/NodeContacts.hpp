// SPDX-License-Identifier: GPL-2.0-or-later
#pragma once
#include "Membrane.hpp"

namespace yade {

/// An ordinary contact of a node with another body, as its functors left it in this step.
struct NodeContact {
    int node;
    Body::id_t other;
    Vector3r point;     ///< where it acts [m]
    Vector3r force;     ///< on the node [N]
    Real normal, shear; ///< stiffnesses [N/m]
    Real stored;        ///< elastic energy [J], if the law is linear
    bool linear;        ///< whether it is known to be: that of a FrictPhys
};

/// The interactions of a membrane's nodes.
struct NodeInteractions {
    vector<NodeContact> contacts; ///< whose forces and stiffnesses can be read (NormShearPhys), by node and other body
    bool sides = false;           ///< whether there are sides, too

    NodeInteractions() = default;
    NodeInteractions(const Membrane& membrane, const Scene& scene);
};

/// What contacts add to the stiffness of a membrane, as springs between its nodes and a place at rest, each as stiff as
/// gives the node the frequency that it has against the other body.
struct ContactStiffness {
    vector<Real> ground; ///< of each node [N/m]; empty without contacts
    Real fastest = 0.;   ///< largest sum of ground over mass of a body, node or other [1/s²]
    int node = -1;       ///< of the contact that makes that sum the largest
    Body::id_t other = Body::ID_NONE;

    ContactStiffness() = default;
    ContactStiffness(const vector<NodeContact>& contacts, const vector<shared_ptr<Body>>& nodes, const Scene& scene);
};

/// Whether forces move a body: it is free to, has a mass, and no clump moves it.
bool movesFreely(const Body& body);

} // namespace yade
