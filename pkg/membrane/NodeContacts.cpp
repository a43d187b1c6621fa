// SPDX-License-Identifier: GPL-2.0-or-later
#include "NodeContacts.hpp"
#include "BodyAt.hpp"
#include "Exactly.hpp"
#include "MembranePhys.hpp"
#include <algorithm>
#include <core/Interaction.hpp>
#include <core/InteractionContainer.hpp>
#include <map>
#include <pkg/dem/DemXDofGeom.hpp>
#include <pkg/dem/FrictPhys.hpp>

namespace yade {

namespace {

Real elasticEnergy(const NormShearPhys& spring) {
    const auto of = [](const Vector3r& force, Real stiffness) {
        return stiffness > 0. ? 0.5 * force.squaredNorm() / stiffness : 0.;
    };
    return of(spring.normalForce, spring.kn) + of(spring.shearForce, spring.ks);
}

} // namespace

bool movesFreely(const Body& body) {
    const bool isFree = (body.state->blockedDOFs & State::DOF_XYZ) != State::DOF_XYZ;
    return isFree && body.state->mass > 0. && body.clumpId == Body::ID_NONE;
}

NodeInteractions::NodeInteractions(const Membrane& membrane, const Scene& scene) {
    for (const auto& link : *scene.interactions) {
        if (!link->geom || !link->phys) continue;
        const Body::id_t ids[] = {link->getId1(), link->getId2()};
        if (exactly<MembranePhys>(link->phys)) {
            sides = sides || membrane.nodeOf(ids[0]) >= 0;
            continue;
        }
        const auto* const phys = dynamic_cast<const NormShearPhys*>(link->phys.get());
        if (!phys) continue;
        const Vector3r onSecond = phys->normalForce + phys->shearForce;
        const auto* const touching = dynamic_cast<const GenericSpheresContact*>(link->geom.get());
        for (const int side : {0, 1}) {
            const int node = membrane.nodeOf(ids[side]);
            const shared_ptr<Body> body = node < 0 ? shared_ptr<Body>() : bodyAt(scene, ids[side]);
            if (!body || !membrane.isNode(*body, node)) continue;
            contacts.push_back({node, ids[1 - side], touching ? touching->contactPoint : Vector3r(body->state->pos),
                                side == 0 ? Vector3r(-onSecond) : onSecond, phys->kn, phys->ks, elasticEnergy(*phys),
                                typeid(*phys) == typeid(FrictPhys)});
            break; // of two nodes the first one keeps the books
        }
    }
    std::sort(contacts.begin(), contacts.end(), [](const NodeContact& a, const NodeContact& b) {
        return std::make_pair(a.node, a.other) < std::make_pair(b.node, b.other);
    });
}

ContactStiffness::ContactStiffness(const vector<NodeContact>& contacts, const vector<shared_ptr<Body>>& nodes,
                                   const Scene& scene) {
    if (contacts.empty()) return;
    ground.assign(nodes.size(), 0.);
    std::map<Body::id_t, Real> sums; // over mass, by body
    for (const NodeContact& contact : contacts) {
        const Body& first = *nodes[contact.node];
        const shared_ptr<Body> second = bodyAt(scene, contact.other);
        const bool yields = second && movesFreely(*second);
        // By how much a force speeds up the one against the other; friction turns a round body, too.
        const Real ofNode = movesFreely(first) ? 1. / first.state->mass : 0.;
        const Real ofOther = yields ? 1. / second->state->mass : 0.;
        Real turning = 0.;
        if (yields && (second->state->blockedDOFs & State::DOF_RXRYRZ) != State::DOF_RXRYRZ) {
            const Real least = second->state->inertia.minCoeff();
            if (least > 0.) turning = (contact.point - second->state->pos).squaredNorm() / least;
        }
        const Real rate = std::max(contact.normal * (ofNode + ofOther), contact.shear * (ofNode + ofOther + turning));
        if (ofNode > 0.) ground[contact.node] += rate / ofNode;
        for (const auto& [id, moves] : {std::make_pair(first.id, ofNode > 0.), std::make_pair(contact.other, yields)}) {
            if (!moves) continue;
            const Real sum = sums[id] += rate;
            if (!(sum > fastest)) continue;
            fastest = sum;
            this->node = contact.node;
            this->other = contact.other;
        }
    }
}

} // namespace yade
